"""A scaled body in Pinocchio: kinematics, dynamics and their derivatives in the tangent space.

The only door to Pinocchio's joints: free-flyer root, spherical joints as unit quaternions, universal joints as two
hinges one after the other, hinges. Joints are added depth-first, which Pinocchio's algorithms rely on.
Departs from thesis eq. 3.6, whose three angles of a segment are singular where its x axis is vertical: a level thigh.
Pinocchio: J. Carpentier et al., IEEE/SICE Int. Symp. System Integration 2019, 614-619.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.lib.stride_tricks import as_strided

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray, read_only
from mbkf.errors import InvalidInput, ShapeError, UnknownName
from mbkf.io.inertia import SegmentInertia
from mbkf.io.subject import STANDING_KEY, Subject
from mbkf.kernel.loading import library
from mbkf.kernel.tree import CompiledTree
from mbkf.model.body import Body, SegmentJoint
from mbkf.model.body_file import load_body, parse_body
from mbkf.model.description import JOINT_DOF, BodyDescription, Roles, Segment
from mbkf.model.joint_centres import centres_of
from mbkf.numerics.rotations import travel_by_turn


class HumanModel(Body):
    """A body scaled to one person.

    Attributes:
        inertia: By segment, the person's own mass and centre of mass, where they differ from the table.
        centres_m: (E,) displacements of joint centres from where the scale factors put them.
    """

    def __init__(
        self,
        description: BodyDescription,
        scale: Array,
        mass_kg: float,
        inertia: Mapping[str, SegmentInertia] | None = None,
        centres_m: Array | None = None,
    ) -> None:
        """Scales a reference body to one person.

        Args:
            description: The reference body.
            scale: (K,) independent scale factors.
            mass_kg: Body mass.
            inertia: By segment, the person's own mass and centre of mass; the table's where there is none. The whole
                body keeps its mass.
            centres_m: (E,) displacements of joint centres from where the scale factors put them
                (:mod:`mbkf.model.joint_centres`); 0 by default.

        Raises:
            ShapeError: The scale factors are not as many as the body has.
            InvalidInput: Mass or a factor is not positive.
            UnknownName: An inertia belongs to no segment.
        """
        self.description = description
        self.inertia, self._unit_kg = _own_inertia(description, inertia or {})
        self.roles: Roles = description.roles
        self.scale = read_only(scale)
        of_centres = [centre.segment for centre in description.joint_centres]
        displaced = np.zeros(3 * len(of_centres)) if centres_m is None else np.ravel(centres_m)
        self.centres_m = read_only(displaced)
        self._displaced = dict(zip(of_centres, np.reshape(displaced, (-1, 3)), strict=True))
        if self.scale.shape != (len(description.scale_factors),):
            raise ShapeError("scale", f"({len(description.scale_factors)},)", self.scale.shape)
        if not (np.isfinite(mass_kg) and mass_kg > 0):
            raise InvalidInput(f"the body mass must be positive, got {mass_kg} kg")
        if not (np.isfinite(self.scale).all() and (self.scale > 0).all()):
            raise InvalidInput(f"scale factors must be positive, got {self.scale.tolist()}")
        self.mass_kg = float(mass_kg)
        self.pin_model = pin.Model()
        self.pin_model.name = description.name
        self.pin_model.gravity.linear = np.array([0.0, 0.0, -GRAVITY_M_S2])
        joints: dict[str, SegmentJoint] = {}
        for segment in description.segments:
            joints[segment.name] = self._add(segment, joints)
        self.joints = joints
        if not _depth_first(self.pin_model.parents):
            raise InvalidInput(
                f"body {description.name} is not in depth-first order; list each segment after its parent's branch"
            )
        self.nq, self.nv = self.pin_model.nq, self.pin_model.nv
        segments = description.segments
        self.posture_sd = read_only(np.concatenate([_per_dof(s.posture_sd_rad, s) for s in segments]))
        self.acceleration_sd = read_only(np.concatenate([_per_dof(s.acceleration_sd, s) for s in segments]))
        self.movement_sd = read_only(np.concatenate([_per_dof(s.movement_sd, s) for s in segments]))
        self.limits = read_only(np.concatenate([s.limits_rad for s in segments]))
        self.supports = self._supports()
        self._tree: CompiledTree | None = None

    @classmethod
    def scaled(
        cls,
        factors: Mapping[str, float] | None = None,
        mass_kg: float | None = None,
        body: str | Path | BodyDescription = "human18",
        inertia: Mapping[str, SegmentInertia] | None = None,
    ) -> HumanModel:
        """A body from named scale factors and mass.

        Args:
            factors: Scale factor by name; 1 where there is none.
            mass_kg: Body mass; that of the reference body when None.
            body: The reference body: its name, its file, or the result of :func:`~mbkf.model.body_file.load_body`.
            inertia: By segment, the person's own mass and centre of mass; the table's where there is none.

        Raises:
            UnknownName: The body, a factor or a segment is unknown.
        """
        description = body if isinstance(body, BodyDescription) else load_body(body)
        for name in factors or {}:
            if name not in description.scale_factors:
                raise UnknownName("scale factor", name, description.scale_factors)
        scale = description.scale(factors or {})
        whole_kg = description.reference_mass_kg if mass_kg is None else mass_kg
        return cls(description, scale, whole_kg, inertia)

    @classmethod
    def of(cls, subject: Subject) -> HumanModel:
        """The scaled body of a subject.

        Raises:
            UnknownName: The subject's reference body, a scale factor or a displacement of a joint centre is unknown.
            FileFormatError: The body file that the subject carries is damaged.
            InvalidInput: A scale factor of the body is missing, or the standing posture belongs to another body.
        """
        body = reference_body(subject)
        centres_m = centres_of(subject, body)
        model = cls(body, scale_of(subject, body), subject.mass_kg, subject.inertia, centres_m)
        posture = subject.standing_q
        if posture is not None and posture.shape != (model.nq,):
            raise InvalidInput(
                f"the subject's standing posture ({STANDING_KEY} in its report) holds {posture.size} numbers instead "
                f"of the {model.nq} of the body '{body.name}'; scale the person again"
            )
        return model

    def with_inertias(self, inertias: Sequence[pin.Inertia]) -> HumanModel:
        """This body with the given inertia of each joint's segment (index 0 is the world)."""
        other = copy.copy(self)
        for kept in ("_data", "_frames"):
            other.__dict__.pop(kept, None)
        other.pin_model, other._tree = pin.Model(self.pin_model), None
        for joint, inertia in enumerate(inertias):
            other.pin_model.inertias[joint] = inertia
        return other

    @cached_property
    def _data(self) -> pin.Data:
        """Pinocchio's working memory, 5 MB: made where a function of this body needs it."""
        return pin.Data(self.pin_model)

    @cached_property
    def _frames(self) -> Array:
        return _frames_in(self._data)

    @property
    def root(self) -> SegmentJoint:
        """The free joint of the root segment."""
        return self.joints[self.roles.root]

    def _add(self, segment: Segment, before: Mapping[str, SegmentJoint]) -> SegmentJoint:
        model = self.pin_model
        parent_id, origin = 0, np.zeros(3)
        if segment.parent != "world":
            parent_id = before[segment.parent].joint_id
            origin = self.axis_scale(self.description.segment(segment.parent)) * segment.origin_m
            origin = origin + self._displaced.get(segment.name, 0.0)
        placement = pin.SE3(np.eye(3), origin)
        first_q, first_v = model.nq, model.nv
        turning = {"x": pin.JointModelRX, "y": pin.JointModelRY, "z": pin.JointModelRZ}
        for axis in segment.axes[:-1]:
            parent_id = model.addJoint(parent_id, turning[axis](), placement, f"{segment.name}_{axis}")
            placement = pin.SE3.Identity()
        if segment.axis is not None:
            joint = pin.JointModelRevoluteUnaligned(segment.axis)
        elif segment.axes:
            joint = turning[segment.axes[-1]]()
        else:
            joint = pin.JointModelFreeFlyer() if segment.joint == "free" else pin.JointModelSpherical()
        joint_id = model.addJoint(parent_id, joint, placement, segment.name)
        model.appendBodyToJoint(joint_id, self._inertia(segment), pin.SE3.Identity())
        q, v = slice(first_q, model.nq), slice(first_v, model.nv)
        return SegmentJoint(segment.name, segment.joint, segment.axes, joint_id, q, v)

    def axis_scale(self, segment: Segment) -> Array:
        """(3,) scale factors of a segment's x, y, z axes."""
        return segment.scale_matrix @ self.scale

    def _inertia(self, segment: Segment) -> pin.Inertia:
        """Mass by the mass factor k_m, centre of mass by the axes' factors, inertia by k_m k², k the length factor."""
        k_m = self.mass_kg / self._unit_kg
        k = self.scale[segment.length_index]
        com = self.axis_scale(segment) * segment.com_m
        if segment.name in self.inertia:
            own = self.inertia[segment.name]
            k_m, com = k_m * own.mass_factor, com + own.centre_shift_m
        return pin.Inertia(k_m * segment.mass_kg, com, k_m * k**2 * segment.inertia_matrix_kg_m2)

    def _supports(self) -> BoolArray:
        supports = np.zeros((self.pin_model.njoints, self.nv), dtype=bool)
        for j in range(1, self.pin_model.njoints):
            supports[j] = supports[self.pin_model.parents[j]]
            joint = self.pin_model.joints[j]
            supports[j, joint.idx_v : joint.idx_v + joint.nv] = True
        supports.setflags(write=False)
        return supports

    def joint(self, segment: str) -> SegmentJoint:
        """The joint that carries a segment."""
        if segment not in self.joints:
            raise UnknownName("segment", segment, self.joints)
        return self.joints[segment]

    def neutral(self) -> Array:
        """(nq,) standing posture at the world origin, facing +x."""
        return pin.neutral(self.pin_model)

    def integrate(self, q: Array, dv: Array) -> Array:
        """(nq,) configuration reached from q by the tangent vector dv (nv,)."""
        if (tree := self.tree) is not None:
            return tree.integrate(q, dv)
        return pin.integrate(self.pin_model, q, dv)

    def difference(self, q0: Array, q1: Array) -> Array:
        """(nv,) tangent vector that takes q0 to q1."""
        return pin.difference(self.pin_model, q0, q1)

    def integration_derivatives(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """(nv, nv) derivatives of :meth:`integrate` by q and by dv, block-diagonal over joints."""
        if (tree := self.tree) is not None:
            return tree.integration_derivatives(dv)
        by_q, by_step = pin.dIntegrate(self.pin_model, q, dv)
        # Of the root Pinocchio's own is off by 1e-9 for small turns.
        by_step[:3, 3:6] = travel_by_turn(dv[:3], dv[3:6])
        return by_q, by_step

    def difference_derivative(self, q0: Array, q1: Array) -> Array:
        """(nv, nv) derivative of :meth:`difference` by q1, block-diagonal over joints."""
        return pin.dDifference(self.pin_model, q0, q1, pin.ARG1)

    def placements(self, q: Array) -> tuple[Array, Array]:
        """World rotations (J, 3, 3) and origins (J, 3) of all Pinocchio joints at q (index 0 is the world)."""
        return _rotations_and_origins(self.frames(q))

    def placements_and_jacobian(self, q: Array) -> tuple[Array, Array, Array]:
        """Placements as :meth:`placements`, and J (6, nv): each dof's spatial velocity at the world origin.

        Rows are (linear, angular) in world axes; a column counts for a joint only where ``supports`` says so.
        """
        frames, jacobian = self.frames_and_jacobian(q)
        return (*_rotations_and_origins(frames), jacobian)

    @property
    def tree(self) -> CompiledTree | None:
        """The body's equations in compiled code; None without the compiled kernel."""
        if library() is None:
            return None
        if self._tree is None:
            self._tree = CompiledTree.where_built(self.pin_model)
        return self._tree

    def frames(self, q: Array) -> Array:
        """(4 J, 3): of every Pinocchio joint its world x, y, z axes and its origin, one below the other.

        A point m̄ of joint j lies at [m̄, 1] · (rows 4 j to 4 j + 3).
        """
        if (tree := self.tree) is not None:
            return tree.frames_and_jacobian(q)[0]
        pin.forwardKinematics(self.pin_model, self._data, q)
        return self._frames.copy()

    def frames_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """:meth:`frames` and :meth:`spatial_jacobian` in one pass."""
        if (tree := self.tree) is not None:
            return tree.frames_and_jacobian(q)
        jacobian = pin.computeJointJacobians(self.pin_model, self._data, q)
        return self._frames.copy(), jacobian

    def spatial_jacobian(self, q: Array) -> Array:
        """J (6, nv) of :meth:`placements_and_jacobian` alone."""
        return self.frames_and_jacobian(q)[1]

    def inverse_dynamics(self, q: Array, v: Array, a: Array) -> Array:
        """(nv,) generalised forces M a − Q_g without contact, Q_g from gravity and velocities."""
        return pin.rnea(self.pin_model, self._data, q, v, a)

    def mass_matrix(self, q: Array) -> Array:
        """(nv, nv) symmetric mass matrix."""
        return pin.crba(self.pin_model, self._data, q)

    def gravity_torques(self, q: Array) -> Array:
        """(nv,) generalised forces that hold the body still at q."""
        return pin.computeGeneralizedGravity(self.pin_model, self._data, q).copy()

    def centre_of_mass(self, q: Array) -> Array:
        """(3,) world centre of mass of the whole body, m."""
        return pin.centerOfMass(self.pin_model, self._data, q).copy()

    def segment_jacobian(self, q: Array, segment: str, point_m: Array) -> Array:
        """(6, nv) world Jacobian of a point fixed to a segment."""
        jacobian = pin.computeJointJacobians(self.pin_model, self._data, q)
        jacobian = np.where(self.supports[self.joint(segment).joint_id], jacobian, 0.0)
        jacobian[:3] += np.cross(jacobian[3:].T, point_m).T
        return jacobian


def _depth_first(parents: Sequence[int]) -> bool:
    """True where each joint hangs on the one before it or on an ancestor of that; joint 0 is the world."""
    branch = [0]
    for joint, parent in enumerate(list(parents)[1:], 1):
        if parent not in branch:
            return False
        branch = [*branch[: branch.index(parent) + 1], joint]
    return True


def _own_inertia(
    description: BodyDescription, inertia: Mapping[str, SegmentInertia]
) -> tuple[dict[str, SegmentInertia], float]:
    """The segments that have inertia of their own, and the reference body's mass with their factors, kg."""
    names = [segment.name for segment in description.segments]
    for name in inertia:
        if name not in names:
            raise UnknownName("segment", name, names)
    if not inertia:
        return {}, description.reference_mass_kg
    kept = SegmentInertia()
    whole = sum(inertia.get(s.name, kept).mass_factor * s.mass_kg for s in description.segments)
    return dict(inertia), float(whole)


def reference_body(subject: Subject) -> BodyDescription:
    """The unscaled body a subject was scaled from: the one its file carries, else the one of that name.

    Raises:
        UnknownName: mbkf has no body of that name.
        FileFormatError: The body file that the subject carries is damaged.
    """
    if subject.body_text:
        return parse_body(subject.body_text, f"body '{subject.body}' in the subject")
    return load_body(subject.body)


def scale_of(subject: Subject, body: BodyDescription) -> Array:
    """(K,) scale factors of a subject, in the order of its body; all 1 for a subject that states none.

    Raises:
        UnknownName: The body does not have one of them.
        InvalidInput: One of the body is missing.
    """
    factors = subject.scale_factors
    for name in factors:
        if name not in body.scale_factors:
            raise UnknownName("scale factor", name, body.scale_factors)
    stated = {*factors, *(name for name, origin in body.split_factors.items() if origin in factors)}
    missing = [name for name in body.scale_factors if name not in stated]
    if factors and missing:
        raise InvalidInput(
            f"the subject lacks the scale factor {', '.join(missing)} of the body '{body.name}'; restore its line in "
            "[scale_factors], or scale the person again"
        )
    return body.scale(factors)


def _frames_in(data: pin.Data) -> Array:
    """(4 J, 3) :meth:`HumanModel.frames` as a view of Pinocchio's memory, where placements lie side by side."""
    axes = data.oMi[0].rotation.T
    number, joint = axes.itemsize, 12 * axes.itemsize
    places = [place.rotation.T.ctypes.data for place in data.oMi]
    if places != list(range(places[0], places[0] + len(places) * joint, joint)):
        raise RuntimeError("this version of Pinocchio does not store joint placements side by side")
    return as_strided(axes, (4 * len(places), 3), (3 * number, number))


def _rotations_and_origins(frames: Array) -> tuple[Array, Array]:
    by_joint = frames.reshape(-1, 4, 3)
    return by_joint[:, :3].transpose(0, 2, 1), by_joint[:, 3]


def _per_dof(values: Array, segment: Segment) -> Array:
    dof = JOINT_DOF[segment.joint]
    if values.shape != (dof,):
        raise ShapeError(f"per-dof values of {segment.name}", f"({dof},)", values.shape)
    return values
