"""Orientations that a file states, the maker's own or a reference, at the times and in the world of a filter's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.frames import FRAMES, change_frame
from mbkf.imu.orientation import Orientation
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, resampled
from mbkf.io.imu.table import read_orientation_csv

OWN = "file"
"""Word for the orientations in the sensors' own file."""

SAME_DURATION = 0.01
"""Share by which the durations of one recording by two clocks may differ."""

_TABLES = (".csv", ".tsv", ".txt")


def stated_orientations(
    sensors: Sequence[ImuReadings], frame: str, source: str | Path
) -> tuple[tuple[Orientation, ...], tuple[str, ...]]:
    """One orientation per sensor, and notes.

    Args:
        sensors: The sensors, on regular times.
        frame: World of the result: ENU, NED or NWU.
        source: :data:`OWN`, or a file with quaternions: a table, or a file that :func:`mbkf.io.imu.files.read_imu`
            reads. A table without times has one row per sample.

    Raises:
        FileFormatError: The file is missing, damaged, or without quaternions.
        InvalidInput: A sensor's file is without them, or sensor and file have no time in common.
        UnknownName: The file has no such sensor.
    """
    if str(source) == OWN:
        found = {one.name: (one.orientation, one.frame) for one in sensors}
    else:
        path = Path(source)
        signals, stated = _read(path, sensors[0].rate_hz)
        found = {one.name: (_at(one, _of(one.name, signals, len(sensors)), path), stated) for one in sensors}
    courses, unknown = [], []
    for one in sensors:
        turns, stated = found[one.name]
        if turns is None or not np.isfinite(turns).all(axis=1).any():
            raise InvalidInput(
                f"sensor {one.name}: the file brings no orientation; name a file that does with --compare FILE"
            )
        worlds = [name for name in FRAMES if name in stated]
        if len(worlds) != 1:
            unknown.append(one.name)
        turns = change_frame(turns, worlds[0], frame) if len(worlds) == 1 else turns
        nothing = np.full((one.samples, 3), np.nan)
        courses.append(Orientation(one.name, one.time_s, turns, frame, nothing, None, Path(source).name))
    if not unknown:
        return tuple(courses), ()
    note = f"{source} states no world of its quaternions ({', '.join(unknown)}); they are taken as those of {frame}"
    return tuple(courses), (note,)


def _read(path: Path, rate_hz: float) -> tuple[tuple[Signal, ...], str]:
    """The quaternions of each sensor of a file, and their world as it states it."""
    if path.suffix.lower() in _TABLES:
        return read_orientation_csv(path, rate_hz)
    sensors = [one for one in read_imu(path) if one.orientation is not None]
    signals = [
        Signal(one.name, "quat", one.time_s, one.orientation)
        for one in sensors
        if one.orientation is not None
    ]
    return tuple(signals), sensors[0].frame if sensors else ""


def _of(name: str, signals: Sequence[Signal], sensors: int) -> Signal | None:
    """The signal of a sensor by its name; of one sensor and one signal whatever their names."""
    if not signals or (len(signals) == 1 and sensors == 1):
        return signals[0] if signals else None
    known = {one.sensor: one for one in signals}
    if name not in known:
        raise UnknownName("sensor", name, known, "--compare")
    return known[name]


def _at(one: ImuReadings, signal: Signal | None, path: Path) -> Array | None:
    """(T, 4) unit quaternions at a sensor's samples: row by row for as many that last as long, else by time.

    Row by row, the moment from which each of two devices counts time does not matter.
    """
    if signal is None:
        return None
    lasting_s = float(np.ptp(one.time_s))
    alike = abs(float(np.ptp(signal.time_s)) - lasting_s) <= SAME_DURATION * lasting_s
    same = alike and len(signal.values) == one.samples
    turns = np.array(signal.values) if same else resampled(signal, one.time_s)
    if not np.isfinite(turns).all(axis=1).any():
        raise InvalidInput(
            f"sensor {one.name} lasts from {one.time_s[0]:.2f} to {one.time_s[-1]:.2f} s, its quaternions in "
            f"{path} from {signal.time_s[0]:.2f} to {signal.time_s[-1]:.2f} s; give files of one recording"
        )
    size = np.linalg.norm(turns, axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        unit: Array = np.where((size > 0.5) & (size < 2.0), turns / size, np.nan)
    return unit
