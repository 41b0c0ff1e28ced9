"""Text exports of Xsens's MT Manager: one sensor per file, samples counted by packets, of which some are lost.

Tabs, commas or semicolons stand between cells. Accelerations are m/s², angular velocities rad/s, fields in a unit of
their own (about 1), quaternions scalar first and matrices sensor → a world with z up, ``SampleTimeFine`` counts 0.1 ms.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.files_read import check_input, read_text
from mbkf.io.imu.clocks import on_one_clock
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of
from mbkf.io.loose_xml import read_loose_xml
from mbkf.io.text import number

TEXTS = (".txt", ".csv")
"""Endings of such files."""

COUNTERS = ("PacketCounter", "Counter")
"""The first column, by the program's version."""

_COUNTER_TURN = 65536
_RATE = re.compile(r"(?:update|sample|output) rate\s*:\s*([0-9.]+)\s*hz", re.IGNORECASE)
_MATRIX = tuple(f"Mat[{i}][{j}]" for i in (1, 2, 3) for j in (1, 2, 3))
_QUATERNIONS = (("Quat_q1", "Quat_q2", "Quat_q3", "Quat_q0"), ("Quat_X", "Quat_Y", "Quat_Z", "Quat_W"))
_SPELLED = {name.lower(): name for name in _QUATERNIONS[1]}
_FREE = ("FreeAcc_X", "FreeAcc_Y", "FreeAcc_Z"), ("FreeAcc_E", "FreeAcc_N", "FreeAcc_U")
_TICKS = "SampleTimeFine"
_TICK_S, _TICK_TURN = 1e-4, 2**32
_MOST_IN_ROTATION = 1.1
"""Largest entry of a rotation, however it was rounded."""

_LOST_SHARE = 0.5


def is_xsens(path: Path) -> bool:
    """True for a text file of such an export."""
    with path.open(encoding="utf-8", errors="replace") as file:
        return any(_names_columns(line) for line, _ in zip(file, range(30), strict=False))


def _names_columns(line: str) -> bool:
    """True for the row of names."""
    first = next(iter(_cells(line)), "")
    return first == COUNTERS[0] or (first == COUNTERS[1] and "acc_x" in line.lower())


def _cells(line: str) -> list[str]:
    """Cells of a line, cut by its most frequent delimiter."""
    delimiter = max("\t;,", key=line.count)
    return [cell.strip().strip('"') for cell in line.split(delimiter)]


def read_xsens(path: str | Path, rate_hz: float | None = None) -> ImuReadings:
    """Reads one sensor; lost packets become missing samples.

    The sample rate is the one given, else the header's, else that of ``SampleTimeFine``.

    Raises:
        FileFormatError: The file is missing or not such an export; names the line.
        InvalidInput: The rate is stated nowhere.
    """
    path = Path(path)
    check_input(path, "name an Xsens text export")
    lines = read_text(path, errors="replace").splitlines()
    head = next((k for k, line in enumerate(lines[:30]) if _names_columns(line)), None)
    if head is None:
        raise FileFormatError(path, f"not an Xsens text export (no column {COUNTERS[0]})")
    names = _cells(lines[head].rstrip())
    counter, names = names[0], [_SPELLED.get(name.lower(), name) for name in names]
    delimiter = max("\t;,", key=lines[head].count)
    table = _table(path, lines, head + 1, names, delimiter)
    stated = next((number(m[1]) for line in lines[:head] if (m := _RATE.search(line))), None)
    counted = table[:, 0]
    if not (np.abs(counted) < _COUNTER_TURN + 1).all():
        raise FileFormatError(path, f"{counter} does not count packets; export the file again")
    count = np.unwrap(counted, period=_COUNTER_TURN).astype(int)
    row = count - count[0]
    if (np.diff(row) <= 0).any() or row[-1] + 1 > len(row) / _LOST_SHARE + 10:
        raise FileFormatError(path, f"{counter} does not count up; export the file again")
    rate = rate_hz or stated or _rate_of_ticks(names, table, row)
    if rate is None or not rate > 0.0:
        raise InvalidInput(
            f"{path}: the header states no update rate, and {counter} counts packets without their times; "
            "give the rate with --rate"
        )
    whole = np.full((row[-1] + 1, len(names)), np.nan)
    whole[row] = table

    def columns(wanted: Sequence[str]) -> Array | None:
        there = all(name in names for name in wanted)
        found = whole[:, [names.index(name) for name in wanted]] if there else None
        return None if found is None or np.isnan(found).all() else found

    found = {
        "acc": columns(("Acc_X", "Acc_Y", "Acc_Z")),
        "free": next(filter(_is_there, map(columns, _FREE)), None),
        "gyr": columns(("Gyr_X", "Gyr_Y", "Gyr_Z")),
        "mag": columns(("Mag_X", "Mag_Y", "Mag_Z")),
        "quat": _orientation(columns(_MATRIX), next(filter(_is_there, map(columns, _QUATERNIONS)), None)),
    }
    if found["acc"] is None and (found["free"] is None or found["quat"] is None):
        raise FileFormatError(path, "no column Acc_X; export the calibrated accelerations too", head + 1)
    times = (count[0] + np.arange(len(whole))) / rate
    signals = [Signal("", kind, times, values) for kind, values in found.items() if values is not None]
    (one,) = readings_of(path, signals, rate, "Xsens; orientation in the world of the maker's filter, z up")
    return one


