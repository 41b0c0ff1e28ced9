"""Xsens text exports: one sensor per file, samples counted by packets, of which some are lost."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.imu import ImuReadings
from mbkf.io.loose_xml import read_loose_xml
from mbkf.io.text import number

COUNTER = "PacketCounter"
"""The column that every such file has."""

_COUNTER_TURN = 65536
_RATE = re.compile(r"update rate\s*:\s*([0-9.]+)\s*hz", re.IGNORECASE)
_MATRIX = tuple(f"Mat[{i}][{j}]" for i in (1, 2, 3) for j in (1, 2, 3))
_QUATERNION = ("Quat_q1", "Quat_q2", "Quat_q3", "Quat_q0")
_MOST_IN_ROTATION = 1.1
"""No entry of a rotation is larger, however it was rounded."""

_LOST_SHARE = 0.5


def is_xsens(path: Path) -> bool:
    """Whether a text file is such an export."""
    with path.open(encoding="utf-8", errors="replace") as file:
        return any(line.startswith(COUNTER) for line, _ in zip(file, range(30), strict=False))


def read_xsens(path: str | Path, rate_hz: float | None = None) -> ImuReadings:
    """Read one sensor; lost packets become missing samples.

    Accelerations are m/s², rates rad/s, fields in a unit of their own (about 1), orientations sensor → the world of
    the maker's filter (z up).

    Args:
        path: The file.
        rate_hz: Sample rate; by default the header's.

    Raises:
        FileFormatError: The file is missing or not such an export; names the line.
        InvalidInput: The rate is stated nowhere.
    """
    path = Path(path)
    if not path.is_file():
        raise FileFormatError(path, "no such file; name an Xsens text export")
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    head = next((k for k, line in enumerate(lines[:30]) if line.startswith(COUNTER)), None)
    if head is None:
        raise FileFormatError(path, f"not an Xsens text export (no column {COUNTER})")
    stated = next((number(m[1]) for line in lines[:head] if (m := _RATE.search(line))), None)
    rate = rate_hz or stated
    if rate is None or not rate > 0.0:
        raise InvalidInput(f"{path}: the header states no update rate; give it with --rate")
    names = [name.strip() for name in lines[head].split("\t")]
    table = _table(path, lines, head + 1, names)
    told = table[:, names.index(COUNTER)]
    if not (np.abs(told) < _COUNTER_TURN + 1).all():
        raise FileFormatError(path, f"{COUNTER} is no counter; export the file again")
    count = np.unwrap(told, period=_COUNTER_TURN).astype(int)
    row = count - count[0]
    if (np.diff(row) <= 0).any() or row[-1] + 1 > len(row) / _LOST_SHARE + 10:
        raise FileFormatError(path, f"{COUNTER} does not count up; export the file again")
    whole = np.full((row[-1] + 1, len(names)), np.nan)
    whole[row] = table

    def columns(wanted: Sequence[str]) -> Array | None:
        there = all(name in names for name in wanted)
        found = whole[:, [names.index(name) for name in wanted]] if there else None
        return None if found is None or np.isnan(found).all() else found

    force = columns(("Acc_X", "Acc_Y", "Acc_Z"))
    if force is None:
        raise FileFormatError(path, "no column Acc_X; export the calibrated accelerations too", head + 1)
    rates = columns(("Gyr_X", "Gyr_Y", "Gyr_Z"))
    return ImuReadings(
        path.stem,
        (count[0] + np.arange(len(whole))) / rate,
        force,
        np.full_like(force, np.nan) if rates is None else rates,
        columns(("Mag_X", "Mag_Y", "Mag_Z")),
        rate,
        "Xsens; orientation in the world of the maker's filter, z up",
        _orientation(columns(_MATRIX), columns(_QUATERNION)),
    )


def read_xsens_folder(folder: str | Path, rate_hz: float | None = None) -> tuple[ImuReadings, ...]:
    """All sensors of a folder over the packets that all of them cover.

    Sensors take the names of an OpenSense mapping (``*.xml``) where one lies beside them.

    Raises:
        FileFormatError: There is no export in the folder, or one is broken.
        InvalidInput: The sensors have no packet in common or differ in rate.
    """
    folder = Path(folder)
    files = [path for path in sorted(folder.glob("*.txt")) if is_xsens(path)]
    if not files:
        raise FileFormatError(folder, "no Xsens text exports (*.txt) in this folder")
    sensors = [read_xsens(path, rate_hz) for path in files]
    rates = {one.rate_hz for one in sensors}
    if len(rates) > 1:
        raise InvalidInput(
            f"{folder}: sensors have different rates {sorted(rates)} Hz; export them at one rate"
        )
    rate = rates.pop()
    first = max(round(one.time_s[0] * rate) for one in sensors)
    last = min(round(one.time_s[-1] * rate) for one in sensors)
    if last <= first:
        raise InvalidInput(f"{folder}: the sensors have no packet in common; export one trial only")
    names = _mapping(folder)
    return tuple(
        _named(_cut(one, first - round(one.time_s[0] * rate), last - first + 1), names) for one in sensors
    )


def _cut(one: ImuReadings, first: int, count: int) -> ImuReadings:
    part = slice(first, first + count)
    return replace(
        one,
        time_s=one.time_s[part] - one.time_s[first],
        specific_force_mps2=one.specific_force_mps2[part],
        angular_velocity_rad_s=one.angular_velocity_rad_s[part],
        magnetic_field=None if one.magnetic_field is None else one.magnetic_field[part],
        orientation=None if one.orientation is None else one.orientation[part],
    )


def _mapping(folder: Path) -> dict[str, str]:
    """End of a file's name → name in an OpenSense mapping."""
    found: dict[str, str] = {}
    for path in folder.glob("*.xml"):
        for sensor in read_loose_xml(path).every("ExperimentalSensor"):
            name = sensor.said("name_in_model")
            if name:
                found[sensor.name] = name.removesuffix("_imu")
    return found


def _named(one: ImuReadings, names: dict[str, str]) -> ImuReadings:
    known = next((name for ending, name in names.items() if ending and one.name.endswith(ending)), one.name)
    return replace(one, name=known)


def _table(path: Path, lines: Sequence[str], start: int, names: Sequence[str]) -> Array:
    rows = []
    for row, line in enumerate(lines[start:], start=start + 1):
        if not line.strip():
            continue
        cells = line.split("\t")
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
    if quaternion is not None:
        return quaternion
    if matrix is None:
        return None
    from scipy.spatial.transform import Rotation

    found = np.full((len(matrix), 4), np.nan)
    there = np.asarray((np.abs(matrix) <= _MOST_IN_ROTATION).all(axis=1))
    there &= np.asarray(np.linalg.det(np.where(there[:, None], matrix, 0.0).reshape(-1, 3, 3)) > 0.0)
    found[there] = Rotation.from_matrix(matrix[there].reshape(-1, 3, 3)).as_quat()
    return found
