"""A plant of one's own: accelerations that fade in a correlation time of each joint, without touching the package.

q' = q ⊕ (v Δt + a c₂),  v' = v + a c₁,  a' = ρ a,
with ρ = e^(−Δt/T), c₁ = Δt (1 + ρ)/2, c₂ = Δt² (2 + ρ)/6 dof by dof.
Over a step the acceleration's noise, of variance σ²(1 − ρ²), rises from zero: it moves (q, v, a) by (Δt²/6, Δt/2, 1).
"""

from dataclasses import replace

import numpy as np

import mbkf

SLOW_S, QUICK_S, QUICK = 0.2, 0.04, ("forearm", "hand", "foot")


class JointTimes(mbkf.Plant):
    """Light segments change their acceleration quickly, the others slowly."""

    def __init__(self, body, layout, dt_s, held):
        super().__init__(body, layout, dt_s)
        T = np.full(body.nv, SLOW_S)
        for name, joint in body.joints.items():
            T[joint.v] = QUICK_S if name.endswith(QUICK) else SLOW_S
        self.rho = np.exp(-dt_s / T)
        self.c1, self.c2 = dt_s * (1.0 + self.rho) / 2.0, dt_s**2 * (2.0 + self.rho) / 6.0
        variance = np.where(held, 0.0, 4.0 * body.movement_sd) ** 2 * (1.0 - self.rho**2)
        rise, moving = np.array([dt_s**2 / 6.0, dt_s / 2.0, 1.0]), slice(layout.a.stop)
        self.Q = np.zeros((layout.size, layout.size))
        self.Q[moving, moving] = np.kron(np.outer(rise, rise), np.diag(variance))

    def move(self, state):
        q = self.model.integrate(state.q, self.dt_s * state.v + self.c2 * state.a)
        return replace(state, q=q, v=state.v + self.c1 * state.a, a=self.rho * state.a)

    def transition(self, state):
        (q, v, a), phi = (self.layout.q, self.layout.v, self.layout.a), np.eye(self.layout.size)
        step = self.dt_s * state.v + self.c2 * state.a
        phi[q, q], by_step = self.model.integration_derivatives(state.q, step)
        phi[q, v], phi[q, a] = by_step * self.dt_s, by_step * self.c2
        phi[v, a], phi[a, a] = np.diag(self.c1), np.diag(self.rho)
        return phi

    def noise(self, memory):
        return self.Q


person, recorded = mbkf.synthesise("walk", seconds=2.0, seed=3)
causal, errors = mbkf.ReconstructSettings(smooth=False), {}
for name, plant in {"standard plant": None, "a time per joint": JointTimes}.items():
    result = mbkf.reconstruct(recorded.trial, person, settings=causal, plant=plant)
    errors[name] = np.sqrt(np.nanmean((result.tau - recorded.truth.tau)[:, 6:] ** 2))
    print(f"{name}: joint torques {errors[name]:.2f} N m RMS from the truth")
assert errors["a time per joint"] < errors["standard plant"]
