"""Whether the compiled kernel is used: where it was built, unless the variable ``MBKF_KERNEL`` says ``reference``."""

from __future__ import annotations

import importlib
import os
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.kernel.contact_library import ContactLibrary

SWITCH = "MBKF_KERNEL"
"""Environment variable: ``compiled`` asks for the kernel, ``reference`` for numpy and Pinocchio."""

COMPILED, REFERENCE = "compiled", "reference"


class Library(ContactLibrary, Protocol):
    """The functions of ``mbkf/kernel/module.c`` and those of feet. Arrays are in C order unless they are symmetric."""

    def carry(
        self,
        P: Array,
        A: Array,
        B: Array,
        joints: NDArray[np.int32],
        singer: Array,
        noise: Array,
        sd: Array,
        carried: Array,
        /,
    ) -> None:
        """Fills ``carried`` (N, N): see :class:`mbkf.kernel.covariance.CompiledPrediction`.

        Args:
            P: (N, N) covariance.
            A: (nv, nv) derivative of the next configuration by this one.
            B: (nv, nv) by the step.
            joints: (J, 2) first dof and number of dofs of each joint, 32-bit integers.
            singer: (4,) Δt, c₁, c₂, ρ.
            noise: (3, 3) covariance of (q, v, a) for σ_a = 1.
            sd: (nv,) σ_a.
            carried: (N, N) filled.
        """

    def carry_velocities(
        self,
        P: Array,
        A: Array,
        B: Array,
        joints: NDArray[np.int32],
        dt: float,
        noise: Array,
        carried: Array,
        /,
    ) -> None:
        """Fills ``carried`` (2 nv, 2 nv): see :class:`mbkf.kernel.covariance.CompiledVelocityPrediction`.

        Args:
            P: (2 nv, 2 nv) covariance of positions and velocities.
            A: (nv, nv) derivative of the next configuration by this one.
            B: (nv, nv) by the step.
            joints: (J, 2) first dof and number of dofs of each joint, 32-bit integers.
            dt: Δt.
            noise: (2, 2, nv) diagonals of the blocks of Q.
            carried: (2 nv, 2 nv) filled.
        """

    def inform(self, P: Array, information: Array, rows: Array, informed: Array, /) -> int:
        """Fills ``informed`` (N, N): see :func:`mbkf.kernel.covariance.informed_with_rows`.

        Args:
            P: (N, N) covariance.
            information: (n, n) on the first n components.
            rows: (m, N) whitened.
            informed: (N, N) filled.

        Returns:
            0, or which factorisation failed.
        """

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

    def deviation(self, tree: object, q: Array, deviation: Array, jacobian: Array, /) -> None:
        """Fills rotations from neutral.

        Args:
            tree: The handle.
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

    def errors(
        self,
        P: Array,
        information: Array,
        seen: NDArray[np.int32],
        size: Array,
        constants: Array,
        rows: Array,
        T: Array,
        U: Array,
        first: NDArray[np.int32],
        found: Array,
        /,
    ) -> int:
        """Fills ``found`` with diagonals of an error covariance Σ: see :mod:`mbkf.filters.state_variances`.

        Args:
            P: (N, N) covariance.
            information: (nv, nv) of one frame.
            seen: (n,) dofs that markers observe, ascending, 32-bit integers.
            size: (N,) factor on errors of P's kind.
            constants: (2,) variance of skin and its rate.
            rows: (k, N) roots of what is added.
            T: (m, n) quantities of the first n ≥ nv components, in Fortran order.
            U: (l, n) further ones, in Fortran order.
            first: (b,) first of three components of the configuration, 32-bit integers.
            found: (N + m + l + 9 b,) filled: diagonals of Σ, T Σ Tᵀ and U Σ Uᵀ, and blocks (3, 3) of Σ.

        Returns:
            0, or 1 where the information cannot be factorised.
        """

    def joint_variances(
        self,
        q: Array,
        places: NDArray[np.int32],
        signs: Array,
        root: int,
        axes: Array,
        covariance: Array,
        variance: Array,
        /,
    ) -> None:
        """Fills ``variance`` (k, n + 1, 3): see :class:`mbkf.filters.coordinate_variances.CoordinateVariances`.

        Args:
            q: (nq,) configuration.
            places: (n, 4) first number of a joint's quaternion in q, and its axes, 32-bit integers.
            signs: (n, 4) parity of the axes, and the angles' signs.
            root: First number of the root's quaternion in q.
            axes: (3, 3) what takes the root's position to the axes it is told in.
            covariance: (k, n + 1, 3, 3) of the joints' dofs and the root's position.
            variance: (k, n + 1, 3) filled.
        """

    def torques(
        self,
        free: Array,
        by_q: Array,
        by_v: Array,
        by_a: Array,
        J: Array,
        moves: NDArray[np.int32],
        joint_of: NDArray[np.int32],
        wrenches: Array,
        tau: Array,
        by_state: Array,
        /,
    ) -> None:
        """Fills ``tau`` (nv,) and ``by_state`` (nv, 3 nv + 12) as :mod:`mbkf.model.newton_euler` states them.

        Args:
            free: (nv,) forces without the feet's wrenches.
            by_q: (nv, nv) their derivative by q.
            by_v: (nv, nv) by v.
            by_a: (nv, nv) by a, symmetric.
            J: (6, nv) velocities at the world's origin, in Fortran order.
            moves: (2, nv) whether a dof moves a foot, 32-bit integers.
            joint_of: (nv,) joint of a dof, 32-bit integers.
            wrenches: (12,) of the feet.
            tau: (nv,) filled.
            by_state: (nv, 3 nv + 12) filled, in Fortran order.
        """

    def choose(self, own: bool, /) -> None:
        """Whether products are made with instructions of the kernel's own, where the processor has them, or by BLAS."""

    def vectors(self) -> int:
        """Bits of the vectors that products are made with; 0 where BLAS makes them."""


@cache
def library() -> Library | None:
    """The compiled kernel; None where it was not built, or is not wanted.

    Raises:
        InvalidInput: ``MBKF_KERNEL`` is neither, or asks for a kernel that is not there.
    """
    wanted = os.environ.get(SWITCH, "")
    if wanted not in {"", COMPILED, REFERENCE}:
        raise InvalidInput(f"{SWITCH}={wanted} is not known; it is {COMPILED}, {REFERENCE} or not set")
    if wanted == REFERENCE:
        return None
    try:
        return _connected()
    except ImportError as error:
        if wanted == COMPILED:
            raise InvalidInput(
                f"there is no compiled kernel ({error}); install mbkf where a C compiler is, or unset {SWITCH}"
            ) from error
        return None


def told() -> str:
    """Which arithmetic is used, for people: ``compiled kernel (512-bit vectors)``, ``reference kernel (numpy)``."""
    found = library()
    if found is None:
        return f"{REFERENCE} kernel (numpy)"
    bits = found.vectors()
    return f"{COMPILED} kernel ({f'{bits}-bit vectors' if bits else 'BLAS'})"


def _connected() -> Library:
    """The kernel with SciPy's BLAS and LAPACK.

    Raises:
        ImportError: It was not built, or SciPy offers other routines.
    """
    from scipy.linalg import cython_blas, cython_lapack

    module = importlib.import_module("mbkf.kernel._kernel")
    module.connect({**cython_blas.__pyx_capi__, **cython_lapack.__pyx_capi__})
    return module