def _is_there(values: Array | None) -> bool:
    return values is not None


def _rate_of_ticks(names: Sequence[str], table: Array, row: Array) -> float | None:
    """Sample rate in Hz by the sensor's own clock, None where the file has no readings of it.

    Packets over the time between the first and the last one: single steps are rounded to a tick.

    Args:
        names: Of the columns.
        table: (T, C) the columns.
        row: (T,) number of each packet since the first.
    """
    if _TICKS not in names:
        return None
    ticks = table[:, names.index(_TICKS)]
    known = np.flatnonzero(np.isfinite(ticks))
    if len(known) < 2:
        return None
    lasted = np.diff(np.unwrap(ticks[known], period=_TICK_TURN))
    if not (lasted > 0.0).all():
        return None
    return float((row[known[-1]] - row[known[0]]) / (_TICK_S * lasted.sum()))


def read_xsens_folder(folder: str | Path, rate_hz: float | None = None) -> tuple[ImuReadings, ...]:
    """All sensors of a folder over the packets that all of them cover.

    Sensors take the names of an OpenSense mapping (``*.xml``) where one lies beside them.

    Raises:
        FileFormatError: The folder holds no export, or one is broken.
        InvalidInput: The sensors have no packet in common.
    """
    folder = Path(folder)
    files = [
        path
        for path in sorted(folder.iterdir())
        if path.is_file() and path.suffix.lower() in TEXTS and is_xsens(path)
    ]
    if not files:
        raise FileFormatError(folder, "no Xsens text exports (*.txt) in this folder")
    sensors = [read_xsens(path, rate_hz) for path in files]
    names = _opensense_names(folder)
    return on_one_clock([_named_by_ending(one, names) for one in sensors], from_zero=True)


def _opensense_names(folder: Path) -> dict[str, str]:
    """End of a file's name → the segment's name in an OpenSense mapping that lies in a folder."""
    found: dict[str, str] = {}
    for path in folder.glob("*.xml"):
        for sensor in read_loose_xml(path).every("ExperimentalSensor"):
            name = sensor.child_text("name_in_model")
            if name:
                found[sensor.name] = name.removesuffix("_imu")
    return found


def is_xsens_folder(folder: Path) -> bool:
    """True for a folder with such exports."""
    return any(path.suffix.lower() in TEXTS and is_xsens(path) for path in folder.iterdir() if path.is_file())


def _named_by_ending(one: ImuReadings, names: dict[str, str]) -> ImuReadings:
    known = next((name for ending, name in names.items() if ending and one.name.endswith(ending)), one.name)
    return replace(one, name=known)


def _table(path: Path, lines: Sequence[str], start: int, names: Sequence[str], delimiter: str) -> Array:
    rows = []
    for row, line in enumerate(lines[start:], start=start + 1):
        if not line.strip():
            continue
        cells = line.split(delimiter)
        if len(cells) < len(names):
            raise FileFormatError(path, f"{len(cells)} cells for {len(names)} columns; export it again", row)
        try:
            rows.append([float(cell) if cell.strip() else np.nan for cell in cells[: len(names)]])
        except ValueError as error:
            raise FileFormatError(path, f"not a number ({error})", row) from error
    if len(rows) < 2:
        raise FileFormatError(path, "cut short: no samples after the column names", start)
    return np.array(rows)


def _orientation(matrix: Array | None, quaternion: Array | None) -> Array | None:
    if quaternion is not None or matrix is None:
        return quaternion
    from scipy.spatial.transform import Rotation

    found = np.full((len(matrix), 4), np.nan)
    there = np.asarray((np.abs(matrix) <= _MOST_IN_ROTATION).all(axis=1))
    there &= np.asarray(np.linalg.det(np.where(there[:, None], matrix, 0.0).reshape(-1, 3, 3)) > 0.0)
    found[there] = Rotation.from_matrix(matrix[there].reshape(-1, 3, 3)).as_quat()
    return found
