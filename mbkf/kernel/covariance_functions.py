"""Functions of the kernel on covariances (``covariance.c``, ``smoothing.c``, ``spread.c``): what they take and give."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array


class CovarianceFunctions(Protocol):
    """Prediction, update, smoothing and variances. Arrays are in C order unless they are symmetric."""

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

    def correction(self, P: Array, vector: Array, rows: Array, values: Array, step: Array, /) -> None:
        """Fills ``step`` (N,): see :func:`mbkf.kernel.covariance.correction`.

        Args:
            P: (N, N) covariance.
            vector: (n,) on the first n components.
            rows: (m, N) whitened.
            values: (m,) their innovations.
            step: (N,) filled.
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

    def choose(self, own: bool, /) -> None:
        """Whether products are made with instructions of the kernel's own, where the processor has them, or by BLAS."""

    def vectors(self) -> int:
        """Bits of the vectors that products are made with; 0 where BLAS makes them."""
