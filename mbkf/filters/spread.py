"""What a covariance says about the numbers people read: dofs, clinical angles, torques, height of the feet.

Taken frame by frame, so that long trials need not keep a covariance matrix per frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.state import FilterState
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.sensors.contacts import FEET


@dataclass(frozen=True)
class Spread:
    """Standard deviations at one instant.

    Attributes:
        position: (nv,) of the configuration in its tangent space, rad or m.
        velocity: (nv,) of the velocity.
        angle: (A,) of the clinical coordinates.
        rate: (A,) of their rates, from the velocities' own variances.
        torque: (nv,) of the generalised forces that the accelerations' spread causes; NaN at a start.
        foot_height: (2,) of the height of right and left foot, m.
    """

    position: Array
    velocity: Array
    angle: Array
    rate: Array
    torque: Array
    foot_height: Array


class SpreadReader:
    """Reads standard deviations off the covariances of a body's filter."""

    def __init__(self, model: HumanModel, dt_s: float) -> None:
        self.model, self.dt_s = model, dt_s
        self._clinical = ClinicalAngles(model)
        self._feet = [model.joint(segment).joint_id for segment in FEET]

    @property
    def coordinates(self) -> int:
        """Number A of clinical coordinates."""
        return len(self._clinical.names)

    def at(self, state: FilterState, velocity_step_covariance: Array | None = None) -> Spread:
        """Standard deviations of a state.

        Args:
            state: Posterior of a frame.
            velocity_step_covariance: (nv, nv) covariance of v_k − v_{k−1}, which gives that of eq. 3.7's
                accelerations; None at a start.
        """
        nv, q = self.model.nv, state.q
        P = state.P[:nv, :nv]
        variance = np.diag(state.P)
        E = self._clinical.rate_matrix(q)
        torque = np.full(nv, np.nan)
        if velocity_step_covariance is not None:
            M = self.model.mass_matrix(q)
            torque = _root(((M @ velocity_step_covariance) * M).sum(axis=1)) / self.dt_s
        return Spread(
            position=_root(variance[:nv]),
            velocity=_root(variance[nv:]),
            angle=_root(((E @ P) * E).sum(axis=1)),
            rate=_root(E**2 @ variance[nv:]),
            torque=torque,
            foot_height=self._foot_height(q, P),
        )

    def _foot_height(self, q: Array, P: Array) -> Array:
        _, origins, jacobian = self.model.placements_and_jacobian(q)
        x, y, _ = origins[self._feet].T[:, :, None]
        rise = (jacobian[2] + jacobian[3] * y - jacobian[4] * x) * self.model.supports[self._feet]
        return _root(((rise @ P) * rise).sum(axis=1))


def _root(variance: Array) -> Array:
    """Square root; rounding may leave a variance of zero a little below it."""
    return np.sqrt(np.maximum(variance, 0.0))
