"""CSV tables of inertial readings and of orientations, with units in the column names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.atomic import replacing_text
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.written import MARK

_PARTS = (
    ("specific_force_mps2", "acc", "m/s^2"),
    ("angular_velocity_rad_s", "gyr", "rad/s"),
    ("magnetic_field", "mag", "uT"),
)
_DEGREES = 180.0 / np.pi


def write_imu_csv(readings: Sequence[ImuReadings], path: str | Path) -> None:
    """Writes sensors sampled together as :func:`mbkf.io.imu.table.read_imu_csv` reads them; missing samples are blank.

    Raises:
        InvalidInput: The sensors were not sampled at the same times.
        OSError: The file cannot be written.
    """
    times = readings[0].time_s
    names, columns = ["time [s]"], [times]
    for one in readings:
        if one.samples != len(times) or not np.allclose(one.time_s, times, atol=1e-9):
            raise InvalidInput(
                f"sensor {one.name} was not sampled with {readings[0].name}; write a file of its own"
            )
        for field, kind, unit in _PARTS:
            values = getattr(one, field)
            if values is not None:
                names += [f"{one.name} {kind}_{axis} [{unit}]" for axis in "xyz"]
                columns += list(values.T)
        if one.orientation is not None:
            names += [f"{one.name} quat_{axis}" for axis in "xyzw"]
            columns += list(one.orientation.T)
    frames = {one.frame for one in readings if one.orientation is not None}
    _write(
        path,
        [f"# {MARK}", *(f"# orientation: {frame}" for frame in sorted(frames))],
        names,
        np.column_stack(columns),
    )


def write_orientation_csv(
    path: str | Path,
    time_s: Array,
    quaternion: Array,
    euler_rad: Array,
    gyro_bias_rad_s: Array,
    sd_rad: Array | None,
    note: str,
) -> None:
    """Writes the course of one sensor: quaternion, unwrapped Euler angles in degrees, bias, standard deviations.

    Args:
        path: The file.
        time_s: (T,) sample times, s.
        quaternion: (T, 4) orientations sensor → world (x, y, z, w).
        euler_rad: (T, 3) roll, pitch and yaw, unwrapped.
        gyro_bias_rad_s: (T, 3) bias of the gyroscope.
        sd_rad: (T, 3) standard deviations about north, west and up; None where unknown.
        note: First line of the file.

    Raises:
        OSError: The file cannot be written.
    """
    names = ["time [s]", "qx", "qy", "qz", "qw", "roll [deg]", "pitch [deg]", "yaw [deg]"]
    names += [f"gyro_bias_{axis} [deg/s]" for axis in "xyz"]
    parts = [time_s[:, None], quaternion, _DEGREES * euler_rad, _DEGREES * gyro_bias_rad_s]
    if sd_rad is not None:
        names += [f"sd_{axis} [deg]" for axis in ("north", "west", "up")]
        parts.append(_DEGREES * sd_rad)
    _write(path, [f"# {MARK}; {note}"], names, np.hstack(parts))


def write_difference_csv(
    path: str | Path, time_s: Array, quaternion: Array, components: Array, angles_rad: Array, note: str
) -> None:
    """Writes how an orientation of one sensor differs from another one, sample by sample.

    Args:
        path: The file.
        time_s: (T,) sample times, s.
        quaternion: (T, 4) the orientation compared with, sensor → world (x, y, z, w).
        components: (T, 4) differences of the quaternions' components.
        angles_rad: (T, 6) differences of roll, pitch and yaw; turn between the two, its heading and its inclination.
        note: First line of the file.

    Raises:
        OSError: The file cannot be written.
    """
    names = ["time [s]", "qx", "qy", "qz", "qw", *(f"difference_{axis}" for axis in ("qx", "qy", "qz", "qw"))]
    names += [
        f"difference_{name} [deg]" for name in ("roll", "pitch", "yaw", "total", "heading", "inclination")
    ]
    _write(
        path,
        [f"# {MARK}; {note}"],
        names,
        np.hstack([time_s[:, None], quaternion, components, _DEGREES * angles_rad]),
    )


def _write(path: str | Path, notes: Sequence[str], names: Sequence[str], table: Array) -> None:
    with replacing_text(path) as file:
        for line in (*notes, ",".join(names)):
            file.write(line + "\n")
        for row in table.tolist():
            file.write(",".join("" if math.isnan(value) else f"{value:.10g}" for value in row) + "\n")
