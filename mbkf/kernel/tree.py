"""A body's kinematics and dynamics by the compiled kernel (``tree.c``), where it was built and knows the joints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array, BoolArray, Int32Array
from mbkf.kernel.loading import Library, library

FREE, SPHERICAL, HINGE = range(3)
KINDS = {
    "JointModelFreeFlyer": FREE,
    "JointModelSpherical": SPHERICAL,
    "JointModelRX": HINGE,
    "JointModelRY": HINGE,
    "JointModelRZ": HINGE,
    "JointModelRevoluteUnaligned": HINGE,
}
"""Kinds of joints of ``tree.h`` by Pinocchio's names."""


Loads = tuple[Array, Array]
"""(6,) residual at the root, and its derivatives (6, N)."""


class SectionTable(NamedTuple):
    """Sections of the trunk. Fields: as arguments of :meth:`BodyFunctions.load_derivatives`."""

    above: Int32Array
    transports: Array
    parts: Array


class WornTable(NamedTuple):
    """Sensors worn on a body. Fields: as arguments of :meth:`InertialFunctions.worn_readings`."""

    joint_ids: Int32Array
    places: Array
    mounted: Array
    weights: Array


class CompiledTree:
    """A Pinocchio model's equations in compiled code (:class:`mbkf.kernel.body_functions.BodyFunctions`).

    The model's numbers are read once: later changes of it do not count. Motions may be rows or columns of tables.

    Attributes:
        kernel: The compiled kernel.
        handle: Its tree.
        nv: Degrees of freedom.
    """

    def __init__(self, kernel: Library, model: pin.Model) -> None:
        """Reads a model.

        Args:
            kernel: The compiled kernel.
            model: One whose joints :data:`KINDS` has.
        """
        self.kernel, self.nv, self._neutral = kernel, model.nv, _read(pin.neutral(model))
        joints, places, inertias = model.joints[1:], model.jointPlacements, model.inertias
        kinds = [KINDS[joint.shortname()] for joint in joints]
        axes = [
            hinge_axis(joint) if kind == HINGE else np.zeros(3)
            for joint, kind in zip(joints, kinds, strict=True)
        ]
        self.handle = kernel.make_tree(
            model.nq,
            model.nv,
            np.array(model.parents, dtype=np.int32),
            # Of the world, joint 0, nothing is read.
            np.array([0, *kinds], dtype=np.int32),
            np.array([0, *(joint.idx_q for joint in joints)], dtype=np.int32),
            np.array([0, *(joint.idx_v for joint in joints)], dtype=np.int32),
            np.array([np.zeros(3), *axes]),
            np.array([place.rotation for place in places]),
            np.array([place.translation for place in places]),
            np.array([inertia.mass for inertia in inertias]),
            np.array([inertia.lever for inertia in inertias]),
            np.array([inertia.inertia for inertia in inertias]),
            np.array(model.gravity.vector),
        )

    @classmethod
    def where_built(cls, model: pin.Model) -> CompiledTree | None:
        """A tree; None without a compiled kernel, with joints of other kinds, or with a root that is not free."""
        kernel = library()
        names = [joint.shortname() for joint in model.joints][1:]
        known = names and KINDS.get(names[0]) == FREE and all(name in KINDS for name in names)
        return cls(kernel, model) if kernel is not None and known else None

    def frames_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """(4 J, 3) frames and (6, nv) Jacobian as :meth:`mbkf.model.body.Body.frames_and_jacobian`."""
        return self.kernel.frames_and_jacobian(self.handle, _read(q))

    def frames_and_jacobians(self, q: Array) -> tuple[Array, Array]:
        """(T, 4 J, 3) and (T, 6, nv): :meth:`frames_and_jacobian` of configurations (T, nq)."""
        frames, columns = self.kernel.frames_and_jacobians(self.handle, _read(q))
        return frames, columns.swapaxes(1, 2)

    def root(self, q: Array, v: Array, a: Array, wrench: Array) -> tuple[Array, Array]:
        """(6,) residual and (6, 3 nv + 12) derivatives. Args: as :meth:`BodyFunctions.root_dynamics`."""
        return self.kernel.root_dynamics(self.handle, _read(q), _read(v), _read(a), _read(wrench))

    def law(
        self, q: Array, v: Array, a: Array, wrenches: Array, extra: Array, by_extra: Array, sharp: Array
    ) -> tuple[Array, Array]:
        """(6, 3 nv + 12 + m) rows and (6,) innovations. Args: as :meth:`BodyFunctions.law_rows`."""
        state = _read(q), _read(v), _read(a), _read(wrenches), _read(extra)
        return self.kernel.law_rows(self.handle, *state, by_extra, sharp)

    def centre_of_mass(self, q: Array) -> Array:
        """(3,) centre of mass at q (nq,), m."""
        return self.kernel.centre_of_mass(self.handle, _read(q))

    def tau(self, q: Array, v: Array, a: Array, moves: BoolArray, wrenches: Array) -> Array:
        """(nv,) generalised forces. Args: as :meth:`BodyFunctions.generalised_forces`."""
        motion = _read(q), _read(v), _read(a)
        return self.kernel.generalised_forces(self.handle, *motion, moves, _read(wrenches))

    def motion_tau(self, q: Array, v: Array, a: Array, moves: BoolArray, wrenches: Array) -> Array:
        """(T, nv) generalised forces of T frames. Args: as :meth:`BodyFunctions.motion_forces`."""
        motion = _read(q), _read(v), _read(a)
        return self.kernel.motion_forces(self.handle, *motion, moves, _read(wrenches))

    def torques(
        self, q: Array, v: Array, a: Array, moves: BoolArray, wrenches: Array
    ) -> tuple[Array, Array, Array]:
        """:meth:`tau`, its derivatives, Jacobian (6, nv). Args: as :meth:`BodyFunctions.torque_derivatives`."""
        motion = _read(q), _read(v), _read(a)
        return self.kernel.torque_derivatives(self.handle, *motion, moves, _read(wrenches))

    def loads(
        self, q: Array, v: Array, a: Array, moves: BoolArray, wrenches: Array, sections: SectionTable
    ) -> tuple[Array, Array]:
        """(nv,) generalised forces, (6 L + nv, N) derivatives. Args: as :meth:`BodyFunctions.load_derivatives`."""
        motion = _read(q), _read(v), _read(a)
        return self.kernel.load_derivatives(self.handle, *motion, moves, _read(wrenches), *sections)

    def upper_forces(self, q: Array, v: Array, a: Array, sections: SectionTable) -> Array:
        """(T, L, 6) wrenches on the parts above sections. Args: as :meth:`BodyFunctions.upper_forces`."""
        motion = _read(q), _read(v), _read(a)
        return self.kernel.upper_forces(self.handle, *motion, sections.above, sections.parts)

    def section(
        self, motion: tuple[Array, Array, Array], carried: Array, transport: Array, above: int, whole: Loads
    ) -> tuple[Array, Array, Array, Array]:
        """(2, 6) wrenches, (2, 3) moments, (2, 3, N) rows, (3, 6). Args: as :meth:`BodyFunctions.section_state`."""
        q, v, a = motion
        residual, by_state = whole
        return self.kernel.section_state(
            self.handle,
            _read(q),
            _read(v),
            _read(a),
            carried,
            transport,
            above,
            _read(residual),
            _read(by_state),
        )

    def worn(
        self,
        motion: tuple[Array, Array, Array],
        table: WornTable,
        known: tuple[Array, Array, Array],
        places: tuple[int, int, int],
    ) -> tuple[Array, Array]:
        """(6 S, N) rows and (6 S,) innovations. Args: as :meth:`InertialFunctions.worn_readings`."""
        q, v, a = motion
        biases, turns, measured = known
        return self.kernel.worn_readings(
            self.handle,
            _read(q),
            _read(v),
            _read(a),
            *table,
            _read(biases),
            _read(turns),
            _read(measured),
            *places,
        )

    def carried_points(
        self, q: Array, v: Array, joint_ids: Int32Array, points_m: Array
    ) -> tuple[Array, Array, Array]:
        """(n, 6), (n, 6, 2 nv) and (n, 3, nv). Args: as :meth:`InertialFunctions.carried_points`."""
        return self.kernel.carried_points(self.handle, _read(q), _read(v), joint_ids, _read(points_m))

    def mass_inverse(self, q: Array, moving: BoolArray) -> tuple[Array, Array]:
        """(nv, nv) mass matrix, and the inverse of its part of the moving dofs; the rest of that is 0.

        Args:
            q: (nq,) configuration.
            moving: (nv,) dofs that forces move.

        Raises:
            numpy.linalg.LinAlgError: The mass matrix is not positive.
        """
        failed, mass, inverse = self.kernel.mass_inverse(self.handle, _read(q), moving)
        if failed:
            raise np.linalg.LinAlgError("the mass matrix is not positive")
        return mass, inverse

    def foot_wrenches(
        self, q: Array, joint_ids: Int32Array, levers: Array, own_axes: bool, state: Array, points: Array
    ) -> tuple[Array, Array, Array]:
        """(12,) wrenches and derivatives (12, 12), (12, nv). Args: as :meth:`ForceFunctions.foot_wrenches`."""
        return self.kernel.foot_wrenches(
            self.handle, _read(q), joint_ids, levers, own_axes, _read(state), _read(points)
        )

    def height_jacobian(self, q: Array, joint_ids: Int32Array) -> Array:
        """(n, nv) derivative of the heights of the origins of n joints by the configuration q (nq,)."""
        return self.kernel.height_jacobian(self.handle, _read(q), joint_ids)

    def integrate(self, q: Array, dv: Array) -> Array:
        """(nq,) configuration reached from q by the tangent vector dv (nv,)."""
        return self.kernel.integrate(self.handle, _read(q), _read(dv))

    def moved(
        self, q: Array, v: Array, a: Array, w: Array, extra: Array, step: Array
    ) -> tuple[Array, Array, Array, Array, Array]:
        """A state moved along its tangent space. Args: as :meth:`TrackingFunctions.move_state`."""
        state = _read(q), _read(v), _read(a), _read(w), _read(extra)
        return self.kernel.move_state(self.handle, *state, _read(step))

    def integration_derivatives(self, dv: Array) -> tuple[Array, Array]:
        """(nv, nv) derivatives of :meth:`integrate` by q and by dv; the configuration does not matter."""
        return self.kernel.integration_derivatives(self.handle, _read(dv))

    def deviation(self, q: Array, start: Array | None = None) -> tuple[Array, Array]:
        """(nv,) rotation of every joint, rad, and its Jacobian (nv, nv) by q; both are zero for free joints.

        Args:
            q: (nq,) configuration.
            start: (nq,) configuration from which joints rotate; None for Pinocchio's neutral one.
        """
        return self.kernel.deviation(self.handle, self._neutral if start is None else _read(start), _read(q))

    def posture_information(self, residual: Array, jacobian: Array, weights: Array) -> tuple[Array, Array]:
        """Information (nv, nv) and (nv,) of rotations. Args: as :meth:`BodyFunctions.posture_information`."""
        return self.kernel.posture_information(self.handle, residual, _read(jacobian), _read(weights))

    def limit_excess(self, deviation: Array, lower: Array, upper: Array) -> Array | None:
        """(nv,) distance of each rotation from the range of its limits, rad; None where all lie within.

        A spherical joint that is within them the other way round, beyond half a turn, is within them.

        Args: as :meth:`BodyFunctions.limit_excess`.
        """
        count, excess = self.kernel.limit_excess(self.handle, _read(deviation), lower, upper)
        return excess if count else None


def _read(values: Array) -> Array:
    """An array as the kernel takes it: columns of tables and integers are copied."""
    return np.ascontiguousarray(values, dtype=float)


def hinge_axis(joint: pin.JointModel) -> Array:
    """(3,) unit axis of a hinge, in its own frame."""
    data = joint.createData()
    joint.calc(data, np.zeros(joint.idx_q + joint.nq))
    return np.asarray(data.S).ravel()[3:]
