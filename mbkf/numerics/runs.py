"""Unbroken runs of True in a mask, and indices spread evenly over a sequence."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray


def runs(mask: BoolArray) -> list[tuple[int, int]]:
    """First sample of each unbroken run of True in a mask (S,), and the sample after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def stretches(mask: BoolArray) -> list[Array]:
    """Sample numbers of each unbroken run of True in a mask (S,)."""
    return [np.asarray(np.arange(first, after)) for first, after in runs(mask)]


def spread_indices(length: int, most: int, first: int = 0) -> NDArray[np.intp]:
    """Different indices, evenly spread over a sequence.

    Args:
        length: Length of the sequence.
        most: Greatest number of indices.
        first: Least index; the greatest is the sequence's last.
    """
    if length <= first:
        return np.zeros(0, dtype=np.intp)
    found = np.linspace(first, length - 1, most).astype(np.intp)
    return np.asarray(found[np.diff(found, prepend=first - 1) > 0])
