"""Movella DOT (formerly Xsens DOT): CSV files of its apps, one sensor each, whose columns state no units.

By its manual accelerations are m/s², angular velocities deg/s, fields in a unit of their own (about 1), quaternions
turn from the sensor to a world with z up, free acceleration stands in that world, and ``SampleTimeFine`` counts
microseconds in 32 bits.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import readings_of
from mbkf.io.imu.table import table_signals
from mbkf.io.imu.table_defaults import TableDefaults
from mbkf.io.imu.table_text import read_table_text

_MARKS = ("devicetag", "deviceid", "firmwareversion", "outputrate", "measurementmode", "syncstatus")
_FRAME = "Movella DOT; orientation in the world of the maker's filter, z up"
_DEFAULTS = TableDefaults({"acc": "m/s2", "gyr": "deg/s", "mag": "au", "time": "us"}, frame=_FRAME)


def is_movella_dot(path: Path) -> bool:
    """True for a text file of the app: its header names the device, and samples are counted."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        head = [line.strip().lower().replace(" ", "") for line, _ in zip(file, range(30), strict=False)]
    counted = any("packetcounter" in line and "sampletimefine" in line for line in head)
    return counted and any(line.startswith(_MARKS) for line in head)


def read_movella_dot(
    path: Path, units: Mapping[str, str] | None = None, rate_hz: float | None = None
) -> tuple[ImuReadings, ...]:
    """The sensor of a file, named by its tag.

    Args:
        path: The file.
        units: Units that overrule the manual's.
        rate_hz: Sample rate; by default that of the times.

    Raises:
        FileFormatError: The file has no accelerometer, or is damaged.
    """
    text = read_table_text(path)
    tags = (row[1] for _, row in text.rows[:30] if len(row) > 1 and row[0].rstrip(":").lower() == "devicetag")
    signals = table_signals(text, units=units, rate_hz=rate_hz, defaults=_DEFAULTS)
    (one,) = readings_of(path, signals, rate_hz, _FRAME)
    tag = next(tags, "")
    from dataclasses import replace

    return (replace(one, name=tag) if tag and not tag.isdigit() else one,)
