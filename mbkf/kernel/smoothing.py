"""Passes of a smoother by the compiled kernel (``smoothing.c``, ``linear_step.c``), without the zeros of Φ and Λ."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.numerics.smoothing import BackwardPass
from mbkf.numerics.transition import RateTransition, Transition


class LinearReadings(NamedTuple):
    """A frame's readings of an error, Λ d = λ in the mean.

    Attributes:
        matrix: (n, n) Λ on the first n components.
        vector: (n,) its λ.
        rows: (m, N) whitened Jacobian H of the other readings, which add HᵀH to Λ.
        values: (m,) their innovations y, which add Hᵀy to λ.
        added: (N,) added to λ; None for nothing.
    """

    matrix: Array
    vector: Array
    rows: Array
    values: Array
    added: Array | None


def linear_step(
    P: Array, before: Array, offset: Array, readings: LinearReadings, transition: Transition
) -> tuple[Array, Array]:
    """(N,) g = λ − Λ d and (N,) d + P g with d = Φ δ + o: a filter's step in corrections of a trajectory.

    Args:
        P: (N, N) posterior covariance.
        before: (N,) δ of the frame before.
        offset: (N,) o from the trajectory to its prediction of the frame.
        readings: Innovations and information at the trajectory.
        transition: Φ of the step into the frame.
    """
    kernel, (matrix, vector, rows, values, added) = library(), readings
    if kernel is not None and isinstance(transition, RateTransition):
        known = matrix, vector, rows, values, np.zeros(len(P)) if added is None else added
        A, B = np.ascontiguousarray(transition.A), np.ascontiguousarray(transition.B)
        phi = A, B, transition.joints, transition.push, transition.rates
        return kernel.linear_step(P, before, offset, *known, *phi)
    moved, n = transition.forward(before) + offset, len(vector)
    gradient = (values - rows @ moved) @ rows
    gradient[:n] += vector - matrix @ moved[:n]
    if added is not None:
        gradient += added
    return gradient, moved + P @ gradient


class SparseBackwardPass(BackwardPass):
    """A :class:`mbkf.numerics.smoothing.BackwardPass` that takes readings and transitions by their parts.

    Without a kernel, the parts are assembled.
    """

    def __init__(self, size: int, covariances: bool = True) -> None:
        super().__init__(size, covariances)
        self._kernel = library()
        self._of: tuple[Array, Array] | None = None
        self._given = False
        if (
            self._kernel is not None and covariances
        ):  # fresh memory costs more than the products that go there
            self._smoothed, (self._LP, self._spare) = np.empty((size, size)), np.empty((2, size, size))

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
        """Works out P − P L P and L P; kept, since a frame's answer and its readings both need them."""
        if not self._knows(P, curvature) and self._kernel is not None:
            if self._given:
                self._smoothed, self._given = np.empty(P.shape), False
            self._kernel.smoothed_covariance(P, curvature, self._smoothed, self._LP)
            self._of = P, curvature

    def _knows(self, P: Array, curvature: Array) -> bool:
        return self._of is not None and self._of[0] is P and self._of[1] is curvature

    def _swap(self) -> None:
        """The curvature worked out in the spare memory becomes the current one."""
        if self.curvature is not None:
            self._spare, self.curvature, self._of = self.curvature, self._spare, None

    def through_frame(
        self, P: Array, matrix: Array, rows: Array, vector: Array, transition: Transition
    ) -> Array:
        """From after a frame's readings to after those of the frame before it; returns :meth:`step` of the frame.

        With S = P − P L P, and Z = L P + Λ S / 2, the curvature before the readings is L + Λ − Z Λ − (Z Λ)ᵀ. Where
        :meth:`covariance` has not been asked for, only the parts that Λ reads are computed. A transition other than a
        :class:`mbkf.numerics.transition.RateTransition` is taken as a matrix.

        Args:
            P: (N, N) posterior covariance.
            matrix: (n, n) information on the first n components.
            rows: (m, N) whitened Jacobian of the other readings: Λ is ``matrix`` on the first n, and rowsᵀ rows.
            vector: (N,) HᵀR⁻¹y with the innovation y of the prior.
            transition: Φ of the step into the frame.
        """
        if self._kernel is None:
            return super().through_frame(P, matrix, rows, vector, transition)
        rows = np.ascontiguousarray(rows)
        if self.curvature is not None:
            L, before = self.curvature, self._spare
            if self._knows(P, L):
                self._kernel.curvature_before_readings(L, self._smoothed, self._LP, matrix, rows, before)
            else:
                self._kernel.curvature_before_readings_alone(L, P, matrix, rows, before)
            self._swap()
        if not isinstance(transition, RateTransition):
            step, kept = self.step(P), self.gradient - vector
            change = P @ kept
            kept -= (rows @ change) @ rows
            kept[: len(matrix)] -= matrix @ change[: len(matrix)]
            self.gradient = kept
            self.through_plant(transition.matrix(len(kept)))
            return step
        A, B = np.ascontiguousarray(transition.A), np.ascontiguousarray(transition.B)
        phi = A, B, transition.joints, transition.push, transition.rates
        step, self.gradient = self._kernel.gradient_before(P, self.gradient, vector, matrix, rows, *phi)
        if self.curvature is not None:
            self._kernel.curvature_before_motion(self.curvature, *phi, self._spare)
            self._swap()
        return step
