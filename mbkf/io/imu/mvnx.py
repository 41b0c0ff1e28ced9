"""Xsens MVN's exchange files (.mvnx): XML whose frames hold the readings of every sensor of a suit.

The files hold orientations sensor → world (scalar first), accelerations without gravity in that world (z up, m/s²) and
fields in a unit of their own. Older ones also hold ``sensorAngularVelocity`` (rad/s, in the sensor's axes); newer ones
the angular velocity of each segment in the world, which a sensor that is fixed to the segment shares.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.files_read import check_input
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of

_FRAME = "Xsens MVN; orientation in the world of the maker's filter, z up"
_ORIENTATION, _FREE, _FIELD = "sensorOrientation", "sensorFreeAcceleration", "sensorMagneticField"
_TURNING, _SEGMENT_TURNING = "sensorAngularVelocity", "angularVelocity"
_WANTED = {_ORIENTATION: 4, _FREE: 3, _FIELD: 3, _TURNING: 3, _SEGMENT_TURNING: 3}


def read_mvnx(path: Path) -> tuple[ImuReadings, ...]:
    """The sensors of a file, named as the segments that carry them.

    Raises:
        FileFormatError: The file is missing or damaged, or holds no sensors' readings.
        InvalidInput: Its frame rate is impossible.
    """
    sensors, segments, rate_hz, rows, times = _parsed(path)
    if len(times) < 2:
        raise FileFormatError(path, "cut short: it has no frames of a movement; export it again")
    data = {tag: _array(path, tag, rows[tag], len(times)) for tag in _WANTED if rows[tag]}
    if _ORIENTATION not in data or _FREE not in data:
        raise FileFormatError(
            path, "no readings of sensors; export sensorFreeAcceleration and sensorOrientation from MVN, too"
        )
    signals = []
    for k, name in enumerate(sensors):
        wxyz = _own(path, data[_ORIENTATION], k, 4)
        turn = wxyz[:, [1, 2, 3, 0]]
        signals.append(Signal(name, "quat", times, turn))
        signals.append(Signal(name, "free", times, _own(path, data[_FREE], k, 3)))
        if _FIELD in data:
            signals.append(Signal(name, "mag", times, _own(path, data[_FIELD], k, 3)))
        if _TURNING in data:
            signals.append(Signal(name, "gyr", times, _own(path, data[_TURNING], k, 3)))
        elif _SEGMENT_TURNING in data and name in segments:
            world = _own(path, data[_SEGMENT_TURNING], segments.index(name), 3)
            signals.append(Signal(name, "gyr", times, _turned_back(turn, world)))
    return readings_of(path, signals, rate_hz, _FRAME)


def _parsed(
    path: Path,
) -> tuple[list[str], list[str], float, dict[str, list[str]], Array]:
    """Names of sensors and segments, rate, the texts of each quantity and the times of the frames."""
    check_input(path, "name an MVN file (.mvnx)")
    sensors, segments, rate = list[str](), list[str](), 0.0
    rows: dict[str, list[str]] = {tag: [] for tag in _WANTED}
    stamps: list[str] = []
    normal = True
    try:
        for event, element in ElementTree.iterparse(path, events=("start", "end")):
            tag = element.tag.rpartition("}")[2]
            if event == "start":
                if tag == "frame":
                    normal = element.get("type", "normal") == "normal"
                elif tag == "subject":
                    rate = float(element.get("frameRate", "0"))
                elif tag == "sensor":
                    sensors.append(element.get("label", f"sensor{len(sensors) + 1}"))
                elif tag == "segment":
                    segments.append(element.get("label", ""))
            elif tag == "frame":
                if normal:
                    stamps.append(element.get("time", ""))
                element.clear()
            elif normal and tag in rows:
                rows[tag].append(element.text or "")
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise FileFormatError(path, f"damaged or cut short ({error}); export it again") from error
    if not (np.isfinite(rate) and rate > 0.0):
        raise InvalidInput(f"{path}: its frame rate is {rate:g} Hz; export it again")
    return sensors, segments, rate, rows, _times(stamps, rate)


def _times(stamps: Sequence[str], rate_hz: float) -> Array:
    """(T,) s: by the frames' rate from the first one's time, since stamps are whole milliseconds."""
    first = float(stamps[0]) / 1e3 if stamps and stamps[0].strip().isdigit() else 0.0
    return first + np.arange(len(stamps)) / rate_hz


def _array(path: Path, tag: str, texts: Sequence[str], frames: int) -> Array:
    """(T, n) numbers of a quantity."""
    if len(texts) != frames:
        raise FileFormatError(path, f"{len(texts)} of {frames} frames have {tag}; export it again")
    try:
        rows = [np.array(text.split(), dtype=float) for text in texts]
        return np.stack(rows)
    except ValueError as error:
        raise FileFormatError(path, f"damaged: {tag} ({error}); export it again") from error


def _own(path: Path, data: Array, k: int, width: int) -> Array:
    """(T, width) part of the k-th sensor or segment."""
    part = data[:, width * k : width * (k + 1)]
    if part.shape[1] != width:
        raise FileFormatError(path, "its frames hold fewer sensors than it names; export it again")
    return part


def _turned_back(turn: Array, world: Array) -> Array:
    """(T, 3) vectors of the world in the sensor's axes."""
    with np.errstate(over="ignore"):
        sizes = np.linalg.norm(turn, axis=1)
    out = np.full_like(world, np.nan)
    there = np.isfinite(sizes) & (sizes > 0.5)
    out[there] = Rotation.from_quat(turn[there]).inv().apply(world[there])
    return out
