"""Compiled CasADi functions: the values of the expressions, in the shapes that numpy expects."""

import casadi as ca
import numpy as np
import pytest

from benchmarks.double_pendulum.compiled import Compiled


@pytest.fixture
def compiled():
    x, y = ca.SX.sym("x", 3), ca.SX.sym("y", 2)
    # The Jacobian has structural zeros, which must come out as zeros.
    return Compiled(
        "f", [x, y], [ca.vertcat(x[0] * y[0], ca.sin(x[2])), ca.jacobian(x[0] * y, x), ca.dot(x, x)]
    )


def test_values_and_shapes(compiled):
    x, y = np.array([2.0, 3.0, 0.5]), np.array([5.0, 7.0])
    vector, matrix, scalar = compiled(x, y)
    np.testing.assert_allclose(vector, [10.0, np.sin(0.5)])
    np.testing.assert_array_equal(matrix, [[5.0, 0.0, 0.0], [7.0, 0.0, 0.0]])
    np.testing.assert_allclose(scalar, [x @ x])


def test_results_do_not_change_with_the_next_call(compiled):
    first = compiled(np.ones(3), np.ones(2))
    kept = [one.copy() for one in first]
    compiled(np.full(3, 9.0), np.full(2, 9.0))
    for one, before in zip(first, kept, strict=True):
        np.testing.assert_array_equal(one, before)


def test_wrong_sizes_are_refused(compiled):
    with pytest.raises(ValueError, match="broadcast"):
        compiled(np.ones(4), np.ones(2))
    with pytest.raises(ValueError, match="shorter"):
        compiled(np.ones(3))
