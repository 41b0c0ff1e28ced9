"""Backward pass of a smoother by the compiled kernel (``smoothing.c``), which leaves out what is zero in Φ and Λ."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.numerics.rate_transition import RateTransition
from mbkf.numerics.smoothing import BackwardPass


class SparseBackwardPass(BackwardPass):
    """A :class:`mbkf.numerics.smoothing.BackwardPass` that is told readings and transitions by their parts.

    Where there is no kernel, the parts are put together.
    """

    def __init__(self, size: int, covariances: bool = True) -> None:
        super().__init__(size, covariances)
        self._kernel = library()
        self._found: tuple[Array, Array, Array] | None = None

    def covariance(self, P: Array) -> Array:
        """(N, N) smoothed covariance of a frame with posterior covariance P; not to be changed.

        Raises:
            ValueError: The pass carries no covariances.
        """
        if self.curvature is None or self._kernel is None:
            return super().covariance(P)
        return self._smoothed(P, self.curvature)[0]

    def _smoothed(self, P: Array, curvature: Array) -> tuple[Array, Array]:
        """P − P L P and L P; kept, since a frame's answer and its readings both need them."""
        if self._found is None or self._found[0] is not P:
            smoothed, product = np.empty(P.shape), np.empty(P.shape)
            if self._kernel is not None:
                self._kernel.smoothed(P, curvature, smoothed, product)
            self._found = P, smoothed, product
        return self._found[1:]

    def through_parts(self, P: Array, matrix: Array, rows: Array, vector: Array) -> None:
        """From after a frame's readings to before them, as :meth:`through_readings`.

        With S = P − P L P, and Z = L P + Λ S / 2, the curvature is L + Λ − Z Λ − (Z Λ)ᵀ.

        Args:
            P: (N, N) posterior covariance.
            matrix: (n, n) information on the first n components.
            rows: (m, N) whitened Jacobian of the other readings: Λ is ``matrix`` on the first n, and rowsᵀ rows.
            vector: (N,) HᵀR⁻¹y with the innovation y of the prior.
        """
        n = len(matrix)
        if self.curvature is not None and self._kernel is None:
            information = rows.T @ rows
            information[:n, :n] += matrix
            self.through_readings(P, information, vector)
            return
        if self.curvature is not None and self._kernel is not None:
            smoothed, product = self._smoothed(P, self.curvature)
            before = np.empty(P.shape)
            rows = np.ascontiguousarray(rows)
            self._kernel.before_readings(self.curvature, smoothed, product, matrix, rows, before)
            self.curvature, self._found = before, None
        kept = self.gradient - vector
        change = P @ kept
        self.gradient = kept - (rows @ change) @ rows
        self.gradient[:n] -= matrix @ change[:n]

    def through_motion(self, transition: RateTransition) -> None:
        """From before a frame's readings to after those of the frame before it, as :meth:`through_plant`."""
        if self.curvature is not None and self._kernel is None:
            self.through_plant(transition.matrix(len(self.gradient)))
            return
        self.gradient = transition.backward(self.gradient)
        if self.curvature is not None and self._kernel is not None:
            before = np.empty(self.curvature.shape)
            A, B = np.ascontiguousarray(transition.A), np.ascontiguousarray(transition.B)
            self._kernel.before_motion(
                self.curvature, A, B, transition.joints, transition.push, transition.rates, before
            )
            self.curvature, self._found = before, None
