"""Functions of the kernel on a body (``tree.c`` and what builds on it): what they take and give."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array


class TreeFunctions(Protocol):
    """Kinematics and dynamics of a tree of joints. Arrays are in C order."""

    def tree(
        self, whole: NDArray[np.int32], numbers: Array, gravity: Array, sizes: NDArray[np.int32], /
    ) -> object:
        """A handle of a tree of joints: see :class:`mbkf.kernel.tree.CompiledTree`.

        Args:
            whole: (J, 4) parent, kind, first of q and first of v of each joint, the world's first.
            numbers: (J, 28) axis (3), rotation by columns (9), origin (3), mass (1), centre of mass (3), inertia about
                it (9).
            gravity: (6,) its acceleration, linear and angular.
            sizes: (2,) nq and nv.

        Raises:
            ValueError: The joints do not make a tree.
        """

    def place(self, tree: object, q: Array, frames: Array, jacobian: Array, /) -> None:
        """Fills frames and Jacobian.

        Args:
            tree: The handle.
            q: (nq,) configuration.
            frames: (4 J, 3) filled.
            jacobian: (6, nv) filled, in Fortran order.
        """

    def root(
        self,
        tree: object,
        q: Array,
        v: Array,
        a: Array,
        wrench: Array,
        residual: Array,
        by_state: Array,
        /,
    ) -> None:
        """Fills the root's equations.

        Args:
            tree: The handle.
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            wrench: (6,) about the world's origin.
            residual: (6,) filled.
            by_state: (6, 3 nv + 12) filled.
        """

    def step(self, tree: object, q: Array, step: Array, stepped: Array, /) -> None:
        """Fills a configuration one step further.

        Args:
            tree: The handle.
            q: (nq,) configuration.
            step: (nv,) tangent vector.
            stepped: (nq,) filled.
        """

    def step_derivatives(self, tree: object, step: Array, by_q: Array, by_step: Array, /) -> None:
        """Fills the derivatives of a step.

        Args:
            tree: The handle.
            step: (nv,) tangent vector.
            by_q: (nv, nv) filled.
            by_step: (nv, nv) filled.
        """

    def deviation(self, tree: object, start: Array, q: Array, deviation: Array, jacobian: Array, /) -> None:
        """Fills rotations from another configuration.

        Args:
            tree: The handle.
            start: (nq,) that configuration.
            q: (nq,) configuration.
            deviation: (nv,) filled.
            jacobian: (nv, nv) filled.
        """

    def posture(
        self, tree: object, residual: Array, jacobian: Array, weights: Array, matrix: Array, vector: Array, /
    ) -> None:
        """Fills the information of readings of rotations.

        Args:
            tree: The handle.
            residual: (nv,) rotation less what is read.
            jacobian: (nv, nv) of the rotations.
            weights: (nv,) 1/sd.
            matrix: (nv, nv) filled.
            vector: (nv,) filled.
        """

    def beyond(self, tree: object, deviation: Array, lower: Array, upper: Array, beyond: Array, /) -> int:
        """Fills how far rotations lie beyond limits; how many do.

        Args:
            tree: The handle.
            deviation: (nv,) rotations.
            lower: (nv,) least.
            upper: (nv,) greatest.
            beyond: (nv,) filled.
        """

    def tau(
        self,
        tree: object,
        q: Array,
        v: Array,
        a: Array,
        moves: NDArray[np.int32],
        wrenches: Array,
        tau: Array,
        /,
    ) -> None:
        """Fills ``tau`` (nv,) as :mod:`mbkf.model.newton_euler` states it.

        Args:
            tree: The handle.
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            moves: (2, nv) whether a dof moves a foot, 32-bit integers.
            wrenches: (12,) of the feet.
            tau: (nv,) filled.
        """

    def torques(
        self,
        tree: object,
        q: Array,
        v: Array,
        a: Array,
        moves: NDArray[np.int32],
        wrenches: Array,
        tau: Array,
        by_state: Array,
        jacobian: Array,
        /,
    ) -> None:
        """Fills ``tau``, its derivatives and the Jacobian.

        Args:
            tree: The handle.
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            moves: (2, nv) whether a dof moves a foot, 32-bit integers.
            wrenches: (12,) of the feet.
            tau: (nv,) filled.
            by_state: (nv, 3 nv + 12) filled, in Fortran order.
            jacobian: (6, nv) filled, in Fortran order.
        """

    def rise(self, tree: object, q: Array, joints: NDArray[np.int32], rise: Array, /) -> None:
        """Fills derivatives of the heights of joints.

        Args:
            tree: The handle.
            q: (nq,) configuration.
            joints: (n,) indices, 32-bit integers.
            rise: (n, nv) filled.

        Raises:
            ValueError: The tree has no such joint.
        """
