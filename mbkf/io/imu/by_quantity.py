"""Recordings of one sensor in a folder or ZIP archive with a table for each quantity.

phyphox ("Accelerometer.csv", "Gyroscope.csv", columns "X (m/s^2)"), x-io's x-IMU3 ("Inertial.csv", "Magnetometer.csv",
"Quaternion.csv") and NGIMU ("sensors.csv", "quaternion.csv"), and other programs for telephones write so. The name of a
table is the quantity of columns that are called x, y and z only. A folder with a folder per sensor is a session.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_regular, read_bytes
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of
from mbkf.io.imu.table import table_signals
from mbkf.io.imu.table_defaults import TableDefaults
from mbkf.io.imu.table_text import read_table_text, split_table
from mbkf.io.text import decoded

_KINDS = {
    "inertial": "", "sensors": "", "imu": "", "rawdata": "",
    "accelerometer": "acc", "acceleration": "acc", "totalacceleration": "acc", "accelerationwithg": "acc",
    "gyroscope": "gyr", "gyro": "gyr", "angularvelocity": "gyr",
    "magnetometer": "mag", "magneticfield": "mag",
    "quaternion": "quat", "orientation": "quat", "attitude": "quat",
    "linearacceleration": "free", "linearaccelerometer": "free", "accelerationwithoutg": "free",
}  # fmt: skip
"""Quantity by a table's name, in lower case and letters only; "" where the columns name it."""

_FRAME = "orientation in the world of the maker's filter, z up"
_MOST_BYTES = 1 << 30


def is_by_quantity(path: Path) -> bool:
    """True for a folder or archive with such tables."""
    if path.is_dir():
        return any(_kind(one) is not None for one in path.glob("*.csv")) or bool(_sensor_folders(path))
    if not zipfile.is_zipfile(path):
        return False
    try:
        with zipfile.ZipFile(check_regular(path)) as archive:
            return any(_kind(Path(name)) is not None for name in archive.namelist() if name.endswith(".csv"))
    except (zipfile.BadZipFile, ValueError):
        return False


def read_by_quantity(
    path: Path, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """The sensor of a folder or archive, named as it is, or the sensors of a folder of such folders.

    Args:
        path: The folder or archive.
        units: Units that columns do not state.
        rate_hz: Sample rate of tables without times.

    Raises:
        FileFormatError: The accelerometer is missing, or a table is damaged.
        InvalidInput: A unit or the rate is not stated.
    """
    inner = _sensor_folders(path) if path.is_dir() else []
    if inner:
        return tuple(one for folder in inner for one in read_by_quantity(folder, units, rate_hz))
    signals: list[Signal] = []
    for name, kind, text in _tables(path):
        table = split_table(path / name, text)
        try:
            own = table_signals(table, units=units, rate_hz=rate_hz, defaults=TableDefaults({}, kind=kind))
        except FileFormatError as error:
            if kind in ("acc", "") or "accelerometer column" not in error.reason:
                raise
            continue  # pitch and roll, or another table that is not needed
        signals += own
    if not signals:
        raise FileFormatError(path, "no tables of an accelerometer (such as Accelerometer.csv) in it")
    found = readings_of(path, signals, rate_hz, _FRAME)
    return tuple(replace(one, name=path.stem) for one in found) if len(found) == 1 else found


def _kind(path: Path) -> str | None:
    return _KINDS.get(re.sub(r"[^a-z]", "", path.stem.lower()))


def _sensor_folders(path: Path) -> list[Path]:
    """Folders of sensors in a session's folder."""
    own = [one for one in sorted(path.iterdir()) if one.is_dir()]
    return [one for one in own if any(_kind(table) is not None for table in one.glob("*.csv"))]


def _tables(path: Path) -> Iterator[tuple[str, str, str]]:
    """Name, quantity and text of each table; accelerations without gravity come last."""
    if path.is_dir():
        names = [one for one in sorted(path.glob("*.csv")) if _kind(one) is not None]
        for one in sorted(names, key=lambda one: _kind(one) == "free"):
            read_table_text(one)  # so that an error names this file
            yield one.name, _kind(one) or "", decoded(read_bytes(one))
        return
    try:
        with zipfile.ZipFile(check_regular(path)) as archive:
            for entry in archive.infolist():
                kind = _kind(Path(entry.filename)) if entry.filename.endswith(".csv") else None
                if kind is not None and "/" not in entry.filename.removeprefix(f"{path.stem}/"):
                    if entry.file_size > _MOST_BYTES:
                        raise FileFormatError(path, f"'{entry.filename}' is larger than a recording can be")
                    yield entry.filename, kind, decoded(archive.read(entry))
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError, RuntimeError, EOFError) as error:
        raise FileFormatError(path, f"damaged ({error}); export it again") from error
