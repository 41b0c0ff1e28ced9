"""Sparse rows of splines are those of the dense basis, and banded equations have the dense solution."""

import numpy as np
import pytest
from scipy import sparse
from scipy.interpolate import BSpline

from mbkf.synthesis.bands import BandedCholesky, spline_rows

DEGREE = 5
KNOTS = np.r_[[0.0] * DEGREE, np.linspace(0.0, 2.0, 13) ** 1.3, [2.0**1.3] * DEGREE]
TIMES = np.linspace(0.0, 2.0**1.3, 57)


@pytest.mark.parametrize("order", range(4))
def test_rows_are_those_of_the_dense_basis(order):
    size = len(KNOTS) - DEGREE - 1
    dense = BSpline(KNOTS, np.eye(size), DEGREE)(TIMES, nu=order)
    rows = spline_rows(KNOTS, DEGREE, TIMES, order)
    assert np.abs(rows.toarray() - dense).max() < 1e-12 * np.abs(dense).max()
    assert rows.nnz <= (DEGREE + 1) * len(TIMES)


def test_the_banded_solution_is_the_dense_one():
    rows = spline_rows(KNOTS, DEGREE, TIMES, 0)
    matrix = rows.T @ rows + 1e-3 * sparse.eye_array(rows.shape[1])
    right = np.random.default_rng(0).normal(size=(rows.shape[1], 2))
    found = BandedCholesky(matrix).solve(right)
    assert np.abs(found - np.linalg.solve(matrix.toarray(), right)).max() < 1e-9 * np.abs(found).max()
