"""White noise of readings, estimated from the readings themselves, sample by sample.

White noise of standard deviation σ has third differences of standard deviation √20 σ, to which a steady signal adds
hardly anything. A quarter of all third differences therefore lies below z √20 σ, z the quartile of the absolute value
of a standard normal number; a Robbins–Monro recursion in its logarithm (Robbins & Monro 1951) follows that level:

    ln x ← ln x + η (¼ − share of the sample's third differences below x)
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library

QUANTILE, STEP = 0.25, 0.1
"""The level followed, and η: the level falls to a tenth in thirty samples."""

_LEVEL = 0.318639 * 20.0**0.5
"""Level of third differences for σ = 1."""


class WhiteNoise(NamedTuple):
    """Estimate of readings' noise after a sample.

    Attributes:
        sd: Standard deviation of one number; 0 before the first estimate.
        least: Least standard deviation: readings are stored in steps of such a size.
        last: The last samples, three at most, the latest last; NaN without a reading.
    """

    sd: float
    least: float
    last: tuple[Array, ...] = ()

    def after(self, now: Array) -> WhiteNoise:
        """The estimate after the next sample, of the same shape as those before; NaN without a reading."""
        now = np.ascontiguousarray(now, dtype=float)
        if len(self.last) < 3:
            return WhiteNoise(self.sd, self.least, (*self.last, now))
        (first, second, third), sd, kept = self.last, self.sd, (*self.last[1:], now)
        if not sd:
            return WhiteNoise(_first_sd((*self.last, now), self.least), self.least, kept)
        kernel = library()
        count = _third_differences if kernel is None else kernel.third_differences
        known, below = count(first, second, third, now, _LEVEL * sd)
        if known:
            sd = max(self.least, sd * exp(STEP * (QUANTILE - below / known)))
        return WhiteNoise(sd, self.least, kept)


def _first_sd(samples: Sequence[Array], least: float) -> float:
    """Estimate from four samples; 0 without a reading."""
    differences = _third(*samples)
    known = np.sort(differences[~np.isnan(differences)])
    if not known.size:
        return 0.0
    # np.quantile, which takes half a filter's step.
    level = np.interp(QUANTILE * (len(known) - 1), np.arange(len(known)), known)
    return max(least, float(level) / _LEVEL)


def _third(first: Array, second: Array, third: Array, latest: Array) -> Array:
    """Absolute third differences of four samples."""
    return np.abs(latest - 3.0 * third + 3.0 * second - first)


def _third_differences(
    first: Array, second: Array, third: Array, latest: Array, level: float
) -> tuple[int, int]:
    """Number of third differences of four samples that are numbers, and of those below a level."""
    differences = _third(first, second, third, latest)
    # NaN compares as false.
    return int(np.count_nonzero(differences >= 0.0)), int(np.count_nonzero(differences < level))
