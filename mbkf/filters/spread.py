"""What a covariance says about the numbers people read: dofs, clinical angles, torques, height of the feet.

Taken frame by frame, so that long trials need not keep a covariance matrix per frame. Each number has two parts,
independent of each other: what varies within a trial (noise, skin), by the filter's covariance, and the offset that
repeats in the same posture, since the person's body is not known exactly (:mod:`mbkf.filters.body_errors`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
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

    def torque_variance(self, q: Array, step_covariance: Array, dt_s: float) -> Array:
        """(nv,) variances of the generalised forces that thesis eq. 3.7's accelerations cause, M (v_k − v_{k−1}) / Δt.

        Args:
            q: (nq,) configuration.
            step_covariance: (nv, nv) covariance of v_k − v_{k−1}.
            dt_s: Time step Δt.
        """
        M = self.model.mass_matrix(q)
        return ((M @ step_covariance) * M).sum(axis=1) / dt_s**2

    def foot_height(self, q: Array, P: Array) -> Array:
        """(2,) of the feet, for the covariance P (nv, nv) of the configuration."""
        _, origins, jacobian = self.model.placements_and_jacobian(q)
        x, y, _ = origins[self._feet].T[:, :, None]
        rise = (jacobian[2] + jacobian[3] * y - jacobian[4] * x) * self.model.supports[self._feet]
        return root(((rise @ P) * rise).sum(axis=1))


@dataclass(frozen=True)
class Spread:
    """Standard deviations at one instant, offset included; most are worked out when asked for.

    Attributes:
        reader: The body's.
        q: (nq,) configuration.
        position_variance: (nv,) of the configuration in its tangent space, by the filter.
        velocity_variance: (nv,) of the velocities, by the filter.
        torque_variance: (nv,) of the generalised forces, by the filter; NaN where nothing is known of them.
        covariance: Makes the filter's (nv, nv) covariance of the configuration.
        body: Roots of the errors by the person's body; None where they are not known.
    """

    reader: SpreadReader
    q: Array
    position_variance: Array
    velocity_variance: Array
    torque_variance: Array
    covariance: Callable[[], Array]
    body: BodyErrorRoots | None = None

    @property
    def position(self) -> Array:
        """(nv,) of the configuration in its tangent space, rad or m."""
        return np.hypot(root(self.position_variance), self.position_offset)

    @cached_property
    def position_offset(self) -> Array:
        """(nv,) the offset's part of it."""
        return self._lengths(None if self.body is None else self.body.position)

    @property
    def velocity(self) -> Array:
        """(nv,) of the velocity."""
        return np.hypot(root(self.velocity_variance), self.velocity_offset)

    @cached_property
    def velocity_offset(self) -> Array:
        """(nv,) the offset's part of it."""
        return self._lengths(None if self.body is None else self.body.velocity)

    @property
    def offset_covariance(self) -> Array:
        """(2 nv, 2 nv) covariance of the offset's part of configuration and velocity."""
        nv = len(self.position_variance)
        if self.body is None:
            return np.zeros((2 * nv, 2 * nv))
        roots = np.vstack([self.body.position, self.body.velocity])
        return roots @ roots.T

    @property
    def torque(self) -> Array:
        """(nv,) of the generalised forces; NaN where nothing is known of them."""
        return np.hypot(root(self.torque_variance), self.torque_offset)

    @cached_property
    def torque_offset(self) -> Array:
        """(nv,) the offset's part of it."""
        return self._lengths(None if self.body is None else self.body.torque)

    @property
    def wrench_offset(self) -> Array:
        """(2, 6) the offset's part of the feet's wrenches, which a plate's reading has none of: N, N m."""
        return np.zeros((2, 6)) if self.body is None else self._lengths(self.body.wrench).reshape(2, 6)

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
        return np.hypot(root(((E @ self._position) * E).sum(axis=1)), self.angle_offset)

    @cached_property
    def angle_offset(self) -> Array:
        """(A,) the offset's part of it."""
        return self._lengths(None if self.body is None else self._rate_matrix @ self.body.position)

    @property
    def rate(self) -> Array:
        """(A,) of their rates, from the velocities' own variances."""
        return np.hypot(root(self._rate_matrix**2 @ self.velocity_variance), self.rate_offset)

    @cached_property
    def rate_offset(self) -> Array:
        """(A,) the offset's part of it."""
        return self._lengths(None if self.body is None else self._rate_matrix @ self.body.velocity)

    @property
    def ball_covariance(self) -> Array:
        """(n, 3, 3) covariances of the rotations of the n joints with three angles, in distal axes, rad²."""
        turns = self.reader.clinical.ball_turns
        return self._position[turns[:, :, None], turns[:, None, :]] + self.ball_offset

    @cached_property
    def ball_offset(self) -> Array:
        """(n, 3, 3) the offset's part of it."""
        turns = self.reader.clinical.ball_turns
        if self.body is None:
            return np.zeros((len(turns), 3, 3))
        by_ball = self.body.position[turns]
        return by_ball @ by_ball.transpose(0, 2, 1)

    @property
    def foot_height(self) -> Array:
        """(2,) of the height of right and left foot, m, by the filter."""
        return self.reader.foot_height(self.q, self._position)

    def _lengths(self, roots: Array | None) -> Array:
        """(n,) √ of the squared sums of rows; 0 where there is no root."""
        return (
            np.zeros(len(self.position_variance))
            if roots is None
            else np.sqrt(np.einsum("ij,ij->i", roots, roots))
        )


def root(variance: Array) -> Array:
    """Square root; rounding may leave a variance of zero a little below it."""
    return np.sqrt(np.maximum(variance, 0.0))
