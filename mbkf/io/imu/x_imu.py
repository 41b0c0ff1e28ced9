"""x-io's first x-IMU: tables ``NAME_CalInertialAndMag.csv``, and ``NAME_Registers.csv`` with the sensor's settings.

A message's rate is stored as a power of two: 0 switches it off, n sends it at 2ⁿ⁻¹ Hz. The table of calibrated readings
counts packets of all messages and has no times.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.files_read import read_text
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import readings_of
from mbkf.io.imu.table import table_signals
from mbkf.io.imu.table_text import read_table_text

_ENDING, _SETTINGS = "_CalInertialAndMag.csv", "_Registers.csv"
_REGISTER = "InertialAndMagneticDataRate"
_MOST = 10
"""The largest value of the register, 512 Hz."""


def is_x_imu(path: Path) -> bool:
    """True for a table of calibrated readings, or a folder with one."""
    return bool(_tables(path)) if path.is_dir() else path.name.endswith(_ENDING)


def read_x_imu(
    path: Path, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """The sensor of a recording, named by the recording.

    Args:
        path: Its table of calibrated readings, or its folder.
        units: Units that overrule the table's.
        rate_hz: Sample rate; by default that of the register.

    Raises:
        FileFormatError: The folder holds several recordings, or a table is damaged.
        InvalidInput: The rate is not stated, since the file of registers is missing.
    """
    tables = _tables(path) if path.is_dir() else [path]
    if len(tables) > 1:
        names = ", ".join(one.name.removesuffix(_ENDING) for one in tables[:4])
        raise FileFormatError(path, f"{len(tables)} recordings ({names}); name the {_ENDING} of one of them")
    table = tables[0]
    name = table.name.removesuffix(_ENDING)
    rate = rate_hz or _stated_rate(table.with_name(name + _SETTINGS))
    if rate is None:
        raise InvalidInput(
            f"{table}: no column of times, and no {name}{_SETTINGS} beside it that states the rate; give it with --rate"
        )
    (one,) = readings_of(table, table_signals(read_table_text(table), units=units, rate_hz=rate), rate)
    return (replace(one, name=name),)


def _tables(folder: Path) -> list[Path]:
    return sorted(folder.glob(f"*{_ENDING}"))


def _stated_rate(registers: Path) -> float | None:
    """Rate of calibrated readings in Hz by a file of registers, None without the file or the register.

    Raises:
        FileFormatError: The register switches the readings off, or holds no rate.
    """
    if not registers.is_file():
        return None
    rows = csv.DictReader(read_text(registers).splitlines())
    found = next((row.get("Value") for row in rows if row.get("Name") == _REGISTER), None)
    if found is None:
        return None
    if not (found.isascii() and found.isdigit() and 1 <= int(found) <= _MOST):
        raise FileFormatError(
            registers,
            f"{_REGISTER} is {found}, which is not the rate of any reading; give the rate with --rate",
        )
    return float(2 ** (int(found) - 1))
