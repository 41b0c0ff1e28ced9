"""How much plates' readings scatter, told by the readings themselves, frame by frame.

White noise of standard deviation σ has third differences of standard deviation √20 σ. A load that a person makes
changes them as well, but hardly on a plate that nobody stands on, or while the load is steady. A quarter of all third
differences therefore lies below z √20 σ, z the quartile of the absolute value of a standard normal number; that level
is followed by a Robbins–Monro recursion in its logarithm (Robbins & Monro 1951):

    ln x ← ln x + η (¼ − share of the frame's third differences below x)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

from mbkf.conventions import Array

LEAST_N = 0.1
"""Noise that is taken for granted: readings are stored in steps of such a size."""

QUANTILE, STEP = 0.25, 0.1
"""The level followed, and η: the level falls to a tenth in thirty frames."""

_LEVEL = 0.318639 * 20.0**0.5
"""Level of third differences for σ = 1."""


@dataclass(frozen=True)
class PlateNoise:
    """What is known of the plates' noise after a frame.

    Attributes:
        force_n: Standard deviation of a force component's mean over a frame, N.
        last: Forces (3 K) of the last frames, three at most, the latest last; NaN where not recorded.
    """

    force_n: float
    last: tuple[list[float], ...] = ()

    def after(self, plates: Array) -> PlateNoise:
        """With the next frame's wrenches (K, 6), NaN where not recorded."""
        now: list[float] = plates[:, :3].ravel().tolist()
        if len(self.last) < 3:
            return PlateNoise(self.force_n, (*self.last, now))
        # A few numbers: plain arithmetic takes a third of numpy's time.
        level, known, below = _LEVEL * self.force_n, 0, 0
        for d, c, b, a in zip(now, *reversed(self.last), strict=True):
            third = abs(d - 3.0 * c + 3.0 * b - a)
            known += third == third  # noqa: PLR0124, one that is not recorded is NaN
            below += third < level
        force_n = self.force_n
        if known:
            force_n = max(LEAST_N, force_n * exp(STEP * (QUANTILE - below / known)))
        return PlateNoise(force_n, (self.last[1], self.last[2], now))
