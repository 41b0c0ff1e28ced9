"""Signals of inertial sensors, each with times of its own, brought together as one record per sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import FileFormatError
from mbkf.io.imu.readings import ImuReadings, rate_of

_WIDTHS = {"acc": 3, "free": 3, "gyr": 3, "mag": 3, "quat": 4}
_LONGEST_GAP = 3.0
"""Samples that are interpolated across at most, in steps of the slower signal."""


@dataclass(frozen=True)
class Signal:
    """One quantity of one sensor.

    Attributes:
        sensor: The sensor.
        kind: "acc" m/s², "gyr" rad/s, "mag" µT, "quat" (x, y, z, w) sensor → world, or "free": acceleration without
            gravity in a world with z up, m/s².
        time_s: (T,) sample times, s.
        values: (T, 3 or 4) the readings.
    """

    sensor: str
    kind: str
    time_s: Array
    values: Array


def readings_of(
    path: Path, signals: Sequence[Signal], rate_hz: float | None = None, frame: str = ""
) -> tuple[ImuReadings, ...]:
    """One record per sensor, in the order in which sensors come first.

    The times are those of the accelerometer. Signals sampled otherwise are interpolated between their neighbours.
    Where there is no accelerometer, but an acceleration without gravity beside an orientation, specific force is
    R(t)ᵀ(a + g e_z).

    Args:
        path: The file, for messages and as the name of a sensor that has none.
        signals: The signals.
        rate_hz: Sample rate; by default that of the times.
        frame: World of the orientations.

    Raises:
        FileFormatError: A sensor has no accelerometer, or fewer than two samples.
        InvalidInput: Times do not increase.
    """
    names = dict.fromkeys(one.sensor for one in signals)
    found = []
    for name in names:
        own = {one.kind: one for one in reversed(signals) if one.sensor == name}
        if "acc" in own or {"free", "quat"} <= own.keys():
            found.append(_readings(path, name, own, rate_hz, frame))
    if not found:
        raise FileFormatError(path, _no_accelerometer({one.kind for one in signals}))
    return tuple(found)


def with_reference(signals: Sequence[Signal]) -> list[Signal]:
    """The signals, where the orientation of one that has nothing else becomes that of the only sensor beside it.

    So a reference by cameras stands in a table: under a name of its own.
    """
    kinds = dict[str, set[str]]()
    for one in signals:
        kinds.setdefault(one.sensor, set()).add(one.kind)
    sensors = [name for name, own in kinds.items() if "acc" in own]
    references = [name for name, own in kinds.items() if own == {"quat"}]
    if len(sensors) != 1 or len(references) != 1 or "quat" in kinds[sensors[0]]:
        return list(signals)
    return [replace(one, sensor=sensors[0]) if one.sensor == references[0] else one for one in signals]


def signal_width(kind: str) -> int:
    """Number of axes of a quantity."""
    return _WIDTHS[kind]


def _no_accelerometer(kinds: set[str]) -> str:
    if "free" in kinds:
        return (
            "its accelerations are without gravity and no orientation stands beside them; export the accelerometer's "
            "own readings (gravity included), or the quaternions too"
        )
    return "no accelerometer (such as columns acc_x, acc_y, acc_z [m/s^2]); export its readings, gravity included"


def _readings(
    path: Path, name: str, own: dict[str, Signal], rate_hz: float | None, frame: str
) -> ImuReadings:
    base = own.get("acc") or own["free"]
    time_s = base.time_s
    if len(time_s) < 2:
        raise FileFormatError(path, f"cut short: sensor '{name}' has {len(time_s)} samples")
    turn = None if "quat" not in own else _unit(resampled(own["quat"], time_s))
    force = base.values if base.kind == "acc" else _with_gravity(base.values, turn)
    nothing = np.full((len(time_s), 3), np.nan)
    return ImuReadings(
        name or path.stem,
        time_s,
        force,
        nothing if "gyr" not in own else resampled(own["gyr"], time_s),
        None if "mag" not in own else resampled(own["mag"], time_s),
        rate_hz or rate_of(time_s, str(path)),
        frame if turn is not None else "",
        turn,
    )


def resampled(signal: Signal, time_s: Array) -> Array:
    """(T, n) the signal at other times (T,), s: linear between samples, NaN in gaps and outside."""
    if len(signal.time_s) == len(time_s) and np.array_equal(signal.time_s, time_s):
        return signal.values
    there = np.isfinite(signal.time_s) & np.isfinite(signal.values).all(axis=1)
    known, values = signal.time_s[there], signal.values[there]
    out = np.full((len(time_s), values.shape[1]), np.nan)
    if len(known) < 2:
        return out
    if signal.kind == "quat":  # q and -q are one turn; neighbours shall not cancel
        flips = np.where(np.einsum("tk,tk->t", values[1:], values[:-1]) < 0.0, -1.0, 1.0)
        values = values * np.concatenate([[1.0], np.cumprod(flips)])[:, None]
    step = float(np.median(np.diff(known)))
    right = np.clip(np.searchsorted(known, time_s), 1, len(known) - 1)
    inside = (time_s >= known[0] - 0.5 * step) & (time_s <= known[-1] + 0.5 * step)
    inside &= known[right] - known[right - 1] <= _LONGEST_GAP * step
    for axis in range(values.shape[1]):
        out[inside, axis] = np.interp(time_s[inside], known, values[:, axis])
    return out


def _with_gravity(free: Array, turn: Array | None) -> Array:
    """(T, 3) specific force in the sensor's axes, of (T, 3) accelerations in a world with z up."""
    from scipy.spatial.transform import Rotation

    assert turn is not None
    force = np.full_like(free, np.nan)
    there = np.isfinite(turn).all(axis=1)
    force[there] = Rotation.from_quat(turn[there]).inv().apply(free[there] + [0.0, 0.0, GRAVITY_M_S2])
    return force


def _unit(turn: Array) -> Array:
    """(T, 4) unit quaternions; others are missing."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        size = np.linalg.norm(turn, axis=1, keepdims=True)
        return np.where((size > 0.5) & (size < 2.0), turn / size, np.nan)
