"""By how much estimated curves lag behind others."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from mbkf.conventions import Array

LARGEST_DELAY_S, _DELAY_STEPS = 0.15, 61
SETTLING_S = 0.2
"""Delays are measured from here on, when the knowledge of the start is used up."""


def delay(times_s: Array, truth: Array, found: Array) -> float:
    """Time by which ``found`` (T, k) lags behind ``truth``: the shift that leaves the least squared difference, s.

    Args:
        times_s: (T,) times of the frames, s.
        truth: (T, k) true curves.
        found: (T, k) estimated curves.
    """
    if not np.isfinite(found).all():
        return np.inf
    curve = CubicSpline(times_s, truth)
    frames = (times_s >= SETTLING_S + LARGEST_DELAY_S) & (times_s <= times_s[-1] - LARGEST_DELAY_S)
    shifts = np.linspace(-LARGEST_DELAY_S, LARGEST_DELAY_S, _DELAY_STEPS)
    at = times_s[frames]
    misfit = np.array([np.sum((found[frames] - curve(at - shift)) ** 2) for shift in shifts])
    best = int(np.clip(np.argmin(misfit), 1, len(shifts) - 2))
    low, here, high = misfit[best - 1 : best + 2]
    bend = low - 2.0 * here + high
    return float(shifts[best] + 0.5 * (shifts[1] - shifts[0]) * (low - high) / bend)
