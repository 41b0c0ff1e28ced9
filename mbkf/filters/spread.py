"""What a covariance says about the numbers people read: dofs, clinical angles, torques, height of the feet.

Taken frame by frame, so that long trials need not keep a covariance matrix per frame. Each number has two parts,
independent of each other: that of the filter (noise, skin), by its covariance, and the offset that repeats in the same
posture, caused by errors of the scaled body (:mod:`mbkf.filters.body_errors`) and by a coordinate's zero, which differs
among persons. The change of the offset with the posture needs the whole trial (:mod:`mbkf.filters.offset_change`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.coordinate_variances import CoordinateVariances, DofVariances
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.layout import FEET, Layout

ASKED = ("torques", "angles")
"""Standard deviations that a trial or a stream need not ask for: of generalised forces, and of clinical coordinates and
their rates. Those of configuration, velocity and the feet's wrenches cost next to nothing."""


class SpreadReader:
    """Reads standard deviations off the covariances of a body's filter.

    Attributes:
        model: The body.
        clinical: Its clinical coordinates, A of them.
        coordinates: Reads the coordinates' variances, from covariances of their dofs.
    """

    def __init__(self, model: Body) -> None:
        self.model, self.clinical = model, ClinicalAngles(model)
        self.coordinates = CoordinateVariances(self.clinical)
        feet = [model.joint(segment).joint_id for segment in model.roles.feet]
        self._moves = np.ascontiguousarray(model.supports[feet], dtype=float)
        self._feet = np.array(feet, dtype=np.int32)
        self._tree = model.tree
        self._origins = [4 * joint + 3 for joint in feet]

    def torque_variance(self, q: Array, step_covariance: Array, dt_s: float) -> Array:
        """(nv,) variances of the generalised forces that thesis eq. 3.7's accelerations cause, M (v_k − v_{k−1}) / Δt.

        Args:
            q: (nq,) configuration.
            step_covariance: (nv, nv) covariance of v_k − v_{k−1}.
            dt_s: Time step Δt.
        """
        M = self.model.mass_matrix(q)
        return ((M @ step_covariance) * M).sum(axis=1) / dt_s**2

    def rise_jacobian(self, q: Array) -> Array:
        """(2, nv) derivative of the height of right and left foot by the configuration q (nq,)."""
        if self._tree is not None:
            return self._tree.height_jacobian(q, self._feet)
        frames, jacobian = self.model.frames_and_jacobian(q)
        x, y, _ = frames[self._origins].T[:, :, None]
        rise: Array = jacobian[3] * y
        rise -= jacobian[4] * x
        rise += jacobian[2]
        rise *= self._moves
        return rise

    def parts(self, q: Array, P: Array) -> ConfigurationParts:
        """Standard deviations of a covariance P (nv, nv) of the configuration q (nq,)."""
        rise, dofs = self.rise_jacobian(q), self.coordinates.dofs
        return ConfigurationParts(((rise @ P) * rise).sum(axis=1), P[dofs[:, :, None], dofs[:, None, :]])


class ConfigurationParts(NamedTuple):
    """Parts of a covariance of the configuration.

    Attributes:
        foot_height: (2,) variances of the height of right and left foot, m².
        blocks: (n + 1, 3, 3) covariances of the dofs :attr:`CoordinateVariances.dofs`.
    """

    foot_height: Array
    blocks: Array


