"""How much readings scatter, told by the readings themselves, sample by sample.

White noise of standard deviation σ has third differences of standard deviation √20 σ. What is read changes them as
well, but hardly while it is steady. A quarter of all third differences therefore lies below z √20 σ, z the quartile of
the absolute value of a standard normal number; that level is followed by a Robbins–Monro recursion in its logarithm
(Robbins & Monro 1951):

    ln x ← ln x + η (¼ − share of the sample's third differences below x)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

import numpy as np

from mbkf.conventions import Array

QUANTILE, STEP = 0.25, 0.1
"""The level followed, and η: the level falls to a tenth in thirty samples."""

_LEVEL = 0.318639 * 20.0**0.5
"""Level of third differences for σ = 1."""


@dataclass(frozen=True)
class WhiteNoise:
    """What is known of readings' noise after a sample.

    Attributes:
        sd: Standard deviation of one number.
        least: Noise that is taken for granted: readings are stored in steps of such a size.
        last: The last samples, three at most, the latest last; NaN where there was no reading.
    """

    sd: float
    least: float
    last: tuple[Array, ...] = ()

    def after(self, now: Array) -> WhiteNoise:
        """With the next sample, of the same shape as those before; NaN where there is no reading."""
        if len(self.last) < 3:
            return WhiteNoise(self.sd, self.least, (*self.last, now))
        third = np.abs(now - 3.0 * self.last[2] + 3.0 * self.last[1] - self.last[0])
        # NaN compares as false.
        known = np.count_nonzero(third >= 0.0)
        sd = self.sd
        if known:
            below = np.count_nonzero(third < _LEVEL * sd) / known
            sd = max(self.least, sd * exp(STEP * (QUANTILE - below)))
        return WhiteNoise(sd, self.least, (self.last[1], self.last[2], now))
