"""Ground reactions as OpenSim stores them: force, point of application and free torque per plate or foot.

The columns of one set are called after their plate or foot in one of these ways, with x, y, z each::

    ground_force_vx, ground_force_px, ground_torque_x              one set without a name
    1_ground_force_vx …, R_ground_force_vx …                        the name before
    ground_force_r_vx …, ground_torque_r_x                          the name within
    ground_force4_vx …, ground_torque4_x                            a number attached
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.axes import finite, rotation_to_world
from mbkf.io.records import PlateReadings
from mbkf.io.storage import Table, read_storage, write_storage
from mbkf.io.wrench import (
    DEFAULT_COP_THRESHOLD_N,
    centre_of_pressure,
    find_tare,
    remove_tare,
    require_finite,
)

UNNAMED_SET = "0"
"""Name of the set whose columns carry none; ``1_ground_force_vx`` is then the next."""

_FORCE_COLUMN = re.compile(r"(?P<before>.*?)_?ground_force_?(?P<within>\w*?)_?(?P<kind>[vp])x")
_AXES = "xyz"
_EVEN_TOLERANCE = 0.5
_LEAST_OFFSET_N = 2.0
_UP = np.array([0.0, 0.0, 1.0])


def read_forces_mot(
    path: str | Path, *, up: str = "y", cop_threshold_n: float = DEFAULT_COP_THRESHOLD_N, tare: bool = False
) -> tuple[PlateReadings, ...]:
    """Read ground reactions from a MOT (or STO) file.

    With p the point of application, F the force and T the free torque, the moment about the set's origin o is
    T + (p − o) × F. The origin is the mean centre of pressure while loaded.

    Args:
        path: The file, in m, N and N m.
        up: Axis of the file that points up; OpenSim has y.
        cop_threshold_n: Vertical force in N below which no centre of pressure is given.
        tare: Whether an offset of the unloaded set is removed, if it is 2 N or more; most exports have none,
            and the remainder of a low-pass filter is not one.

    Returns:
        One set of readings per plate or foot, in the order of the columns.

    Raises:
        FileFormatError: The file is missing or no table, columns of a set are missing, or the times are not
            evenly spaced.
        InvalidInput: A force, point or torque is not a number.
        UnknownName: No column follows a known naming; lists what was found.
    """
    table = read_storage(path)
    sets = _sets(path, table)
    rate_hz = _rate(Path(path), table.times_s)
    start_s = float(table.times_s[0])
    rotation = rotation_to_world(up)
    readings = []
    for name, columns_of_set in sets.items():
        force, point, torque = (_vectors(table, columns) @ rotation.T for columns in columns_of_set)
        loaded = force[:, 2] >= cop_threshold_n
        point[~loaded & ~finite(point)] = 0.0  # no force, so no point of application
        require_finite(np.hstack([force, point]), torque, rate_hz, start_s, f"{path}, set '{name}'")
        origin = point[loaded].mean(axis=0) if loaded.any() else np.zeros(3)
        wrench = np.hstack([force, torque + np.cross(point - origin, force)])
        pressure = np.where(loaded[:, None], point, np.nan)
        offset = np.zeros(6)
        found = find_tare(wrench, rate_hz) if tare else None
        if found is not None and abs(found.offset[2]) >= _LEAST_OFFSET_N:
            wrench, offset = remove_tare(wrench, found), found.offset
            pressure = centre_of_pressure(wrench[:, :3], wrench[:, 3:], origin, _UP, cop_threshold_n)
        readings.append(
            PlateReadings(
                name=name,
                rate_hz=rate_hz,
                start_time_s=start_s,
                origin_m=origin,
                force_n=wrench[:, :3],
                moment_nm=wrench[:, 3:],
                centre_of_pressure_m=pressure,
                threshold_n=cop_threshold_n,
                offset=offset,
            )
        )
    return tuple(readings)


def write_forces_mot(plates: Sequence[PlateReadings], path: str | Path) -> None:
    """Write ground reactions as OpenSim reads them: y up, m, N and N m, ``ground_force_{name}_vx`` ….

    The force acts at the centre of pressure with the free torque that remains there; where there is no centre
    of pressure it acts at the plate's origin with the whole moment.

    Args:
        plates: Readings of one time base.
        path: The file, replaced whole or not at all.

    Raises:
        InvalidInput: No plates, or their times differ.
        OSError: The file cannot be written.
    """
    if not plates:
        raise InvalidInput(f"{path}: no ground reactions to write")
    times = plates[0].times_s
    if any(len(plate.force_n) != len(times) or not np.allclose(plate.times_s, times) for plate in plates):
        raise InvalidInput(f"{path}: the plates have different times; bring them to one time base first")
    to_file = rotation_to_world("y")
    names: list[str] = []
    columns: list[Array] = []
    for plate in plates:
        given = finite(plate.centre_of_pressure_m)
        point = np.where(given[:, None], plate.centre_of_pressure_m, plate.origin_m)
        torque = plate.moment_nm - np.cross(point - plate.origin_m, plate.force_n)
        names += [f"ground_force_{plate.name}_{kind}{axis}" for kind in "vp" for axis in _AXES]
        names += [f"ground_torque_{plate.name}_{axis}" for axis in _AXES]
        columns += [vectors @ to_file for vectors in (plate.force_n, point, torque)]
    threshold = f"{plates[0].threshold_n:g}"
    header = {"units": "m, N and N m", "centre_of_pressure_threshold_n": threshold}
    title = Path(path).stem
    write_storage(Table(tuple(names), times, np.hstack(columns), False, title, header), path)


def _sets(path: str | Path, table: Table) -> dict[str, tuple[list[str], list[str], list[str]]]:
    """Name of each set → its force, point and torque columns."""
    known = {name.lower(): name for name in table.names}
    sets = {}
    for column in table.names:
        match = _FORCE_COLUMN.fullmatch(column.lower())
        if match is None or match["kind"] != "v":
            continue
        stem = column[: -len("vx")]
        torque = re.sub("ground_force", "ground_torque", stem, flags=re.IGNORECASE)
        wanted = [[f"{prefix}{axis}" for axis in _AXES] for prefix in (f"{stem}v", f"{stem}p", torque)]
        missing = [name for group in wanted for name in group if name.lower() not in known]
        if missing:
            raise FileFormatError(path, f"column {missing[0]} of the set of {column} is missing; add it")
        force, point, moment = ([known[name.lower()] for name in group] for group in wanted)
        label = match["before"] or match["within"] or UNNAMED_SET
        sets[label.lower()] = (force, point, moment)
    if not sets:
        raise UnknownName(
            "ground reaction columns",
            ", ".join(table.names[:6]),
            ("ground_force_r_vx", "1_ground_force_vx", "ground_force1_vx"),
            str(path),
        )
    return sets


def _vectors(table: Table, columns: list[str]) -> Array:
    """(T, 3) values of three columns."""
    return np.column_stack([table.column(name) for name in columns])


def _rate(path: Path, times: Array) -> float:
    """Sample rate of evenly spaced times (rounded ones count as even)."""
    if len(times) < 2 or times[-1] <= times[0]:
        raise FileFormatError(path, "the time column does not increase; export the file again")
    rate_hz = (len(times) - 1) / (times[-1] - times[0])
    off = np.abs((times - times[0]) * rate_hz - np.arange(len(times)))
    if off.max() > _EVEN_TOLERANCE:
        worst = times[int(np.argmax(off))]
        raise FileFormatError(path, f"times are not evenly spaced near {worst:.4f} s; resample them first")
    return round(rate_hz, 6)
