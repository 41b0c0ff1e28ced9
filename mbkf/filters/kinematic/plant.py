"""Plant of the kinematic filter: discrete white noise acceleration (thesis eqs. 3.1–3.3).

Bar-Shalom, Li, Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001, 6.3.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.filter import Plant
from mbkf.kernel.covariance import joint_ranges
from mbkf.kernel.loading import library
from mbkf.model.body import Body
from mbkf.numerics.diagonals import block_diagonals
from mbkf.numerics.rate_transition import RateTransition
from mbkf.sensors.block import Notes
from mbkf.sensors.layout import Layout


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

    def reversed_in_time(self) -> KinematicState:
        """The same instant of the motion played backwards: v changes sign, and its covariance with q."""
        nv = len(self.v)
        sign = np.concatenate([np.ones(nv), -np.ones(nv)])
        return KinematicState(self.q, -self.v, sign[:, None] * self.P * sign)


class WhiteAccelerationPlant(Plant[KinematicState]):
    """q' = q ⊕ (v Δt + a Δt²/2), v' = v + a Δt with a white, constant over the step.

    Φ = [[A, B Δt], [0, 1]] is exact on the manifold: A and B are the derivatives of the retraction, which reduce to 1
    for a translation.

    Attributes:
        model: The body.
        layout: Slices of the tangent state.
        dt_s: Time step Δt.
        acceleration_sd: (nv,) σ_a of each dof; 0 holds a dof where it is.
        position_noise, cross_noise, velocity_noise: (nv,) diagonals of the three blocks of the noise covariance.
    """

    def __init__(self, model: Body, dt_s: float, acceleration_sd: Array) -> None:
        self.model, self.dt_s = model, dt_s
        self.layout = Layout.of(model.nv, q=model.nv, v=model.nv)
        self.acceleration_sd = acceleration_sd
        variance = acceleration_sd**2
        self.position_noise = variance * dt_s**4 / 4.0
        self.cross_noise = variance * dt_s**3 / 2.0
        self.velocity_noise = variance * dt_s**2
        blocks = [[self.position_noise, self.cross_noise], [self.cross_noise, self.velocity_noise]]
        self._noise = np.array(blocks)
        self._joints = joint_ranges(joint.v for joint in model.joints.values())
        self._push, self._rates = np.array([dt_s]), np.ones((1, 1))
        self._kernel = library()

    def begin(self) -> None:
        """The noise is constant."""

    def noise(self, memory: None) -> Array:
        """(nv,) σ_a."""
        del memory
        return self.acceleration_sd

    def remember(self, posterior: KinematicState, notes: Notes, memory: None) -> None:
        """The noise is constant."""

    def difference(self, origin: KinematicState, state: KinematicState) -> Array:
        """(2 nv,) tangent vector from one state's mean to another's."""
        return np.concatenate([self.model.difference(origin.q, state.q), state.v - origin.v])

    def retract(self, state: KinematicState, step: Array, P: Array) -> KinematicState:
        """The state moved by a tangent vector (2 nv,), with another covariance."""
        nv = self.model.nv
        return KinematicState(self.model.integrate(state.q, step[:nv]), state.v + step[nv:], P)

    def transition(self, state: KinematicState) -> Array:
        """(2 nv, 2 nv) Φ at a state."""
        return self.transition_parts(state).matrix(2 * self.model.nv)

    def transition_parts(self, state: KinematicState) -> RateTransition:
        """Φ at a state, by its parts."""
        A, B = self.model.integration_derivatives(state.q, state.v * self.dt_s)
        return RateTransition(A, B, self._joints, self._push, self._rates)

    def predict(self, state: KinematicState, noise: Array | None = None) -> KinematicState:
        """The state one step later; its P = Φ P Φᵀ + Q is exactly symmetric and in Fortran order."""
        del noise
        transition = self.transition_parts(state)
        if self._kernel is not None:
            P = self._kernel.propagate_velocities(
                state.P,
                np.ascontiguousarray(transition.A),
                np.ascontiguousarray(transition.B),
                self._joints,
                self.dt_s,
                self._noise,
            )
        else:
            phi = transition.matrix(len(state.P))
            P = phi @ state.P @ phi.T
            P = 0.5 * (P + P.T)
            diagonals = block_diagonals(P, 2, self.model.nv)
            diagonals += self._noise
        return KinematicState(self.model.integrate(state.q, state.v * self.dt_s), state.v, P.T)
