"""Ground reactions as OpenSim stores them: force, point of application and torque there per plate or foot.

:mod:`mbkf.io.force_names` tells how columns may be called.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.axes import finite, rotation_to_world
from mbkf.io.force_table import ForceTable, plates_of_table, up_of_table
from mbkf.io.records import PlateReadings
from mbkf.io.storage import Table, promised_rows, read_storage, write_storage
from mbkf.io.text import even_rate, number
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N

_AXES = "xyz"


def read_forces_mot(
    path: str | Path,
    *,
    up: str | None = "y",
    cop_threshold_n: float = DEFAULT_COP_THRESHOLD_N,
    tare: bool = False,
    until_s: float | None = None,
    notes: list[str] | None = None,
) -> tuple[PlateReadings, ...]:
    """Read ground reactions from a MOT (or STO) file.

    With p the point of application, F the force and T the free torque, the moment about the set's origin o is
    T + (p − o) × F. The origin is the mean centre of pressure while loaded.

    Args:
        path: The file, in m, N and N m.
        up: Axis of the file that points up; OpenSim has y. None for the one that carries the weight.
        cop_threshold_n: Vertical force in N below which no centre of pressure is given.
        tare: Whether an offset of the unloaded set is removed, if it is 2 N or more; most exports have none,
            and the remainder of a low-pass filter is not one.
        until_s: End of the trial in s. A file with fewer rows than it promises is whole if it lasts until then,
            or to the end of the range in its own header.
        notes: Receives what was completed, and a wrong count of rows.

    Returns:
        One set of readings per plate or foot, in the order of the columns.

    Raises:
        FileFormatError: The file is missing, no table or cut short, columns of a set are missing, or the times
            are not evenly spaced.
        InvalidInput: A force, point or torque is not a number.
        UnknownName: No column follows a known naming; lists what was found.
    """
    remarks = notes if notes is not None else []
    table = read_storage(path, check_rows=False)
    rate_hz = even_rate(Path(path), table.times_s)
    _check_rows(Path(path), table, rate_hz, until_s, remarks)
    forces = ForceTable(str(path), table.names, table.columns, rate_hz, float(table.times_s[0]))
    axis = up_of_table(forces, up, "y", remarks)
    return plates_of_table(forces, up=axis, threshold_n=cop_threshold_n, tare=tare, notes=remarks)


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


def _check_rows(path: Path, table: Table, rate_hz: float, until_s: float | None, notes: list[str]) -> None:
    """Compares the rows with those promised; fewer are enough where they last as long as they should."""
    promised, found = promised_rows(table), len(table.times_s)
    if promised is None or promised == found:
        return
    ends = [until_s] if until_s is not None else []
    stated = [number(word) for word in table.header.get("range", "").split()]
    ends += [end for end in stated[1:2] if end is not None]
    lasting = any(table.times_s[-1] + 1.5 / rate_hz >= end for end in ends)
    if promised > found and not lasting:
        reason = f"cut short: {promised} rows promised, {found} present"
        until = f", and they end at {table.times_s[-1]:.3f} s" if ends else ""
        raise FileFormatError(path, f"{reason}{until}; copy or export it again")
    notes.append(f"{path.name} promises {promised} rows and has {found}")
