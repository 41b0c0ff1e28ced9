"""Which point of the frame before a point continues, where the file or stream keeps tracks in its columns."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import squared_distances


def continued(before_m: Array, now_m: Array) -> BoolArray:
    """(C,) columns whose point now is the same physical point as in the frame before.

    A column is believed where its point lies nearer to its own place before than to any other point's, and the other
    way round. Points shuffled in every frame fail this, so that nothing need be known of the file.

    Args:
        before_m: (C, 3) the frame before, NaN where a column is empty.
        now_m: (C, 3) this frame.
    """
    there = np.asarray(~np.isnan(before_m).any(axis=1))
    here = np.asarray(~np.isnan(now_m).any(axis=1))
    same = np.asarray(there & here)
    if same.any():
        squared = squared_distances(now_m[here], before_m[there])
        rows, columns = (np.cumsum(here) - 1)[same], (np.cumsum(there) - 1)[same]
        own = squared[rows, columns]
        same[same] = (own <= squared[rows].min(axis=1)) & (own <= squared[:, columns].min(axis=0))
    return same
