"""A transition by its parts is the matrix that it stands for."""

import numpy as np
import pytest

from mbkf.numerics.transition import DenseTransition, RateTransition
from tests.motions import worst

DOFS = 5


def transition(rng, orders):
    joints = np.array([[0, 3], [3, 4], [4, 5]], dtype=np.int32)
    A, B = np.zeros((2, DOFS, DOFS))
    for first, end in joints:
        own, dofs = slice(first, end), end - first
        A[own, own], B[own, own] = rng.normal(size=(2, dofs, dofs))
    return RateTransition(A, B, joints, rng.normal(size=orders), rng.normal(size=(orders, orders)))


@pytest.mark.parametrize("orders", [1, 2])
@pytest.mark.parametrize("rest", [0, 4])
def test_the_parts_are_the_matrix(orders, rest):
    rng = np.random.default_rng(orders)
    parts, size = transition(rng, orders), (1 + orders) * DOFS + rest
    phi = parts.matrix(size)
    moving = (1 + orders) * DOFS
    expected = np.eye(size)
    expected[:DOFS, :moving] = np.hstack([parts.A, *(push * parts.B for push in parts.push)])
    expected[DOFS:moving, DOFS:moving] = np.kron(parts.rates, np.eye(DOFS))
    np.testing.assert_array_equal(phi, expected)
    x = rng.normal(size=size)
    kept = x.copy()
    assert worst(parts.forward(x) - phi @ x) <= 1e-14 * worst(phi) * worst(x) * size
    np.testing.assert_array_equal(x, kept)
    dense = DenseTransition(phi)
    np.testing.assert_array_equal(dense.matrix(size), dense.phi)
    np.testing.assert_allclose(dense.forward(x), parts.forward(x), atol=1e-13 * worst(phi) * worst(x) * size)
