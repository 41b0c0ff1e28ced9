"""When a person with sensors stands still, and which sensor comes first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.imu.readings import ImuReadings

STILL_RAD_S, STILL_S = 0.15, 1.0
"""Standing: no sensor turns faster (root mean square) for so long."""

CALIBRATED_S = 2.5
"""So long a standing is used where it lasts: a person sways, and a second's sway of a degree is taken for a gyroscope's
bias of 1°/s, two and a half seconds' for one of 0.4°/s."""


def root_first(names: Sequence[str], root: str) -> list[int]:
    """The root segment, usually the pelvis, first.

    Raises:
        InvalidInput: No sensor is on a segment, or a segment has two sensors.
    """
    if root not in names:
        raise InvalidInput(f"joint angles need a sensor on the {root}; there are {', '.join(names)}")
    return carrier_first(names, root)


def carrier_first(names: Sequence[str], carrier: str) -> list[int]:
    """One segment first, the others as they come.

    Args:
        names: Segments that carry sensors.
        carrier: The first one.

    Raises:
        InvalidInput: A segment has two sensors.
    """
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InvalidInput(f"two sensors sit on {twice[0]}; keep one of them with --sensor")
    return sorted(range(len(names)), key=lambda k: names[k] != carrier)


def standing_window(sensors: Sequence[ImuReadings], time_s: Array, standing: object = None) -> slice:
    """Samples of standing.

    Args:
        sensors: The sensors' readings.
        time_s: (T,) the samples, s.
        standing: Its first and last time, s; None: the first second in which no sensor turns, and the part of the
            seconds after it is as calm, up to :data:`CALIBRATED_S` in all.

    Raises:
        InvalidInput: Readings are missing then, or the person never stands still.
    """
    if isinstance(standing, tuple):
        first, last = (float(one) for one in standing)
        chosen = np.flatnonzero((time_s >= first) & (time_s <= last))
        if not len(chosen):
            raise InvalidInput(f"readings are missing from {first:g} to {last:g} s; correct --standing")
        return slice(int(chosen[0]), int(chosen[-1]) + 1)
    width = max(2, round(STILL_S * sensors[0].rate_hz))
    worst = np.zeros(len(time_s))
    for one in sensors:
        rates = np.sqrt((np.nan_to_num(one.angular_velocity_rad_s) ** 2).sum(axis=1))
        worst = np.maximum(worst, np.interp(time_s, one.time_s, rates))
    if len(worst) >= width:
        mean = np.convolve(worst**2, np.ones(width) / width, mode="valid")
        calm = mean < STILL_RAD_S**2
        if calm.any():
            first = int(np.argmax(calm))
            ended = np.flatnonzero(~calm[first:])
            seconds = int(ended[0]) if len(ended) else len(calm) - first
            # Before a movement, half a second is left out: it begins slowly.
            longest = seconds - 1 + width - (width // 2 if len(ended) else 0)
            most = round(CALIBRATED_S * sensors[0].rate_hz)
            return slice(first, first + max(width, min(longest, most)))
    raise InvalidInput(
        "the person never stands still for a second; stand at the start, or give the time with --standing T0:T1"
    )
