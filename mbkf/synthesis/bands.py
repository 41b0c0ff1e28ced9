"""Least squares on B-splines, whose equations are bands: few splines reach each time, and only near ones overlap."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.linalg import cho_solve_banded, cholesky_banded

from mbkf.conventions import Array


def spline_rows(knots: Array, degree: int, times: Array, order: int) -> sparse.csr_array:
    """(T, K) sparse rows that give a derivative of a spline from its K coefficients.

    Differentiation takes the spline to one of lower degree, by divided differences of its coefficients (C. de Boor, A
    Practical Guide to Splines, revised edition 2001, chapter X).

    Args:
        knots: (K + degree + 1,) knots, in order.
        degree: Of the spline.
        times: (T,) times from the first to the last knot.
        order: Order of the derivative, 0 for the spline itself.
    """
    size = len(knots) - degree - 1
    differences = sparse.eye_array(size, format="csr")
    for _ in range(order):
        slope = degree / (knots[degree + 1 : -1] - knots[1 : -degree - 1])
        size, degree, knots = size - 1, degree - 1, knots[1:-1]
        step = sparse.diags_array([-slope, slope], offsets=[0, 1], shape=(size, size + 1))
        differences = step.tocsr() @ differences
    return sparse.csr_array(BSpline.design_matrix(times, knots, degree)) @ differences


class BandedCholesky:
    """Solves equations with a symmetric, positive definite, banded matrix."""

    def __init__(self, matrix: sparse.sparray) -> None:
        """Factorises.

        Args:
            matrix: (K, K) sparse matrix.
        """
        lower = sparse.coo_array(sparse.tril(matrix))
        row, column = lower.coords
        below = row - column
        bands = np.zeros((1 + int(below.max(initial=0)), matrix.shape[0]))
        bands[below, column] = lower.data
        self._factor = cholesky_banded(bands, lower=True)

    def solve(self, right: Array) -> Array:
        """(K, N) solution for (K, N) right sides."""
        return np.asarray(cho_solve_banded((self._factor, True), right))
