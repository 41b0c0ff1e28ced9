"""Backward pass of a smoother by the compiled kernel (``smoothing.c``), which leaves out zeros of Φ and Λ."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.numerics.smoothing import BackwardPass
from mbkf.numerics.transition import RateTransition, Transition


class SparseBackwardPass(BackwardPass):
    """A :class:`mbkf.numerics.smoothing.BackwardPass` that takes readings and transitions by their parts.

    Without a kernel, the parts are assembled.
    """

    def __init__(self, size: int, covariances: bool = True) -> None:
        super().__init__(size, covariances)
        self._kernel = library() if covariances else None
        self._of: Array | None = None
        self._given = False
        if self._kernel is not None:  # fresh memory costs more than the products that go there
            self._smoothed, (self._PL, self._spare) = np.empty((size, size)), np.empty((2, size, size))

    def covariance(self, P: Array) -> Array:
        """(N, N) smoothed covariance of a frame with posterior covariance P, not to be changed.

        Raises:
            ValueError: The pass carries no covariances.
        """
        if self.curvature is None or self._kernel is None:
            return super().covariance(P)
        self._smooth(P, self.curvature)
        self._given = True
        return self._smoothed

    def _smooth(self, P: Array, curvature: Array) -> None:
        """Works out P − P L P and P L; kept, since a frame's answer and its readings both need them."""
        if self._of is not P and self._kernel is not None:
            if self._given:
                self._smoothed, self._given = np.empty(P.shape), False
            self._kernel.smoothed_covariance(P, curvature, self._smoothed, self._PL)
            self._of = P

    def _swap(self) -> None:
        """The curvature worked out in the spare memory becomes the current one."""
        if self.curvature is not None:
            self._spare, self.curvature, self._of = self.curvature, self._spare, None

    def through_parts(
        self, P: Array, matrix: Array, rows: Array, vector: Array, change: Array | None = None
    ) -> None:
        """From after a frame's readings to before them, as :meth:`through_readings`.

        With S = P − P L P, and Z = L P + Λ S / 2, the curvature is L + Λ − Z Λ − (Z Λ)ᵀ.

        Args:
            P: (N, N) posterior covariance.
            matrix: (n, n) information on the first n components.
            rows: (m, N) whitened Jacobian of the other readings: Λ is ``matrix`` on the first n, and rowsᵀ rows.
            vector: (N,) HᵀR⁻¹y with the innovation y of the prior.
            change: (N,) P (λ − vector), where it is known; it saves a product with P.
        """
        n = len(matrix)
        if self.curvature is not None and self._kernel is None:
            super().through_parts(P, matrix, rows, vector, change)
            return
        if self.curvature is not None and self._kernel is not None:
            self._smooth(P, self.curvature)
            known = matrix, np.ascontiguousarray(rows)
            self._kernel.curvature_before_readings(
                self.curvature, self._smoothed, self._PL, *known, self._spare
            )
            self._swap()
        kept = self.gradient - vector
        change = P @ kept if change is None else change
        self.gradient = kept - (rows @ change) @ rows
        self.gradient[:n] -= matrix @ change[:n]

    def through_motion(self, transition: Transition) -> None:
        """From before a frame's readings to after those of the frame before it.

        A transition other than a :class:`mbkf.numerics.transition.RateTransition` is taken as a matrix.
        """
        if self.curvature is None:
            self.gradient = transition.backward(self.gradient)
        elif self._kernel is None or not isinstance(transition, RateTransition):
            super().through_motion(transition)
            self._of = None
        else:
            self.gradient = transition.backward(self.gradient)
            A, B = np.ascontiguousarray(transition.A), np.ascontiguousarray(transition.B)
            self._kernel.curvature_before_motion(
                self.curvature, A, B, transition.joints, transition.push, transition.rates, self._spare
            )
            self._swap()
