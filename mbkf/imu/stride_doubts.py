"""Strides that are impossible for a person or unknown, each with its reason."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.strides import Stride

LONGEST_M, FASTEST_M_S, HIGHEST_M = 5.0, 12.0, 1.5
"""Sprinters' strides are 4.9 m at 12 m/s; no foot rises higher above its way."""

LEAST_KNOWN_M, LEAST_KNOWN_SHARE = 0.15, 0.1
"""A stride that is known to less than this, and to less than this share of its length, is not known."""

LONG_SWING, LEAST_LONG_SWING_S = 1.8, 0.8
"""A swing that lasts for so many usual ones holds a stance that was not seen."""

REACH_M = 2.0
"""Feet of one person are never further apart, flight in running included."""


def doubted(strides: Sequence[Stride]) -> tuple[Stride, ...]:
    """The strides of a foot, those refused with their reason."""
    swings = [stride.swing_s for stride in strides]
    usual = float(np.median(swings)) if len(swings) > 2 else np.inf
    return tuple(replace(stride, doubt=_doubt(stride, usual)) for stride in strides)


def out_of_reach(
    strides: Sequence[Stride],
    time_s: Array,
    position_m: Array,
    other_time_s: Array,
    other_position_m: Array,
) -> tuple[Stride, ...]:
    """The strides of a foot, those at whose end the other foot would be out of reach with that reason.

    Args:
        strides: The foot's.
        time_s: (T,) its times.
        position_m: (T, 3) its path, in one frame with the other's.
        other_time_s: (S,) times of the other foot.
        other_position_m: (S, 3) its path.
    """
    known = np.isfinite(other_position_m).all(axis=1)
    if not known.any():
        return tuple(strides)
    found = []
    for stride in strides:
        at = float(time_s[stride.last])
        there = other_time_s[known][0] <= at <= other_time_s[known][-1]
        other = [np.interp(at, other_time_s[known], other_position_m[known, axis]) for axis in (0, 1)]
        apart = float(np.hypot(*(position_m[stride.last, :2] - other)))
        reason = f"the feet would be {apart:.1f} m apart" if there and apart > REACH_M else ""
        found.append(replace(stride, doubt=stride.doubt or reason))
    return tuple(found)


def _doubt(stride: Stride, usual_swing_s: float) -> str:
    if stride.length_m > LONGEST_M:
        return f"{stride.length_m:.1f} m is longer than any person's stride"
    if stride.duration_s > 0.0 and stride.speed_m_s > FASTEST_M_S:
        return f"{stride.speed_m_s:.0f} m/s is faster than any person"
    if stride.lift_m > HIGHEST_M or abs(stride.rise_m) > HIGHEST_M:
        return f"the foot would rise by {max(stride.lift_m, abs(stride.rise_m)):.1f} m"
    if stride.length_sd_m > max(LEAST_KNOWN_M, LEAST_KNOWN_SHARE * stride.length_m):
        return (
            f"its length is known to {stride.length_sd_m:.2f} m only: nothing held the velocity for "
            f"{stride.swing_s:.1f} s"
        )
    if stride.swing_s > max(LONG_SWING * usual_swing_s, LEAST_LONG_SWING_S):
        return f"a swing of {stride.swing_s:.2f} s where {usual_swing_s:.2f} s is usual: a stance was missed"
    return ""
