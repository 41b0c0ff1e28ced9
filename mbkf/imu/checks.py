"""Faults of inertial readings, found before a filter hides them: each with its likely fix.

Units are judged by physics: at rest the specific force is 1 g, and the angular velocity must turn the direction of
gravity as the accelerometer sees it turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput
from mbkf.imu.soft_saturation import SoftLimit, soft_limits
from mbkf.imu.turned_force import mean_force
from mbkf.io.imu.readings import ImuReadings, rate_of
from mbkf.numerics.runs import runs

STUCK_S = 0.5
"""An axis that repeats one value for so long, while the sensor moves, is stuck."""

SATURATED_SAMPLES = 3
"""So many samples at the greatest value of a channel, in a row or often, are clipped peaks."""

RATE_TOLERANCE = 0.005
_DEGREE = np.pi / 180.0
_SCATTERED = 8
_LEAST_RANGES = {"gyroscope": 1.7, "accelerometer": 14.0}
"""No sensor on the market has a smaller range, rad/s and m/s²."""

BUSY_SHARE = 0.4
"""A specific force whose size varies by more (one standard deviation) is that of a foot that runs."""

_MOVING = 0.8
_CALMEST = 0.3
_WINDOW_S = 3.0
_MOST_WINDOWS = 40
_CLEARLY = 0.05
_FAST_RAD_S = 3.0
_SCALES = {
    1.0: "",
    _DEGREE: "is in deg/s: read it with --units gyr=deg/s",
    1.0 / _DEGREE: "is already in rad/s: read it with --units gyr=rad/s",
    -1.0: "turns against the accelerometer: its sign is reversed, or axes of one of the two are mirrored",
}


@dataclass(frozen=True)
class Problem:
    """One finding.

    Attributes:
        sensor: Sensor name.
        kind: "gap", "stuck", "unit", "saturated", "rate", "time" or "sign".
        text: The fault, its place and the remedy, in one line.
        fatal: Whether results would be wrong, not only poorer.
    """

    sensor: str
    kind: Literal["gap", "stuck", "unit", "saturated", "rate", "time", "sign"]
    text: str
    fatal: bool


def problems(readings: Sequence[ImuReadings]) -> tuple[Problem, ...]:
    """Everything found in one recording of several sensors."""
    found = [problem for one in readings for problem in _of_sensor(one)]
    rates = sorted({round(one.rate_hz, 3) for one in readings})
    if rates and rates[-1] / rates[0] - 1.0 > RATE_TOLERANCE:
        listed = ", ".join(f"{one.name} {one.rate_hz:g} Hz" for one in readings)
        text = f"sensors have unequal rates ({listed}); they are read at their own times, export them at one rate"
        found.append(Problem(readings[0].name, "rate", text, False))
    return tuple(found)


def refuse_fatal(found: Sequence[Problem]) -> tuple[str, ...]:
    """The texts of the problems that are not fatal.

    Raises:
        InvalidInput: Something is fatal; all such findings in one line.
    """
    fatal = [problem.text for problem in found if problem.fatal]
    if fatal:
        raise InvalidInput("; ".join(fatal))
    return tuple(problem.text for problem in found)


def _of_sensor(one: ImuReadings) -> list[Problem]:
    channels = {"accelerometer": one.specific_force_mps2, "gyroscope": one.angular_velocity_rad_s}
    if one.magnetic_field is not None:
        channels["magnetometer"] = one.magnetic_field
    found = _time_problems(one)
    for name, values in channels.items():
        if np.isnan(values).all():
            continue
        found += _gaps(one, name, values)
        found += _stuck(one, name, values)
        if name != "magnetometer":
            found += _saturated(one, name, values)
    if not any(problem.kind == "saturated" and "gyroscope" in problem.text for problem in found):
        found += [_clips_softly(one, limit) for limit in soft_limits(one)]
    wrong = _force_unit(one)
    return [*found, *(wrong or _turning(one))]


def _time_problems(one: ImuReadings) -> list[Problem]:
    steps = np.diff(one.time_s)
    found = []
    if not np.isfinite(one.time_s).all() or (steps <= 0.0).any():
        k = int(np.flatnonzero(~(steps > 0.0))[0]) if len(steps) else 0
        text = f"sensor {one.name}: times do not increase at sample {k + 1}; sort the file or drop its time column"
        return [Problem(one.name, "time", text, True)]
    jumps = np.flatnonzero(steps > 1.5 / one.rate_hz)
    if len(jumps):
        longest = int(jumps[np.argmax(steps[jumps])])
        text = (
            f"sensor {one.name}: {_counted_gaps(len(jumps))} in time, the longest {steps[longest]:.3g} s at "
            f"{one.time_s[longest]:.2f} s; samples were lost, they are bridged by the filter"
        )
        found.append(Problem(one.name, "gap", text, False))
    usual = rate_of(one.time_s, one.name) if len(steps) else one.rate_hz
    if abs(usual / one.rate_hz - 1.0) > 0.02:
        text = (
            f"sensor {one.name}: the times give {usual:.4g} Hz, the stated rate is {one.rate_hz:g} Hz; "
            "correct --rate or the time column's unit"
        )
        found.append(Problem(one.name, "rate", text, True))
    return found


def _counted_gaps(count: int) -> str:
    return "1 gap" if count == 1 else f"{count} gaps"


def _gaps(one: ImuReadings, name: str, values: Array) -> list[Problem]:
    gaps = runs(np.any(np.isnan(values), axis=1))
    if not gaps:
        return []
    start, end = max(gaps, key=lambda run: run[1] - run[0])
    text = (
        f"sensor {one.name}: the {name} has {_counted_gaps(len(gaps))}, the longest "
        f"{(end - start) / one.rate_hz:.3g} s at {one.time_s[start]:.2f} s; check the radio link or export "
        "again; the filter bridges them"
    )
    return [Problem(one.name, "gap", text, False)]


def _stuck(one: ImuReadings, name: str, values: Array) -> list[Problem]:
    least = max(5, round(STUCK_S * one.rate_hz))
    same = np.zeros(values.shape, dtype=bool)
    same[1:] = np.diff(values, axis=0) == 0.0
    found = []
    for axis in range(3):
        others = [k for k in range(3) if k != axis]
        moving = np.logical_not(np.all(same[:, others], axis=1))
        stuck = [(a, b) for a, b in runs(same[:, axis]) if b - a >= least and moving[a:b].mean() > _MOVING]
        if stuck:
            start, end = max(stuck, key=lambda run: run[1] - run[0])
            text = (
                f"sensor {one.name}: axis {'xyz'[axis]} of the {name} is stuck at {values[start, axis]:.4g} "
                f"for {(end - start) / one.rate_hz:.3g} s from {one.time_s[start]:.2f} s; blank those cells or replace "
                "the sensor"
            )
            found.append(Problem(one.name, "stuck", text, True))
    return found


def _clips_softly(one: ImuReadings, limit: SoftLimit) -> Problem:
    count = int(limit.reached.sum())
    text = (
        f"sensor {one.name}: axis {'xyz'[limit.axis]} of the gyroscope clips softly at "
        f"{limit.limit_rad_s / _DEGREE:.4g} deg/s in {count} samples ({count / one.samples:.1%}; first at "
        f"{one.time_s[int(np.argmax(limit.reached))]:.2f} s); record with a wider range. "
        "Stated spreads of orientations and strides are widened"
    )
    return Problem(one.name, "saturated", text, False)


def _saturated(one: ImuReadings, name: str, values: Array) -> list[Problem]:
    # A reading that is held, on all axes, is one reading.
    fresh = np.concatenate([[True], np.any(np.diff(values, axis=0) != 0.0, axis=1)])
    values, times = values[fresh], one.time_s[fresh]
    found = []
    for axis in range(3):
        series = values[:, axis]
        for limit in (np.nanmax(series), np.nanmin(series)):
            full = runs(series == limit)
            count, longest = sum(b - a for a, b in full), max(b - a for a, b in full)
            often = count >= SATURATED_SAMPLES and (longest > 1 or count >= _SCATTERED)
            if not often or abs(limit) < _LEAST_RANGES[name]:
                continue
            if any(b - a >= STUCK_S * one.rate_hz for a, b in full):
                continue  # a stuck axis, reported elsewhere
            share = sum(b - a for a, b in full)
            unit, size = ("deg/s", limit / _DEGREE) if name == "gyroscope" else ("g", limit / GRAVITY_M_S2)
            text = (
                f"sensor {one.name}: axis {'xyz'[axis]} of the {name} is saturated at {size:.4g} {unit} in "
                f"{share} samples (first at {times[full[0][0]]:.2f} s); record with a wider range, angles after a "
                "clipped turn are off"
            )
            found.append(Problem(one.name, "saturated", text, False))
    return found


def _force_unit(one: ImuReadings) -> list[Problem]:
    # Most samples of a trunk read about 1 g, and of a foot those while it stands and turns least: the better counts.
    force = np.sqrt((one.specific_force_mps2**2).sum(axis=1))
    turning = np.nan_to_num((one.angular_velocity_rad_s**2).sum(axis=1))
    calmest = turning <= np.quantile(turning, _CALMEST)
    sizes = [float(np.nanmedian(values)) for values in (force, force[calmest]) if np.isfinite(values).any()]
    if not sizes:
        return []
    size = min(sizes, key=lambda one_size: abs(np.log(max(one_size, 1e-9) / GRAVITY_M_S2)))
    if 0.75 * GRAVITY_M_S2 < size < 1.4 * GRAVITY_M_S2:
        return []
    ratio = size / GRAVITY_M_S2
    hint = "check its unit and scale"
    if 0.75 / GRAVITY_M_S2 < ratio < 1.4 / GRAVITY_M_S2:
        hint = "it is in g: read it with --units acc=g"
    elif 750.0 / GRAVITY_M_S2 < ratio < 1400.0 / GRAVITY_M_S2:
        hint = "it is in mg: read it with --units acc=mg"
    elif 0.75 * GRAVITY_M_S2 < ratio < 1.4 * GRAVITY_M_S2:
        hint = "it is already in m/s²: read it with --units acc=m/s2"
    elif ratio < 0.2:
        hint = "gravity was taken away: export the raw acceleration, not the free one"
    text = f"sensor {one.name}: the specific force is usually {size:.3g} m/s² instead of 9.8; {hint}"
    # A runner's foot reads more than 3 g in the middle of its samples, and every size within a step.
    running = ratio < 4.0 and float(np.nanstd(force)) > BUSY_SHARE * size
    short_and_busy = hint.startswith("check") and ratio > 0.5 and (ratio < 2.0 or running)
    return [Problem(one.name, "unit", text, not short_and_busy)]


def _turning(one: ImuReadings) -> list[Problem]:
    """Turned into a fixed frame by the gyroscope, the specific force averages to 1 g over some seconds.

    A body part does not accelerate for long, so that gravity remains if the gyroscope is right. Each scale of a wrong
    unit or sign is tried; the best one is reported if the stated one is clearly worse.
    """
    windows = _windows(one)
    if windows is None:
        return []
    rates, force = windows
    off = {s: abs(mean_force(s / one.rate_hz * rates, force) / GRAVITY_M_S2 - 1.0) for s in _SCALES}
    best = min(off, key=lambda scale: off[scale])
    fast = float(np.sqrt((rates**2).sum(axis=2).mean())) > _FAST_RAD_S
    if best == 1.0 or off[1.0] - off[best] < _CLEARLY or (best == _DEGREE and not fast):
        return []
    kind: Literal["sign", "unit"] = "sign" if best < 0.0 else "unit"
    return [Problem(one.name, kind, f"sensor {one.name}: the gyroscope {_SCALES[best]}", True)]


def _windows(one: ImuReadings) -> tuple[Array, Array] | None:
    """Rates and forces (W, L, 3) of the stretches in which the gyroscope reads most."""
    length = round(_WINDOW_S * one.rate_hz)
    starts = np.arange(0, one.samples - length + 1, max(1, length // 2))
    if length < 10 or not len(starts):
        return None
    at = starts[:, None] + np.arange(length)
    rates, force = one.angular_velocity_rad_s[at], one.specific_force_mps2[at]
    whole = np.flatnonzero(np.isfinite(rates).all(axis=(1, 2)) & np.isfinite(force).all(axis=(1, 2)))
    busy = (rates[whole] ** 2).sum(axis=(1, 2))
    most = whole[np.argsort(busy)[-max(_MOST_WINDOWS // 4, len(busy) // 2) :][-_MOST_WINDOWS:]]
    return (rates[most], force[most]) if len(most) else None
