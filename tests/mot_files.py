"""Ground reactions as OpenSim's storage files, for tests that read them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.io.axes import finite, rotation_to_world
from mbkf.io.records import PlateReadings
from mbkf.io.storage import Table, write_storage


def write_forces_mot(plates: Sequence[PlateReadings], path: str | Path) -> None:
    """Writes ground reactions as OpenSim reads them: y up, m, N and N m, ``ground_force_{name}_vx`` …."""
    times = plates[0].times_s
    to_file = rotation_to_world("y")
    names: list[str] = []
    columns: list[Array] = []
    for plate in plates:
        given = finite(plate.centre_of_pressure_m)
        point = np.where(given[:, None], plate.centre_of_pressure_m, plate.origin_m)
        torque = plate.moment_nm - np.cross(point - plate.origin_m, plate.force_n)
        names += [f"ground_force_{plate.name}_{kind}{axis}" for kind in "vp" for axis in "xyz"]
        names += [f"ground_torque_{plate.name}_{axis}" for axis in "xyz"]
        columns += [vectors @ to_file for vectors in (plate.force_n, point, torque)]
    threshold = f"{plates[0].threshold_n:g}"
    header = {"units": "m, N and N m", "centre_of_pressure_threshold_n": threshold}
    title = Path(path).stem
    write_storage(Table(tuple(names), times, np.hstack(columns), False, title, header), path)
