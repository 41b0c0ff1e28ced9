"""Forces and moments of a plate: centre of pressure, zero offset, checked records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import finite
from mbkf.io.records import PlateReadings

DEFAULT_COP_THRESHOLD_N = 20.0
"""Vertical force below which a centre of pressure is mostly noise, in N."""

LARGEST = 1e12
"""Readings of plates are smaller in any unit; sums of squares of such numbers would overflow."""

UNLOADED_RANGE_N = (-200.0, 50.0)
"""Vertical force a plate without load may show; a plate cannot pull, so the range is wider below zero."""

_WINDOW_S = 0.03
_QUIET_SD_N = 2.0
_QUIET_RATIO = 4.0
_LEAST_UNLOADED_S = 0.08


@dataclass(frozen=True)
class Tare:
    """Offset found in a plate's readings.

    Attributes:
        offset: (6,) force in N and moment in N m the plate shows without load; zero where not found.
        unloaded_s: Seconds of recording it rests on; zero where not found.
    """

    offset: Array
    unloaded_s: float

    @property
    def found(self) -> bool:
        """True where the plate was without load for long enough."""
        return self.unloaded_s > 0.0


class PlateWay(NamedTuple):
    """Signs, factor and offset that all readings of a plate show, with which a part of them is read.

    Attributes:
        origin_m: (3,) vector from the point that the channels refer to, to the middle of the surface, plate axes.
        factor: Factor of the moments, 1 where their unit is right.
        tare: The offset.
    """

    origin_m: Array
    factor: float
    tare: Tare


def centre_of_pressure(
    force_n: Array, moment_nm: Array, origin_m: Array, normal: Array, threshold_n: float
) -> Array:
    """(S, 3) world points of a plate's surface about which the horizontal moment vanishes, m; NaN below the threshold.

    With M the moment about a point o of the surface, F the force and n the normal, r = n × M / (n · F) and
    the point is o + r.

    Args:
        force_n: (S, 3) forces in N, world axes.
        moment_nm: (S, 3) moments about ``origin_m`` in N m, world axes.
        origin_m: (3,) a point of the surface in m.
        normal: (3,) unit normal of the surface.
        threshold_n: Vertical force in N below which the point is not given.
    """
    pressed = force_n @ normal
    loaded = (force_n[:, 2] >= threshold_n) & (pressed > 0.0)
    points = np.full(force_n.shape, np.nan)
    points[loaded] = origin_m + np.cross(normal, moment_nm[loaded]) / pressed[loaded, None]
    return points


def require_finite(force_n: Array, moment_nm: Array, rate_hz: float, start_time_s: float, where: str) -> None:
    """Refuse readings that are not numbers, or larger than any plate gives in any unit.

    Args:
        force_n: (S, 3) forces.
        moment_nm: (S, 3) moments.
        rate_hz: Sample rate.
        start_time_s: Time of the first sample.
        where: The file and plate, for the message.

    Raises:
        InvalidInput: A force or moment is NaN, infinite or beyond :data:`LARGEST`; says where first and how many.
    """
    sides = [(one.min(initial=0.0), one.max(initial=0.0)) for one in (force_n, moment_nm)]
    if all(least >= -LARGEST and most <= LARGEST for least, most in sides):  # not so with a NaN
        return
    bad, fault = ~(finite(force_n) & finite(moment_nm)), "are not numbers"
    if not bad.any():
        bad = np.asarray((np.abs(np.hstack([force_n, moment_nm])) > LARGEST).any(axis=1))
        fault = f"are larger than {LARGEST:g}"
    first = start_time_s + np.argmax(bad) / rate_hz
    raise InvalidInput(
        f"{where}: {bad.sum()} of {len(bad)} samples of force or moment {fault}, the first at "
        f"{first:.3f} s; repair these samples, or cut the trial before or after them"
    )


def find_tare(wrench: Array, rate_hz: float) -> Tare:
    """Offset of a plate's wrench (S, 6), world axes (z up), from the stretches in which it carries no load.

    The recording is cut into windows of 30 ms. Those with a vertical force inside ``UNLOADED_RANGE_N`` and a
    small spread are candidates; the mode of their vertical force is the unloaded level, and the offset is the
    median of the candidates near it. A plate that is loaded all the time has no candidates and no offset.
    Samples in which all six readings are exactly zero were zeroed by software and carry no information on
    another level, so they only count where they prevail.
    """
    size = max(4, round(_WINDOW_S * rate_hz))
    count = len(wrench) // size
    if not count:
        return Tare(np.zeros(6), 0.0)
    windows = wrench[: count * size].reshape(count, size, 6)
    means, spread = windows.mean(axis=1), windows[:, :, 2].std(axis=1)
    low, high = UNLOADED_RANGE_N
    candidate = (means[:, 2] > low) & (means[:, 2] < high)
    if not candidate.any():
        return Tare(np.zeros(6), 0.0)
    limit = max(_QUIET_SD_N, _QUIET_RATIO * float(np.percentile(spread[candidate], 20)))
    quiet = candidate & (spread < limit)
    level = half_sample_mode(means[quiet, 2])
    near = quiet & (np.abs(means[:, 2] - level) < limit)
    seconds = float(near.sum() * size / rate_hz)
    if seconds < _LEAST_UNLOADED_S:
        return Tare(np.zeros(6), 0.0)
    return Tare(np.median(means[near], axis=0), seconds)


def remove_tare(wrench: Array, tare: Tare) -> Array:
    """(S, 6) readings without their offset; samples a software had zeroed stay zero."""
    zeroed = wrench[:, 2] == 0.0
    zeroed[zeroed] = (wrench[zeroed] == 0.0).all(axis=1)
    found = wrench - tare.offset
    found[zeroed] = 0.0
    return np.asarray(found)


def offset_remarks(plates: Sequence[PlateReadings]) -> list[str]:
    """Remarks on the offsets that were removed from plates or sets."""
    return [
        f"set '{plate.name}': offset of {plate.offset[2]:+.1f} N vertical force removed"
        for plate in plates
        if plate.offset[2]
    ]


def half_sample_mode(values: Array) -> float:
    """Mode of a sample (n,): the half of it that is closest together, repeatedly (Bickel and Frühwirth 2006)."""
    kept = np.sort(values)
    while len(kept) > 2:
        half = (len(kept) + 1) // 2
        widths = kept[half - 1 :] - kept[: len(kept) - half + 1]
        start = int(np.argmin(widths))
        kept = kept[start : start + half]
    return float(kept.mean())
