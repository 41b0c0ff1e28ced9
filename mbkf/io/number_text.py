"""Rows of numbers as text, each number with some digits, correctly rounded; the kernel writes those of usual size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library

BYTES, NUMBER_BYTES = 1 << 18, 24
"""Size of the kernel's memory for text, and the least that it needs for each number of a row."""


def number_rows(values: Array, digits: Sequence[int]) -> Iterator[str]:
    """Lines of rows, numbers between tabs, one or many at a time.

    Args:
        values: (T, C) the numbers; those that are missing become ``nan``.
        digits: (C,) significant digits of a column, as ``%g`` writes them; decimals, as ``%f`` does, with a minus.
    """
    kernel = library()
    line = "\t".join(f"%.{n}g" if n > 0 else f"%.{-n}f" for n in digits) + "\n"
    if kernel is None:
        yield from (line % tuple(row.tolist()) for row in values)
        return
    values, columns = np.ascontiguousarray(values, dtype=float), np.array(digits, dtype=np.int32)
    text, begin = np.empty(max(BYTES, NUMBER_BYTES * len(columns)), dtype=bool), 0
    while begin < len(values):
        end, size = kernel.number_rows(values, columns, begin, text)
        if end == begin:  # a number too large or small for the kernel
            yield line % tuple(values[begin].tolist())
            begin += 1
        else:
            yield text[:size].tobytes().decode("ascii")
            begin = end