@dataclass(frozen=True)
class Spread:
    """Standard deviations at one instant, offset included; most are worked out when asked for.

    Attributes:
        reader: The body's.
        q: (nq,) configuration.
        position_variance: (nv,) of the configuration in its tangent space, by the filter.
        velocity_variance: (nv,) of the velocities, by the filter.
        torque_variance: (nv,) of the generalised forces, by the filter; NaN where nothing is known of them.
        parts: What else is asked of the filter's covariance of the configuration, worked out once.
        body: Roots of the errors by the person's body; None where they are not known.
        wrench_variance: (12,) of the feet's wrenches, by the filter; NaN where it estimates none.
        level_variance: (2, L, 3) of the trunk's moments at the body's levels by way, by the filter; None where they are
            not asked for, or not known.
    """

    reader: SpreadReader
    q: Array
    position_variance: Array
    velocity_variance: Array
    torque_variance: Array
    parts: Callable[[], ConfigurationParts]
    body: BodyErrorRoots | None = None
    wrench_variance: Array = field(default_factory=lambda: np.full(FEET, np.nan))
    level_variance: Array | None = None

    @property
    def position(self) -> Array:
        """(nv,) of the configuration in its tangent space, rad or m."""
        return self._with(self.position_variance, None if self.body is None else self.body.position_variance)

    @property
    def position_offset(self) -> Array:
        """(nv,) the offset's part of it."""
        return self._zeros if self.body is None else np.sqrt(self.body.position_variance)

    @property
    def velocity(self) -> Array:
        """(nv,) of the velocity."""
        return self._with(self.velocity_variance, None if self.body is None else self.body.velocity_variance)

    @property
    def velocity_offset(self) -> Array:
        """(nv,) the offset's part of it."""
        return self._zeros if self.body is None else np.sqrt(self.body.velocity_variance)

    @property
    def offset_covariance(self) -> Array:
        """(2 nv, 2 nv) covariance of the offset's part of configuration and velocity."""
        if self.body is None:
            size = Layout.kinematic(len(self.position_variance)).size
            return np.zeros((size, size))
        roots = np.vstack([self.body.position, self.body.velocity])
        return roots @ roots.T

    @property
    def torque(self) -> Array:
        """(nv,) of the generalised forces; NaN where nothing is known of them."""
        return self._with(self.torque_variance, None if self.body is None else self.body.torque_variance)

    @property
    def torque_offset(self) -> Array:
        """(nv,) the offset's part of it."""
        return self._zeros if self.body is None else np.sqrt(self.body.torque_variance)

    @property
    def wrench_offset(self) -> Array:
        """(2, 6) the offset's part of the feet's wrenches, which a plate's reading has none of: N, N m."""
        return np.zeros((2, 6)) if self.body is None else np.sqrt(self.body.wrench_variance)

    @property
    def angle(self) -> Array:
        """(A,) of the clinical coordinates."""
        return self.coordinates[0]

    @property
    def angle_offset(self) -> Array:
        """(A,) the offset's part of it."""
        return self.coordinates[2]

    @property
    def rate(self) -> Array:
        """(A,) of their rates, from the velocities' own variances."""
        return self.coordinates[1]

    @property
    def rate_offset(self) -> Array:
        """(A,) the offset's part of it."""
        return self.coordinates[3]

    @property
    def ball_covariance(self) -> Array:
        """(n, 3, 3) covariances of the rotations of the n joints with three angles, in distal axes, rad²."""
        return self.balls[0]

    @property
    def ball_offset(self) -> Array:
        """(n, 3, 3) the offset's part of it."""
        return self.balls[1]

    @property
    def balls(self) -> tuple[Array, Array]:
        """:attr:`ball_covariance` and :attr:`ball_offset`."""
        own = self._parts.blocks[:-1]
        if self.body is None:
            return own, np.zeros(own.shape)
        offset = self.body.blocks(self.reader.coordinates.dofs)[0][:-1]
        return own + offset, offset

    @property
    def foot_height(self) -> Array:
        """(2,) of the height of right and left foot, m, by the filter."""
        return root(self._parts.foot_height)

    @cached_property
    def _parts(self) -> ConfigurationParts:
        return self.parts()

    @cached_property
    def coordinates(self) -> Array:
        """(4, A) of the clinical coordinates and their rates, and the offset's part of both."""
        reader, body = self.reader.coordinates, self.body
        own = DofVariances(self.position_variance, self.velocity_variance, self._parts.blocks, None)
        if body is None:
            return reader.deviations(self.q, own, None)
        of_body = DofVariances(body.position_variance, body.velocity_variance, *body.blocks(reader.dofs))
        return reader.deviations(self.q, own, of_body)

    @property
    def _zeros(self) -> Array:
        return np.zeros(len(self.position_variance))

    def _with(self, variance: Array, offset: Array | None) -> Array:
        """Standard deviation of two independent parts."""
        own = np.maximum(variance, 0.0)
        return np.sqrt(own if offset is None else own + offset)


def root(variance: Array) -> Array:
    """Square root; rounding may leave a variance of zero a little below it."""
    return np.sqrt(np.maximum(variance, 0.0))
