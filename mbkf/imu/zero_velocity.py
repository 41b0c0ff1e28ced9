"""When a foot stands still, read from its accelerometer and gyroscope.

The statistic is the generalised likelihood ratio of Skog, Händel, Nilsson and Rantakokko, *Zero-velocity detection —
an algorithm evaluation*, IEEE Trans. Biomed. Eng. 57 (2010), eq. 9.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.numerics.runs import runs

_POSITIVE = (
    "window_s", "acceleration_m_s2", "angular_rate_rad_s", "threshold", "longest_swing_s", "rolling_threshold",
    "rolling_apart_s", "rolling_s",
)  # fmt: skip


@dataclass(frozen=True)
class StillnessSettings:
    """Limits of standing still.

    Attributes:
        window_s: Time over which the statistic is averaged.
        acceleration_m_s2: Spread of the specific force about a constant of gravity's size that a standing foot shows.
        angular_rate_rad_s: Spread of its angular velocity.
        threshold: The foot is still where the statistic is below.
        shortest_s: Shorter rests do not count.
        bridge_s: Shorter movements within a rest are part of it.
        longest_swing_s: In a longer movement the foot has stood in between without resting: it rolled, slid or shook.
        rolling_threshold: Such a stance is where the statistic is least, if it is below.
        rolling_apart_s: Least time between two of them, and from a rest.
        rolling_s: Time for which one of them lasts.
    """

    window_s: float = 0.1
    acceleration_m_s2: float = 0.6
    angular_rate_rad_s: float = 0.6
    threshold: float = 2.0
    shortest_s: float = 0.08
    bridge_s: float = 0.05
    longest_swing_s: float = 1.0
    rolling_threshold: float = 300.0
    rolling_apart_s: float = 0.4
    rolling_s: float = 0.04

    def __post_init__(self) -> None:
        for name in _POSITIVE:
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise InvalidInput(f"{name} must be positive, got {getattr(self, name)}")
        for name in ("shortest_s", "bridge_s"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) >= 0.0):
                raise InvalidInput(f"{name} must be 0 or more, got {getattr(self, name)}")


def stance_statistic(
    specific_force_mps2: Array, angular_velocity_rad_s: Array, rate_hz: float, settings: StillnessSettings
) -> Array:
    """(T,) mean over the window of |f − g f̄/|f̄||²/σ_f² + |ω|²/σ_ω², f̄ the window's mean specific force.

    Args:
        specific_force_mps2: (T, 3) sensor axes.
        angular_velocity_rad_s: (T, 3) sensor axes.
        rate_hz: Sample rate.
        settings: σ_f, σ_ω and the window.
    """
    from scipy.ndimage import uniform_filter1d

    size = max(3, round(settings.window_s * rate_hz)) | 1
    mean = uniform_filter1d(specific_force_mps2, size, axis=0, mode="nearest")
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    gravity = GRAVITY_M_S2 * mean / np.maximum(length, 1e-9)
    off = ((specific_force_mps2 - gravity) ** 2).sum(axis=1) / settings.acceleration_m_s2**2
    turning = (angular_velocity_rad_s**2).sum(axis=1) / settings.angular_rate_rad_s**2
    averaged: Array = uniform_filter1d(off + turning, size, mode="nearest")
    return averaged


def still_samples(
    specific_force_mps2: Array, angular_velocity_rad_s: Array, rate_hz: float, settings: StillnessSettings
) -> BoolArray:
    """(T,) samples in which the foot stands still, by :func:`stance_statistic`.

    Args:
        specific_force_mps2: (T, 3) sensor axes.
        angular_velocity_rad_s: (T, 3) sensor axes.
        rate_hz: Sample rate.
        settings: Threshold, and the shortest gap and rest.
    """
    from scipy.ndimage import binary_closing, binary_opening

    still = (
        stance_statistic(specific_force_mps2, angular_velocity_rad_s, rate_hz, settings) < settings.threshold
    )
    gap, rest = (max(1, round(s * rate_hz)) for s in (settings.bridge_s, settings.shortest_s))
    # Beyond the ends the mask keeps its value at the ends.
    margin = gap + rest
    padded = np.pad(still, margin, mode="edge")
    closed = binary_closing(padded, np.ones(gap + 1, dtype=bool))
    opened: BoolArray = binary_opening(closed, np.ones(rest, dtype=bool))
    return opened[margin:-margin]


def rolling_samples(
    specific_force_mps2: Array,
    angular_velocity_rad_s: Array,
    rate_hz: float,
    still: BoolArray,
    settings: StillnessSettings,
) -> BoolArray:
    """(T,) samples in which a foot that does not rest may stand: where it is stillest in long movements.

    Some of them are not stances (a foot in swing may turn little); the velocity decides.

    Args:
        specific_force_mps2: (T, 3) sensor axes.
        angular_velocity_rad_s: (T, 3) sensor axes.
        rate_hz: Sample rate.
        still: (T,) samples in which it rests.
        settings: Limits.
    """
    from scipy.signal import find_peaks

    short = replace(settings, window_s=settings.rolling_s)
    unsteady = stance_statistic(specific_force_mps2, angular_velocity_rad_s, rate_hz, short)
    found, reach = np.zeros(len(still), dtype=bool), max(1, round(0.5 * settings.rolling_s * rate_hz))
    apart = max(1, round(settings.rolling_apart_s * rate_hz))
    for start, stop in runs(~still):
        if stop - start < settings.longest_swing_s * rate_hz:
            continue
        calm = -np.log(unsteady[start:stop] + 1e-9)
        least, _ = find_peaks(calm, height=-np.log(settings.rolling_threshold), distance=apart)
        for k in least + start:
            if (start == 0 or k - start >= apart) and (stop == len(still) or stop - k >= apart):
                found[max(start, k - reach) : min(stop, k + reach + 1)] = True
    return found
