"""Plant of the kinematic filter: discrete white noise acceleration (thesis eqs. 3.1–3.3).

Bar-Shalom, Li, Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, 6.3.2.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.plant import Plant
from mbkf.kernel.covariance import joint_ranges
from mbkf.kernel.loading import library
from mbkf.model.body import Body
from mbkf.model.layout import Layout
from mbkf.numerics.transition import RateTransition


@dataclass(frozen=True)
class KinematicState:
    """Positions and velocities.

    Attributes:
        q: (nq,) configuration.
        v: (nv,) velocity, rad/s and m/s in the joints' own axes.
        P: (2 nv, 2 nv) covariance of (q, v) in the tangent space.
    """

    q: Array
    v: Array
    P: Array

    def retracted(self, model: Body, step: Array, P: Array) -> KinematicState:
        """The state moved by a tangent vector.

        Args:
            model: The body.
            step: (2 nv,) tangent vector.
            P: (2 nv, 2 nv) covariance of the moved state.
        """
        nv = len(self.v)
        return KinematicState(model.integrate(self.q, step[:nv]), self.v + step[nv:], P)

    def minus(self, model: Body, origin: KinematicState) -> Array:
        """(2 nv,) tangent vector from the mean of another state to this one's."""
        return np.concatenate([model.difference(origin.q, self.q), self.v - origin.v])

    def reversed_in_time(self) -> KinematicState:
        """The same instant of the motion played backwards: v changes sign, and its covariance with q."""
        nv = len(self.v)
        sign = np.concatenate([np.ones(nv), -np.ones(nv)])
        return KinematicState(self.q, -self.v, sign[:, None] * self.P * sign)


class WhiteAccelerationPlant(Plant[KinematicState, Array, None]):
    """q' = q ⊕ (v Δt + a Δt²/2), v' = v + a Δt with a white, constant over the step.

    Φ = [[A, B Δt], [0, 1]] is exact on the manifold: A and B are the derivatives of the retraction, which reduce to 1
    for a translation.

    Attributes:
        model: The body.
        layout: Slices of the tangent state.
        dt_s: Time step Δt.
        acceleration_sd: (nv,) σ_a of each dof; 0 holds a dof where it is.
        position_noise, cross_noise, velocity_noise: (nv,) diagonals of the three blocks of the noise covariance.
        diagonals: (2, 2, nv) the same.
        joint_ranges: (J, 2) first dof and end of each joint.
    """

    def __init__(self, model: Body, dt_s: float, acceleration_sd: Array) -> None:
        super().__init__(model, Layout.kinematic(model.nv), dt_s)
        self.acceleration_sd = acceleration_sd
        variance = acceleration_sd**2
        self.position_noise = variance * dt_s**4 / 4.0
        self.cross_noise = variance * dt_s**3 / 2.0
        self.velocity_noise = variance * dt_s**2
        self.diagonals = np.array(
            [[self.position_noise, self.cross_noise], [self.cross_noise, self.velocity_noise]]
        )
        self._noise = np.block([[np.diag(own) for own in row] for row in self.diagonals])
        self.joint_ranges = joint_ranges(joint.v for joint in model.joints.values())
        self._push, self._rates = np.array([dt_s]), np.ones((1, 1))
        self._kernel = library()

    def noise(self, memory: None) -> Array:
        """(2 nv, 2 nv) Q, the same in every step."""
        return self._noise

    def move(self, state: KinematicState) -> KinematicState:
        """The state at steady velocity: q ⊕ v Δt, v."""
        return replace(state, q=self.model.integrate(state.q, state.v * self.dt_s))

    def transition(self, state: KinematicState) -> Array:
        """(2 nv, 2 nv) Φ at a state."""
        return self._parts(state).matrix(self.layout.size)

    def step_transition(self, before: KinematicState, predicted: KinematicState) -> RateTransition:
        """Φ of a step, by its parts."""
        return self._parts(before)

    def _parts(self, state: KinematicState) -> RateTransition:
        A, B = self.model.integration_derivatives(state.q, state.v * self.dt_s)
        return RateTransition(A, B, self.joint_ranges, self._push, self._rates)

    def predict(self, state: KinematicState, noise: Array | None = None) -> KinematicState:
        """The state one step later; its P = Φ P Φᵀ + Q is exactly symmetric and in Fortran order."""
        if self._kernel is None:
            return super().predict(state, self._noise)
        step = state.v * self.dt_s
        A, B = map(np.ascontiguousarray, self.model.integration_derivatives(state.q, step))
        P = self._kernel.propagate_velocities(state.P, A, B, self.joint_ranges, self.dt_s, self.diagonals)
        return KinematicState(self.model.integrate(state.q, step), state.v, P.T)
