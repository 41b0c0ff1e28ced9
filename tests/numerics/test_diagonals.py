"""Diagonals of blocks: a view that is written through, of matrices in C order only."""

import numpy as np
import pytest

from mbkf.numerics.diagonals import block_diagonals


@pytest.mark.parametrize(("blocks", "n", "more"), [(2, 4, 0), (3, 5, 2), (1, 1, 0)])
def test_the_view_holds_the_diagonal_of_every_block(blocks, n, more):
    A = np.random.default_rng(0).normal(size=(blocks * n + more,) * 2)
    found = block_diagonals(A, blocks, n)
    for i in range(blocks):
        for j in range(blocks):
            block = A[i * n : (i + 1) * n, j * n : (j + 1) * n]
            np.testing.assert_array_equal(found[i, j], np.diagonal(block))
    before = A.copy()
    found += 1.0
    assert np.count_nonzero(before != A) == blocks * blocks * n


def test_other_orders_and_sizes_are_refused():
    for wrong in (np.zeros((6, 6), order="F"), np.zeros((5, 5))):
        with pytest.raises(ValueError, match="3 blocks of 2"):
            block_diagonals(wrong, 3, 2)
