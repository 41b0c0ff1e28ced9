"""Interface of a scaled body, as filters and sensors need it: manifold, joints, masses, priors and roles.

:class:`~mbkf.model.human.HumanModel` implements it from a body file. The kinematic filter follows any other class
with these members as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import pinocchio as pin

from mbkf.conventions import Array, BoolArray
from mbkf.kernel.tree import CompiledTree
from mbkf.model.description import BodyDescription, Roles, Segment


@dataclass(frozen=True)
class SegmentJoint:
    """Place of a segment's joint among the joints, in q and in v.

    Attributes:
        segment: Segment name.
        kind: "free", "spherical", "universal" or "hinge".
        axes: Axes that a universal joint or a hinge turns about, e.g. "y"; "" for the others.
        joint_id: Index of the joint that carries the segment, in :meth:`Body.placements` and ``supports``.
        q: Slice of the configuration.
        v: Slice of the tangent space.
    """

    segment: str
    kind: str
    axes: str
    joint_id: int
    q: slice
    v: slice


@runtime_checkable
class Body(Protocol):
    """A scaled body. Configurations q (nq,) lie on a manifold whose tangent vectors v have nv components.

    Attributes:
        description: The reference body.
        roles: Roles of its segments in the algorithms (root, feet, toes, …).
        scale: (K,) independent scale factors.
        mass_kg: Mass of the whole body.
        nq, nv: Dimensions of configuration and tangent space.
        joints: The joint of every segment, by segment name, depth-first.
        posture_sd: (nv,) spread of each dof about the neutral posture, rad; 0 without a prior.
        acceleration_sd: (nv,) typical acceleration of each dof, m/s² or rad/s².
        movement_sd: (nv,) standard deviation of each dof's acceleration over a movement, m/s² or rad/s².
        limits: (nv, 2) least and greatest rotation from neutral, rad; ±inf without a limit.
        supports: (joints, nv) True where a dof moves a joint's segment.
        pin_model: The Pinocchio model (gravity along −z), for the equations that take it directly.
    """

    description: BodyDescription
    roles: Roles
    scale: Array
    mass_kg: float
    nq: int
    nv: int
    joints: Mapping[str, SegmentJoint]
    posture_sd: Array
    acceleration_sd: Array
    movement_sd: Array
    limits: Array
    supports: BoolArray
    pin_model: pin.Model

    @property
    def root(self) -> SegmentJoint:
        """The free joint of the root segment."""

    @property
    def tree(self) -> CompiledTree | None:
        """The body's equations in compiled code; None without the compiled kernel."""

    def joint(self, segment: str) -> SegmentJoint:
        """The joint that carries a segment.

        Raises:
            UnknownName: The segment does not exist.
        """

    def axis_scale(self, segment: Segment) -> Array:
        """(3,) scale factors of a segment's x, y, z axes."""

    def neutral(self) -> Array:
        """(nq,) standing posture at the world's origin, facing +x."""

    def integrate(self, q: Array, dv: Array) -> Array:
        """(nq,) configuration reached from q by the tangent vector dv (nv,)."""

    def difference(self, q0: Array, q1: Array) -> Array:
        """(nv,) tangent vector that takes q0 to q1."""

    def integration_derivatives(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """(nv, nv) derivatives of :meth:`integrate` by q and by dv."""

    def difference_derivative(self, q0: Array, q1: Array) -> Array:
        """(nv, nv) derivative of :meth:`difference` by q1."""

    def placements(self, q: Array) -> tuple[Array, Array]:
        """World rotations (J, 3, 3) and origins (J, 3) of all joints (index 0 is the world)."""

    def placements_and_jacobian(self, q: Array) -> tuple[Array, Array, Array]:
        """Placements, and J (6, nv): each dof's spatial velocity at the world's origin, (linear, angular)."""

    def frames(self, q: Array) -> Array:
        """(4 J, 3): of every joint its world x, y, z axes and its origin, one below the other."""

    def frames_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """:meth:`frames` and :meth:`spatial_jacobian` in one pass."""

    def spatial_jacobian(self, q: Array) -> Array:
        """J (6, nv) of :meth:`placements_and_jacobian` alone."""

    def mass_matrix(self, q: Array) -> Array:
        """(nv, nv) symmetric mass matrix."""

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """(nv,) generalised forces M a − Q_g for given motion, without contact.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
        """

    def segment_jacobian(self, q: Array, segment: str, point_m: Array) -> Array:
        """World Jacobian of a point fixed to a segment.

        Args:
            q: (nq,) configuration.
            segment: Name of the segment.
            point_m: (3,) the point in the world, m.

        Returns:
            (6, nv) rows linear, then angular, in world axes.

        Raises:
            UnknownName: The segment does not exist.
        """
