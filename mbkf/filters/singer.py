"""Decaying accelerations (Singer 1970): the plant of the dynamic filter, state q, v, a and the feet's wrenches.

Each dof's acceleration is a first-order Gauss–Markov process, ȧ = −a/T + jerk noise, with a stationary standard
deviation σ_a; T → ∞ with σ_a²/T fixed is the constant-acceleration plant. Wrenches are random walks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from mbkf.conventions import Array
from mbkf.model.human import HumanModel


@dataclass(frozen=True)
class DynamicState:
    """Mean and covariance of positions, velocities, accelerations and foot wrenches.

    Attributes:
        q: (nq,) configuration.
        v, a: (nv,) velocity and acceleration in the joints' own axes: rad/s, m/s, rad/s², m/s².
        w: (12,) wrench of the ground on right and left foot: force N, moment N m about the world's origin, world axes.
        P: (3 nv + 12, 3 nv + 12) covariance of (q, v, a, w) in the tangent space.
    """

    q: Array
    v: Array
    a: Array
    w: Array
    P: Array


class SingerPlant:
    """q' = q ⊕ (v Δt + a c₂), v' = v + a c₁, a' = ρ a, w' = w with ρ = e^(−Δt/T), c₁ = T(1 − ρ), c₂ = T(Δt − c₁).

    Attributes:
        model: The body.
        dt_s: Time step Δt.
        acceleration_sd: (nv,) σ_a; 0 holds a dof where it is.
        decay_s: T.
        rho, c1, c2: The factors above.
        noise: (3, 3) covariance of (q, v, a) after one step for σ_a = 1.
    """

    def __init__(self, model: HumanModel, dt_s: float, acceleration_sd: Array, decay_s: float) -> None:
        self.model, self.dt_s = model, dt_s
        self.acceleration_sd, self.decay_s = acceleration_sd, decay_s
        self.rho = float(np.exp(-dt_s / decay_s))
        self.c1 = -decay_s * float(np.expm1(-dt_s / decay_s))
        self.c2 = decay_s * (dt_s - self.c1)
        self.noise = _singer_noise(dt_s, decay_s)
        # Where in P the diagonals of the nine blocks of q, v and a lie.
        row, column, dof = np.ogrid[:3, :3, : model.nv]
        size = 3 * model.nv + 12
        self._diagonals = (row * model.nv + dof) * size + column * model.nv + dof

    def transition(self, state: DynamicState) -> Array:
        """(N, N) Φ at a state."""
        nv, n = self.model.nv, len(state.P)
        phi = np.eye(n)
        A, B = self.model.integration_derivatives(state.q, self.dt_s * state.v + self.c2 * state.a)
        phi[:nv, :nv] = A
        phi[:nv, nv : 2 * nv] = B * self.dt_s
        phi[:nv, 2 * nv : 3 * nv] = B * self.c2
        every = np.arange(nv)
        phi[nv + every, 2 * nv + every] = self.c1
        phi[2 * nv + every, 2 * nv + every] = self.rho
        return phi

    def predict(self, state: DynamicState, acceleration_sd: Array | None = None) -> DynamicState:
        """The state one step later; its P = Φ P Φᵀ + Q is exactly symmetric, new, and in C order.

        Nothing is added to the wrenches: how they wander depends on where the feet then are.

        Args:
            state: State.
            acceleration_sd: (nv,) σ_a for this step; None for the plant's own.
        """
        step = self.dt_s * state.v + self.c2 * state.a
        A, B = self.model.integration_derivatives(state.q, step)
        sd = self.acceleration_sd if acceleration_sd is None else acceleration_sd
        P = self._carried(A, B, state.P if state.P.flags.c_contiguous else state.P.T)
        P.reshape(-1)[self._diagonals] += self.noise[:, :, None] * (sd * sd)
        q = self.model.integrate(state.q, step)
        return DynamicState(q, state.v + self.c1 * state.a, self.rho * state.a, state.w, P)

    def _carried(self, A: Array, B: Array, P: Array) -> Array:
        """(N, N) Φ P Φᵀ from the blocks of a symmetric P, with Φ_q = [A, B Δt, B c₂, 0]."""
        nv = self.model.nv
        q, v, a, w = slice(nv), slice(nv, 2 * nv), slice(2 * nv, 3 * nv), slice(3 * nv, None)
        new = np.empty(P.shape)
        self._carry_rates(P, new)
        by_step = B * self.dt_s
        rows = A @ P[q]
        rows += by_step @ self._pushed(P[v], P[a])
        half = rows[:, q] @ A.T
        half += self._pushed(rows[:, v], rows[:, a]) @ by_step.T
        half *= 0.5
        np.add(half, half.T, out=new[q, q])
        ahead = new[q, v]
        np.multiply(rows[:, a], self.c1, out=ahead)
        ahead += rows[:, v]
        np.multiply(rows[:, a], self.rho, out=new[q, a])
        new[q, w] = rows[:, w]
        new[nv:, q] = new[q, nv:].T
        return new

    def _pushed(self, v: Array, a: Array) -> Array:
        """What velocities and accelerations add to positions, per Δt: v + a c₂ / Δt."""
        pushed = a * (self.c2 / self.dt_s)
        pushed += v
        return pushed

    def _carry_rates(self, P: Array, new: Array) -> None:
        """The blocks of v, a and w, into ``new``."""
        nv, c1, rho = self.model.nv, self.c1, self.rho
        v, a, w = slice(nv, 2 * nv), slice(2 * nv, 3 * nv), slice(3 * nv, None)
        ahead = P[a] * c1
        ahead += P[v]
        half = ahead[:, a] * c1
        half += ahead[:, v]
        half *= 0.5
        np.add(half, half.T, out=new[v, v])
        np.multiply(ahead[:, a], rho, out=new[v, a])
        new[v, w] = ahead[:, w]
        np.multiply(P[a, a], rho * rho, out=new[a, a])
        np.multiply(P[a, w], rho, out=new[a, w])
        new[w, w] = P[w, w]
        new[2 * nv :, v] = new[v, 2 * nv :].T
        new[w, a] = new[a, w].T


def _singer_noise(dt_s: float, decay_s: float) -> Array:
    """(3, 3) ∫ e^(Fs) G Gᵀ e^(Fᵀs) ds over Δt for unit stationary variance (Van Loan 1978, eqs. 2.43, 2.44)."""
    F = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / decay_s]])
    blocks = np.zeros((6, 6))
    blocks[:3, :3], blocks[3:, 3:] = -F, F.T
    blocks[2, 5] = 2.0 / decay_s
    exponential = expm(blocks * dt_s)
    noise = exponential[3:, 3:].T @ exponential[:3, 3:]
    return 0.5 * (noise + noise.T)
