"""Whether the compiled kernel is used: where it was built, unless the variable ``MBKF_KERNEL`` says ``reference``."""

from __future__ import annotations

import importlib
import os
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput

SWITCH = "MBKF_KERNEL"
"""Environment variable: ``compiled`` asks for the kernel, ``reference`` for numpy and Pinocchio."""

COMPILED, REFERENCE = "compiled", "reference"


Point = tuple[float, float, float]
Points = tuple[Point, Point, Point]
"""Of heel, ball and toe end."""


class Library(Protocol):
    """The functions of ``mbkf/kernel/module.c``. Arrays are in C order unless they are symmetric."""

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

    def predict(
        self,
        tree: object,
        P: Array,
        q: Array,
        v: Array,
        a: Array,
        joints: NDArray[np.int32],
        singer: Array,
        noise: Array,
        sd: Array,
        carried: Array,
        q_after: Array,
        v_after: Array,
        a_after: Array,
        /,
    ) -> None:
        """Fills a state one step later: see :meth:`mbkf.kernel.covariance.CompiledPrediction.predicted`.

        Args:
            tree: The handle.
            P: (N, N) covariance.
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            joints: (J, 2) first dof and number of dofs of each joint, 32-bit integers.
            singer: (4,) Δt, c₁, c₂, ρ.
            noise: (3, 3) covariance of (q, v, a) for σ_a = 1.
            sd: (nv,) σ_a.
            carried: (N, N) filled.
            q_after: (nq,) filled.
            v_after: (nv,) filled.
            a_after: (nv,) filled.
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

    def before_motion(
        self,
        L: Array,
        A: Array,
        B: Array,
        joints: NDArray[np.int32],
        push: Array,
        rates: Array,
        before: Array,
        /,
    ) -> None:
        """Fills ``before`` (N, N): see :meth:`mbkf.kernel.smoothing.SparseBackwardPass.through_motion`.

        Args:
            L: (N, N) curvature.
            A: (nv, nv) derivative of the next configuration by this one.
            B: (nv, nv) by the step.
            joints: (J, 2) first dof and number of dofs of each joint, 32-bit integers.
            push: (k,) what each order of rates adds to the step.
            rates: (k, k) how rates carry one another.
            before: (N, N) filled.
        """

    def smoothed(self, P: Array, L: Array, smoothed: Array, LP: Array, /) -> None:
        """Fills a smoothed covariance and a product that readings need, too.

        Args:
            P: (N, N) posterior covariance.
            L: (N, N) curvature.
            smoothed: (N, N) filled with P − P L P.
            LP: (N, N) filled, column by column.
        """

    def before_readings(
        self, L: Array, smoothed: Array, LP: Array, information: Array, rows: Array, before: Array, /
    ) -> None:
        """Fills ``before`` (N, N): see :meth:`mbkf.kernel.smoothing.SparseBackwardPass.through_parts`.

        Args:
            L: (N, N) curvature.
            smoothed: (N, N) of :meth:`smoothed`.
            LP: (N, N) of :meth:`smoothed`.
            information: (n, n) on the first n components.
            rows: (m, N) whitened.
            before: (N, N) filled.
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

    def marker_places(
        self,
        tree: object,
        joints: NDArray[np.int32],
        local: Array,
        q: Array,
        places: Array,
        jacobian: Array,
        /,
    ) -> None:
        """Fills places of markers and the Jacobian.

        Args:
            tree: The handle.
            joints: (M,) joints that carry the markers, 32-bit integers.
            local: (M, 3) places in their frames.
            q: (nq,) configuration.
            places: (M, 3) filled.
            jacobian: (6, nv) filled, in Fortran order.
        """

    def markers_apart(
        self,
        measured: Array,
        places: Array,
        radius: float,
        innovation: Array,
        squared: Array,
        seen: BoolArray,
        /,
    ) -> int:
        """Fills innovations: see :class:`mbkf.kernel.markers.Apart`.

        Args:
            measured: (M, 3) measured places.
            places: (M, 3) predicted ones.
            radius: How far a near marker lies off at most.
            innovation: (M, 3) filled.
            squared: (M,) filled.
            seen: (M,) filled.

        Returns:
            How many are seen; −1 where one of them is not near.
        """

    def marker_information(
        self,
        tree: object,
        joints: NDArray[np.int32],
        weights: Array,
        trusted: BoolArray,
        jacobian: Array,
        places: Array,
        innovation: Array,
        matrix: Array,
        vector: Array,
        /,
    ) -> float:
        """Fills the information of markers and returns yᵀR⁻¹y.

        Args:
            tree: The handle.
            joints: (M,) joints that carry the markers, 32-bit integers.
            weights: (M,) 1/sd².
            trusted: (M,) markers that count.
            jacobian: (6, nv) velocities at the world's origin, in Fortran order.
            places: (M, 3) of the markers.
            innovation: (M, 3) y.
            matrix: (nv, nv) filled.
            vector: (nv,) filled.
        """

    def feet(
        self, tree: object, joints: NDArray[np.int32], local: Array, q: Array, v: Array, middles: Array, /
    ) -> tuple[tuple[Points, Points], tuple[Points, Points], tuple[float, float], Point]:
        """Points and velocities of both soles, the feet's upward axes and the root.

        Args:
            tree: The handle.
            joints: (3,) right foot, left foot and root, 32-bit integers.
            local: (6, 3) heel, ball and toe end of right and left sole.
            q: (nq,) configuration.
            v: (nv,) velocity.
            middles: (2, 3) filled with the middles of heels and toe ends.
        """

    def foot_rows(
        self,
        centres: Array,
        weights: Array,
        expected: Array,
        wrench: Array,
        first: int,
        rows: Array,
        values: Array,
        /,
    ) -> None:
        """Fills rows on both feet's wrenches: see :func:`mbkf.kernel.feet.foot_rows`.

        Args:
            centres: (2, 3) points about which they are read.
            weights: (2, 6) 1/sd.
            expected: (2, 6) what is read.
            wrench: (12,) those of the state.
            first: Foot whose rows come first.
            rows: (12, 12) filled.
            values: (12,) filled.
        """

    def foot_walks(self, centres: Array, sd: Array, first: int, P: Array, /) -> None:
        """Adds the wrenches' random walk to a covariance.

        Args:
            centres: (2, 3) points about which they wander.
            sd: (6,) of force and moment.
            first: Component at which the wrenches begin.
            P: (N, N) added to.
        """

    def third_differences(
        self, first: Array, second: Array, third: Array, latest: Array, level: float, /
    ) -> tuple[int, int]:
        """Counts third differences: see :func:`mbkf.kernel.differences.third_differences`.

        Args:
            first: A sample.
            second: The next one, of as many numbers.
            third: The next.
            latest: The latest.
            level: The level.

        Returns:
            How many are numbers, and how many of these lie below the level.
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
