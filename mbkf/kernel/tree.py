"""A body's kinematics and dynamics by the compiled kernel (``tree.c``), where it was built and knows the joints."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from mbkf.conventions import Array
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


class CompiledTree:
    """A Pinocchio model's equations in compiled code; arrays that it returns are new ones.

    The model's numbers are read once: later changes of it do not count.

    Attributes:
        handle: The kernel's tree.
        nv: Degrees of freedom.
    """

    def __init__(self, kernel: Library, model: pin.Model) -> None:
        """Reads a model.

        Args:
            kernel: The compiled kernel.
            model: One whose joints :data:`KINDS` has.
        """
        self._kernel, self._nq, self.nv = kernel, model.nq, model.nv
        self._frames, self._neutral = (4 * model.njoints, 3), _read(pin.neutral(model))
        whole, numbers = np.zeros((model.njoints, 4), dtype=np.int32), np.zeros((model.njoints, 28))
        for i in range(1, model.njoints):
            joint = model.joints[i]
            kind = KINDS[joint.shortname()]
            whole[i] = model.parents[i], kind, joint.idx_q, joint.idx_v
            place, inertia = model.jointPlacements[i], model.inertias[i]
            numbers[i, :3] = _axis(joint) if kind == HINGE else 0.0
            numbers[i, 3:12], numbers[i, 12:15] = place.rotation.T.ravel(), place.translation
            numbers[i, 15], numbers[i, 16:19] = inertia.mass, inertia.lever
            numbers[i, 19:28] = inertia.inertia.ravel()
        sizes = np.array([model.nq, model.nv], dtype=np.int32)
        self.handle = kernel.tree(whole, numbers, np.array(model.gravity.vector), sizes)

    @classmethod
    def where_built(cls, model: pin.Model) -> CompiledTree | None:
        """One, or None where there is no compiled kernel, or the model's joints are others or its root not free."""
        kernel = library()
        names = [joint.shortname() for joint in model.joints][1:]
        known = names and KINDS.get(names[0]) == FREE and all(name in KINDS for name in names)
        return cls(kernel, model) if kernel is not None and known else None

    def frames_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """(4 J, 3) frames and (6, nv) Jacobian as :meth:`mbkf.model.body.Body.frames_and_jacobian`."""
        frames, jacobian = np.empty(self._frames), np.empty((6, self.nv), order="F")
        self._kernel.place(self.handle, _read(q), frames, jacobian)
        return frames, jacobian

    def root(self, q: Array, v: Array, a: Array, wrench: Array) -> tuple[Array, Array]:
        """The root's six equations ID(q, v, a) − Jᵀ w, in its own axes; force N, moment N m.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            wrench: (6,) of all contacts: force N and moment N m about the world's origin.

        Returns:
            (6,) residual, and (6, 3 nv + 12) its derivatives by q (in the tangent space), v, a and either of two
            wrenches whose sum is w.
        """
        residual, by_state = np.empty(6), np.empty((6, 3 * self.nv + 12))
        self._kernel.root(self.handle, _read(q), _read(v), _read(a), _read(wrench), residual, by_state)
        return residual, by_state

    def tau(self, q: Array, v: Array, a: Array, moves: NDArray[np.int32], wrenches: Array) -> Array:
        """(nv,) generalised forces ID(q, v, a) − Σ J_fᵀ w_f.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            moves: (2, nv) whether a dof moves a foot.
            wrenches: (12,) of the feet: force N and moment N m about the world's origin.
        """
        tau = np.empty(self.nv)
        self._kernel.tau(self.handle, _read(q), _read(v), _read(a), moves, _read(wrenches), tau)
        return tau

    def torques(
        self, q: Array, v: Array, a: Array, moves: NDArray[np.int32], wrenches: Array
    ) -> tuple[Array, Array, Array]:
        """:meth:`tau`, its derivatives (nv, 3 nv + 12) by q, v, a and the wrenches, and the Jacobian (6, nv).

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity in the tangent space.
            a: (nv,) acceleration.
            moves: (2, nv) whether a dof moves a foot.
            wrenches: (12,) of the feet: force N and moment N m about the world's origin.
        """
        nv = self.nv
        tau, by_state, jacobian = (
            np.empty(nv),
            np.empty((nv, 3 * nv + 12), order="F"),
            np.empty((6, nv), order="F"),
        )
        given = _read(q), _read(v), _read(a), moves, _read(wrenches)
        self._kernel.torques(self.handle, *given, tau, by_state, jacobian)
        return tau, by_state, jacobian

    def rise_jacobian(self, q: Array, joints: NDArray[np.int32]) -> Array:
        """(n, nv) derivative of the heights of the origins of n joints by the configuration q (nq,)."""
        rise = np.empty((len(joints), self.nv))
        self._kernel.rise(self.handle, _read(q), joints, rise)
        return rise

    def integrate(self, q: Array, dv: Array) -> Array:
        """(nq,) configuration reached from q by the tangent vector dv (nv,)."""
        stepped = np.empty(self._nq)
        self._kernel.step(self.handle, _read(q), _read(dv), stepped)
        return stepped

    def integration_derivatives(self, dv: Array) -> tuple[Array, Array]:
        """(nv, nv) derivatives of :meth:`integrate` by q and by dv; the configuration does not matter."""
        by_q, by_step = np.empty((self.nv, self.nv)), np.empty((self.nv, self.nv))
        self._kernel.step_derivatives(self.handle, _read(dv), by_q, by_step)
        return by_q, by_step

    def deviation(self, q: Array, start: Array | None = None) -> tuple[Array, Array]:
        """(nv,) rotation of every joint from another configuration, rad, and its Jacobian (nv, nv) by q.

        Both are zero for free joints.

        Args:
            q: (nq,) configuration.
            start: (nq,) the other; None for Pinocchio's neutral one.
        """
        deviation, jacobian = np.empty(self.nv), np.empty((self.nv, self.nv))
        other = self._neutral if start is None else _read(start)
        self._kernel.deviation(self.handle, other, _read(q), deviation, jacobian)
        return deviation, jacobian

    def posture_information(self, residual: Array, jacobian: Array, weights: Array) -> tuple[Array, Array]:
        """Information matrix JᵀW²J (nv, nv) and vector −JᵀW²r (nv,) of readings of the joints' rotations.

        Args:
            residual: (nv,) r, rotation less what is read, rad.
            jacobian: (nv, nv) J, that of :meth:`deviation`: entries between joints are not read.
            weights: (nv,) W's diagonal, 1/sd of each reading, 1/rad.
        """
        matrix, vector = np.empty((self.nv, self.nv)), np.empty(self.nv)
        self._kernel.posture(self.handle, residual, _read(jacobian), _read(weights), matrix, vector)
        return matrix, vector

    def beyond(self, deviation: Array, lower: Array, upper: Array) -> Array | None:
        """(nv,) how far each rotation lies beyond its limits, rad; None where none does.

        A spherical joint that is within them the other way round, beyond half a turn, is within them.

        Args:
            deviation: (nv,) rotations, rad.
            lower: (nv,) least, rad.
            upper: (nv,) greatest, rad.
        """
        beyond = np.empty(self.nv)
        return beyond if self._kernel.beyond(self.handle, _read(deviation), lower, upper, beyond) else None


def _read(values: Array) -> Array:
    """An array as the kernel reads it: columns of tables and whole numbers are copied."""
    return np.ascontiguousarray(values, dtype=float)


def _axis(joint: pin.JointModel) -> Array:
    """(3,) unit axis of a hinge, in its own frame."""
    data = joint.createData()
    joint.calc(data, np.zeros(joint.idx_q + joint.nq))
    return np.asarray(data.S).ravel()[3:]
