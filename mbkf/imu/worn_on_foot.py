"""Evidence that a sensor is worn elsewhere than on a foot.

A foot rests in every stride or, in running and on soft ground, strikes it. A trunk or an arm does neither: it moves as
long as the person walks, and its accelerations stay small.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.numerics.runs import runs

LONGEST_SWING_S = 1.5
"""A foot that walks rests after a shorter time."""

LEAST_LONG_S, LONG_SHARE = 5.0, 0.6
"""So long, and for so much of their time, movements of trunks and arms are longer. On the public full-body recording
(qmt) the share was 0.78 to 0.98 for trunk, head and arms, and 0.33 and 0.38 for the feet."""

STRIKE_MPS2 = 12.0
"""Difference of the specific force from 1 g that a foot exceeds in most seconds of movement: feet that run or roll
reached 17 m/s² and more (public and simulated ones), trunk and arms 10 m/s² at most."""

_MOVING = 0.3


def elsewhere(specific_force_mps2: Array, rate_hz: float, still: BoolArray) -> str:
    """The reason why a sensor is on no foot, "" where it may be on one.

    Args:
        specific_force_mps2: (T, 3) sensor axes.
        rate_hz: Sample rate.
        still: (T,) samples in which it rests.
    """
    lengths = np.array([(stop - start) / rate_hz for start, stop in runs(~still)])
    long = float(lengths[lengths > LONGEST_SWING_S].sum())
    if long < LEAST_LONG_S or long < LONG_SHARE * float(lengths.sum()):
        return ""
    second = max(1, round(rate_hz))
    count = len(still) // second
    off = np.abs(np.linalg.norm(specific_force_mps2[: count * second], axis=1) - GRAVITY_M_S2)
    moving = (~still[: count * second]).reshape(count, second).mean(axis=1) > _MOVING
    strike = float(np.median(off.reshape(count, second).max(axis=1)[moving])) if moving.any() else 0.0
    if strike >= STRIKE_MPS2:
        return ""
    return (
        f"it moves for up to {lengths.max():.1f} s without a rest, and its acceleration differs from 1 g by "
        f"{strike:.1f} m/s² only: a foot rests or strikes the ground in every stride. The sensor is worn elsewhere, as "
        "on the trunk or an arm; choose the foot's with --sensor, or record with a sensor on the foot"
    )
