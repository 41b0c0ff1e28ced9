"""The joints of a Pinocchio model, and where a configuration places them, as CasADi expressions."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.kernel.tree import FREE, HINGE, KINDS, SPHERICAL, hinge_axis
from mbkf.model.symbolic import manifold
from mbkf.model.symbolic.spatial import constant, rotation_about, rotation_of


@dataclass(frozen=True)
class Pose:
    """Rotation (3, 3) and origin (3,) of a frame in another one, m."""

    rotation: ca.SX
    origin: ca.SX

    def __matmul__(self, inner: Pose) -> Pose:
        """A pose in this frame, seen from the frame that this one lies in."""
        return Pose(self.rotation @ inner.rotation, self.origin + self.rotation @ inner.origin)


@dataclass(frozen=True)
class SymbolicJoint:
    """A joint with the segment that it carries.

    Attributes:
        kind: ``FREE``, ``SPHERICAL`` or ``HINGE`` of :mod:`mbkf.kernel.tree`.
        parent: Index of the joint before it; 0 is the world.
        q, v: Its slices of configuration and tangent vector.
        place: Its frame in its parent's at rest.
        axis: (3,) unit axis of a hinge; zeros for other kinds.
        subspace: S (6, d) of its motion, S v (linear, angular) in its own frame.
        inertia: (6, 6) spatial inertia of its segment about its origin.
    """

    kind: int
    parent: int
    q: slice
    v: slice
    place: Pose
    axis: Array
    subspace: ca.SX
    inertia: ca.SX

    def moved(self, q: ca.SX) -> Pose:
        """Its frame in its parent's at a configuration of the whole body."""
        own = q[self.q]
        if self.kind == FREE:
            return self.place @ Pose(rotation_of(own[3:]), own[:3])
        turn = rotation_of(own) if self.kind == SPHERICAL else rotation_about(self.axis, own)
        return Pose(self.place.rotation @ turn, self.place.origin)


@dataclass(frozen=True)
class SymbolicTree:
    """A Pinocchio model whose root joint is free.

    Attributes:
        joints: Its joints, from the root outward, without the world: joint i of Pinocchio is at i − 1.
        nq, nv: Numbers of a configuration, and degrees of freedom.
        gravity: (6,) acceleration by gravity (linear, angular), m/s².
    """

    joints: tuple[SymbolicJoint, ...]
    nq: int
    nv: int
    gravity: Array

    @classmethod
    def of(cls, model: pin.Model) -> SymbolicTree:
        """Reads a model; later changes of it do not count.

        Raises:
            InvalidInput: A joint is of another kind than free, spherical or hinge.
        """
        joints = tuple(_joint(model, index) for index in range(1, model.njoints))
        return cls(joints, model.nq, model.nv, np.array(model.gravity.vector))

    def relative(self, q: ca.SX) -> list[Pose]:
        """Every joint's frame in its parent's."""
        return [joint.moved(q) for joint in self.joints]

    def world(self, q: ca.SX) -> list[Pose]:
        """Every joint's frame in the world."""
        poses: list[Pose] = []
        for joint, own in zip(self.joints, self.relative(q), strict=True):
            poses.append(poses[joint.parent - 1] @ own if joint.parent else own)
        return poses

    def chain(self, index: int) -> list[int]:
        """Places in ``joints`` of all joints that move joint ``index`` (of Pinocchio), from it to the root."""
        found = []
        while index:
            found.append(index - 1)
            index = self.joints[index - 1].parent
        return found

    def integrate(self, q: ca.SX, dv: ca.SX) -> ca.SX:
        """(nq,) configuration q ⊕ dv."""
        steps = {FREE: manifold.stepped_pose, SPHERICAL: manifold.stepped_rotation, HINGE: _sum}
        return ca.vertcat(*(steps[joint.kind](q[joint.q], dv[joint.v]) for joint in self.joints))

    def difference(self, q0: ca.SX, q1: ca.SX) -> ca.SX:
        """(nv,) tangent vector from q0 to q1."""
        ways = {FREE: manifold.pose_difference, SPHERICAL: manifold.rotation_difference, HINGE: _less}
        return ca.vertcat(*(ways[joint.kind](q0[joint.q], q1[joint.q]) for joint in self.joints))


def _joint(model: pin.Model, index: int) -> SymbolicJoint:
    joint, inertia = model.joints[index], model.inertias[index]
    name = joint.shortname()
    if name not in KINDS:
        raise InvalidInput(
            f"joint '{model.names[index]}' is a {name}; CasADi functions exist for free, spherical and revolute "
            "joints. Replace it in the body's file"
        )
    kind = KINDS[name]
    axis = hinge_axis(joint) if kind == HINGE else np.zeros(3)
    subspaces = {
        FREE: np.eye(6),
        SPHERICAL: np.eye(6)[:, 3:],
        HINGE: np.concatenate([np.zeros(3), axis])[:, None],
    }
    place = model.jointPlacements[index]
    return SymbolicJoint(
        kind,
        model.parents[index],
        slice(joint.idx_q, joint.idx_q + joint.nq),
        slice(joint.idx_v, joint.idx_v + joint.nv),
        Pose(constant(place.rotation), constant(place.translation)),
        axis,
        constant(subspaces[kind]),
        constant(inertia.matrix()),
    )


def _sum(q: ca.SX, dv: ca.SX) -> ca.SX:
    return q + dv


def _less(q0: ca.SX, q1: ca.SX) -> ca.SX:
    return q1 - q0
