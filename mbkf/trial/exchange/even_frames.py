"""Frames of a result at a constant rate, as file formats without time stamps need them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array


def even_rows(times_s: Array, rate_hz: float) -> NDArray[np.intp]:
    """(F,) row of every frame at a constant rate, −1 where a frame is lost.

    Times that do not go by the rate (two rows fall on one frame) are taken as a row per frame.

    Args:
        times_s: (T,) times of the rows, s.
        rate_hz: Frame rate.
    """
    if not len(times_s):
        return np.empty(0, dtype=np.intp)
    numbers = np.round((times_s - times_s[0]) * rate_hz).astype(np.intp)
    if (np.diff(numbers) < 1).any():
        return np.arange(len(times_s))
    rows = np.full(numbers[-1] + 1, -1)
    rows[numbers] = np.arange(len(times_s))
    return rows


def at_rows(values: Array, rows: NDArray[np.intp]) -> Array:
    """(F, …) values (T, …) of these rows; NaN for missing rows."""
    found = np.asarray(values[rows], dtype=float)
    found[rows < 0] = np.nan
    return found
