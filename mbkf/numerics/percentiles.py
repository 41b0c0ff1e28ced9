"""Percentiles of columns with missing samples, all columns at once: NumPy's own go through them one by one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array


def known_percentiles(values: Array, percents: Sequence[float]) -> Array:
    """(P, …) percentiles along the first axis of (T, …) values without their NaN; NaN where there are none.

    Between two samples they are interpolated linearly, as by ``numpy.nanpercentile``.
    """
    if not len(values):
        return np.full((len(percents), *values.shape[1:]), np.nan)
    ordered = np.sort(values, axis=0)  # NaN last
    last = np.maximum((~np.isnan(values)).sum(axis=0) - 1, 0)
    place = np.asarray(percents).reshape(-1, *[1] * last.ndim) / 100.0 * last
    below = np.floor(place).astype(np.intp)
    low = np.take_along_axis(ordered, below, axis=0)
    high = np.take_along_axis(ordered, np.minimum(below + 1, last), axis=0)
    return np.asarray(low + (place - below) * (high - low))
