"""CSV exports of Delsys's Trigno Discover: each channel is sampled at a rate of its own and begins at time zero.

Sensors span their channels in a row of their own. A channel's rate stands in its title (``ACC X (148Hz)``, version 1.4)
or in a row below (``148.1481 Hz``), or the channel has a column of times before it (``ACC X Time Series (s)``).
Accelerations are g and angular velocities deg/s, as later versions write in the titles.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import FileFormatError
from mbkf.io.files_read import opened, read_text
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of

_MARK, _LINE_BYTES = b"Trigno Discover", 1000
_CHANNEL = re.compile(r"(ACC|GYRO) ([XYZ])( Time Series)? \(", re.IGNORECASE)
_RATE = re.compile(r"(?<![\d.])(\d+(?:\.\d+)?) ?Hz", re.IGNORECASE)
_KINDS = {"ACC": ("acc", GRAVITY_M_S2), "GYRO": ("gyr", np.pi / 180.0)}
_MOST_HEADER_LINES = 20


def is_trigno_discover(path: Path) -> bool:
    """True for such an export."""
    with opened(path) as file:
        return _MARK in file.readline(_LINE_BYTES)


def read_trigno_discover(path: Path) -> tuple[ImuReadings, ...]:
    """The sensors of an export that have an accelerometer, by their names.

    Raises:
        FileFormatError: No channel of an accelerometer is in it, a channel states no rate, or a cell is not a number.
    """
    rows = [[cell.strip() for cell in line.split(",")] for line in read_text(path).splitlines()]
    head = next((k for k, row in enumerate(rows[:_MOST_HEADER_LINES]) if any(map(_CHANNEL.match, row))), None)
    if head is None or head < 2:
        raise FileFormatError(path, "no channels of an accelerometer (ACC X, ACC Y, ACC Z); export them, too")
    below = rows[head + 1] if head + 1 < len(rows) else []
    has_rates = any(map(_RATE.fullmatch, below))
    table = _numbers(path, rows[head + 1 + has_rates :], len(rows[head]), head + 2 + has_rates)
    channels = _channels(path, rows[head], below if has_rates else [], _sensors(rows[head - 2]), table)
    signals = []
    for sensor, kind in dict.fromkeys((sensor, kind) for sensor, kind, _ in channels):
        axes = [channels.get((sensor, kind, axis)) for axis in "XYZ"]
        if None in axes:
            raise FileFormatError(path, f"sensor '{sensor}' has {kind} of some axes only; export all axes")
        count = min(len(values) for times, values in filter(None, axes))
        name, factor = _KINDS[kind]
        values = np.column_stack([one[1][:count] for one in axes if one is not None])
        signals.append(Signal(sensor, name, next(filter(None, axes))[0][:count], factor * values))
    return readings_of(path, signals)


def _sensors(row: Sequence[str]) -> list[str]:
    """Name of the sensor of each column; two of one name are numbered."""
    names, last, starts = list[str](), "", list[str]()
    for cell in row:
        if cell:
            starts.append(cell)
            last = cell if starts.count(cell) == 1 else f"{cell} {starts.count(cell)}"
        names.append(last)
    return names


def _channels(
    path: Path, titles: Sequence[str], rates: Sequence[str], sensors: Sequence[str], table: Array
) -> dict[tuple[str, str, str], tuple[Array, Array]]:
    """Times and values of each channel up to its last cell, by sensor, quantity and axis; blanks before it are NaN."""
    found = {}
    for column, title in enumerate(titles):
        named = _CHANNEL.match(title)
        if named is None or named[3]:
            continue
        before = _CHANNEL.match(titles[column - 1]) if column else None
        is_timed = before is not None and before[3] is not None
        filled = np.flatnonzero(np.isfinite(table[:, column - 1 if is_timed else column]))
        rows = filled if is_timed else np.arange(filled[-1] + 1 if len(filled) else 0)
        values = table[rows, column]
        rate = _RATE.search(rates[column]) if column < len(rates) else _RATE.search(title)
        if is_timed:
            times = table[rows, column - 1]
        elif rate is not None and float(rate[1]) > 0.0:
            times = np.arange(len(values)) / float(rate[1])
        else:
            raise FileFormatError(path, f"channel '{title}' states no rate; export it again")
        sensor = sensors[min(column, len(sensors) - 1)]
        found[sensor, named[1].upper(), named[2].upper()] = (times, values)
    return found


def _numbers(path: Path, rows: Sequence[Sequence[str]], width: int, first: int) -> Array:
    """(T, width) numbers, NaN where blank."""
    table = np.full((len(rows), width), np.nan)
    for k, row in enumerate(rows):
        for column, cell in enumerate(row[:width]):
            if cell:
                try:
                    table[k, column] = float(cell)
                except ValueError as error:
                    raise FileFormatError(
                        path, f"'{cell}' is not a number; export it again", first + k
                    ) from error
    return table
