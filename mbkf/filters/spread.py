"""What a covariance says about the numbers people read: dofs, clinical angles, torques, height of the feet.

Taken frame by frame, so that long trials need not keep a covariance matrix per frame.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles


class SpreadReader:
    """Reads standard deviations off the covariances of a body's filter.

    Attributes:
        model: The body.
        clinical: Its clinical coordinates, A of them.
    """

    def __init__(self, model: Body) -> None:
        self.model, self.clinical = model, ClinicalAngles(model)
        self._feet = [model.joint(segment).joint_id for segment in model.roles.feet]

    def torque(self, q: Array, step_covariance: Array, dt_s: float) -> Array:
        """(nv,) of the generalised forces that thesis eq. 3.7's accelerations cause, M (v_k − v_{k−1}) / Δt.

        Args:
            q: (nq,) configuration.
            step_covariance: (nv, nv) covariance of v_k − v_{k−1}.
            dt_s: Time step Δt.
        """
        M = self.model.mass_matrix(q)
        return root(((M @ step_covariance) * M).sum(axis=1)) / dt_s

    def foot_height(self, q: Array, P: Array) -> Array:
        """(2,) of the feet, for the covariance P (nv, nv) of the configuration."""
        _, origins, jacobian = self.model.placements_and_jacobian(q)
        x, y, _ = origins[self._feet].T[:, :, None]
        rise = (jacobian[2] + jacobian[3] * y - jacobian[4] * x) * self.model.supports[self._feet]
        return root(((rise @ P) * rise).sum(axis=1))


@dataclass(frozen=True)
class Spread:
    """Standard deviations at one instant; those of clinical coordinates and feet are worked out when asked for.

    Attributes:
        reader: The body's.
        q: (nq,) configuration.
        position_variance: (nv,) of the configuration in its tangent space.
        velocity_variance: (nv,) of the velocities.
        torque: (nv,) of the generalised forces; NaN where nothing is known of them.
        covariance: Makes the (nv, nv) covariance of the configuration.
    """

    reader: SpreadReader
    q: Array
    position_variance: Array
    velocity_variance: Array
    torque: Array
    covariance: Callable[[], Array]

    @property
    def position(self) -> Array:
        """(nv,) of the configuration in its tangent space, rad or m."""
        return root(self.position_variance)

    @property
    def velocity(self) -> Array:
        """(nv,) of the velocity."""
        return root(self.velocity_variance)

    @cached_property
    def _position(self) -> Array:
        return self.covariance()

    @cached_property
    def _rate_matrix(self) -> Array:
        return self.reader.clinical.rate_matrix(self.q)

    @property
    def angle(self) -> Array:
        """(A,) of the clinical coordinates."""
        E = self._rate_matrix
        return root(((E @ self._position) * E).sum(axis=1))

    @property
    def rate(self) -> Array:
        """(A,) of their rates, from the velocities' own variances."""
        return root(self._rate_matrix**2 @ self.velocity_variance)

    @property
    def ball_covariance(self) -> Array:
        """(n, 3, 3) covariances of the rotations of the n joints with three angles, in distal axes, rad²."""
        turns = self.reader.clinical.ball_turns
        return self._position[turns[:, :, None], turns[:, None, :]]

    @property
    def foot_height(self) -> Array:
        """(2,) of the height of right and left foot, m."""
        return self.reader.foot_height(self.q, self._position)


def root(variance: Array) -> Array:
    """Square root; rounding may leave a variance of zero a little below it."""
    return np.sqrt(np.maximum(variance, 0.0))
