"""Diagonals of the square blocks of a matrix, all of them as one view to write into."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array


def block_diagonals(matrix: Array, blocks: int, n: int) -> Array:
    """(blocks, blocks, n) view of the diagonals of the (n, n) blocks at the beginning of a matrix.

    Args:
        matrix: (N, N) with N at least ``blocks`` times ``n``, in C order.
        blocks: Blocks in a row and in a column.
        n: Rows of a block.

    Raises:
        ValueError: The matrix is too small or not in C order.
    """
    if not matrix.flags.c_contiguous or len(matrix) < blocks * n:
        raise ValueError(f"{blocks} blocks of {n} need a matrix in C order with as many rows")
    item, row = matrix.itemsize, matrix.strides[0]
    return np.ndarray((blocks, blocks, n), matrix.dtype, matrix, 0, (n * row, n * item, row + item))
