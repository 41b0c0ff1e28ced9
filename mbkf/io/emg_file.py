"""Electromyograms in files of their own: tables of Delsys, Noraxon, BTS and others, and OpenSim's storage files.

A table has columns of times and of channels below one another's names. EMGworks and Trigno Discover put a column of
times before each channel, or the channel's rate below or inside its title; Noraxon writes "Time,s" and "RT VLO,uV"; BTS
and Delsys state the rate in lines above ("Frequency: 1000", "Sampling frequency: 1925.93"). Channels are those whose
title, or the sensor's name in the row above it, names a muscle or EMG (:mod:`mbkf.io.muscle_names`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_input, read_bytes
from mbkf.io.imu.stated_rate import rate_above
from mbkf.io.imu.table_text import TableText, is_number, split_table
from mbkf.io.muscle_names import muscle_of
from mbkf.io.records import AnalogChannel
from mbkf.io.text import decoded, even_rate

SUFFIXES = (".csv", ".tsv", ".txt", ".sto", ".mot", ".emt")
"""Endings of such files."""

MOST_HEADER_ROWS = 4000
"""Rows above the samples: EMGworks writes one for each channel and setting."""

SAMPLES_IN_SIGHT = 3
"""Rows of numbers that end the header."""

_TIME = re.compile(
    r"(?:x|time|tiempo|tempo|zeit)(?:\.\d+)?\s*(?:[\[(,]?\s*(s|ms|sec|seconds)\s*[\])]?)?(?:\.\d+)?"
    r"|.*time series\s*[\[(](s|ms)[\])]",
    re.IGNORECASE,
)
_UNIT = re.compile(r"\s*(?:[\[(]\s*([^\])]*?)\s*[\])]|,\s*(\w+))\s*:?\s*$")
_HERTZ = re.compile(r"(\d+(?:\.\d+)?)\s*Hz", re.IGNORECASE)
_LABEL = re.compile(r"Label:\s*(.*?)\s+Sampling frequency:\s*([\d.]+).*?Unit:\s*(\S+)", re.IGNORECASE)
_MEASURE_UNIT = re.compile(r"Measure unit:[\s;,]*([^\s;,]+)", re.IGNORECASE)
_UNNAMED = re.compile(r"emg(_\d+)*")
"""Names that the word EMG and a number make."""

_INERTIAL_MODE = re.compile(r"\(IM\)")
"""Trigno's sensors with an inertial part have it in the titles of their EMG, too."""


@dataclass(frozen=True)
class EmgFile:
    """Channels of a file.

    Attributes:
        path: The file.
        channels: Its channels.
        starts_s: Time of the first sample of each by the file's own clock; None where it has no times.
        offset_s: Seconds to add to its times, as a comment "# offset: 0.25" states; 0 without.
    """

    path: Path
    channels: tuple[AnalogChannel, ...]
    starts_s: tuple[float | None, ...]
    offset_s: float = 0.0


@dataclass(frozen=True)
class _Header:
    """Rows above the samples: (row of titles, names of sensors and rates by column), and the first row of samples."""

    titles: Sequence[str]
    sensors: Sequence[str]
    rates: Sequence[str]
    head: int
    first: int


def read_emg(path: Path) -> EmgFile:
    """The electromyograms of a table.

    Args:
        path: CSV, TSV, TXT, EMT, STO or MOT.

    Raises:
        FileFormatError: The file is missing or damaged, names no muscle, or states neither times nor a rate.
    """
    check_input(path, "name a table of EMG")
    text = decoded(read_bytes(path))
    table = split_table(path, text.partition("endheader")[2].lstrip() if "endheader" in text else text)
    header = _header(table)
    above = [line for line in text.splitlines()[:MOST_HEADER_ROWS] if ":" in line]
    labels = {match[1]: (float(match[2]), match[3]) for match in map(_LABEL.match, above) if match}
    units = [match[1] for match in map(_MEASURE_UNIT.search, above) if match]
    values = _values(table, header)
    channels, starts = [], []
    for column, title in enumerate(header.titles):
        named = _name(title, header.sensors[column] if column < len(header.sensors) else "")
        if named is None or _TIME.fullmatch(title.strip()):
            continue
        rate, unit = labels.get(title.strip(), (0.0, ""))
        start, rate, samples = _sampled(table, header, values, column, rate)
        found = _UNIT.search(title)
        unit = unit or (found[1] or found[2] if found else "") or (units[0] if units else "")
        unit = "" if _HERTZ.fullmatch(unit) else unit
        channels.append(AnalogChannel(named, samples, unit, rate))
        starts.append(start)
    if not channels:
        listed = ", ".join(title for title in header.titles if title)[:200]
        raise FileFormatError(
            path,
            f"no column is named after a muscle or EMG: {listed}; name them such as 'R TIB ANT' or 'EMG soleus L'",
        )
    offsets = [float(match[1]) for match in map(_OFFSET.match, table.comments) if match]
    return EmgFile(path, tuple(channels), tuple(starts), offsets[0] if offsets else 0.0)


_OFFSET = re.compile(r"[#/%]+\s*offset(?:_s)?\s*[:=]\s*([-+]?\d+(?:\.\d+)?)", re.IGNORECASE)


def _header(table: TableText) -> _Header:
    """Titles above the first rows of numbers, and what stands around them.

    Raises:
        FileFormatError: No row of names stands above rows of numbers.
    """
    rows = [cells for _, cells in table.rows]
    for first in range(1, min(len(rows), MOST_HEADER_ROWS)):
        if all(_is_sample(row) for row in rows[first : first + SAMPLES_IN_SIGHT]):
            break
    else:
        raise FileFormatError(
            table.path, "no rows of numbers below a row of names; export the channels as a table"
        )
    head = first - 1
    rates: Sequence[str] = ()
    if head > 0 and any(_HERTZ.fullmatch(cell) for cell in rows[head]):
        rates, head = rows[head], head - 1
    width = len(rows[first])
    spans = [row for row in rows[max(0, head - 2) : head] if len(row) > 1 and len(row) <= width]
    sensors = _spread(spans[0], width) if spans else []
    return _Header(rows[head], sensors, rates, head, first)


def _is_sample(row: Sequence[str]) -> bool:
    """True for a row of numbers and blanks."""
    filled = [cell for cell in row if cell]
    return len(filled) > 1 and sum(map(is_number, filled)) > len(filled) // 2 and is_number(filled[0])


def _spread(row: Sequence[str], width: int) -> list[str]:
    """A row of names that span the cells to their right."""
    names, last = [], ""
    for cell in [*row, *[""] * (width - len(row))]:
        last = cell or last
        names.append(last)
    return names


def _name(title: str, sensor: str) -> str | None:
    """The name of a channel of EMG: of its title, or of its sensor where the title says EMG alone; None for others."""
    own = _INERTIAL_MODE.sub(" ", _UNIT.sub("", title)).strip()
    found = muscle_of(own)
    if found is None:
        return None
    sensor = _UNIT.sub("", sensor).strip()
    worn = muscle_of(sensor) if sensor and _UNNAMED.fullmatch(found.name) else None
    return own if worn is None or _UNNAMED.fullmatch(worn.name) else sensor


def _values(table: TableText, header: _Header) -> Array:
    """(S, C) numbers below the titles, NaN where a cell is blank.

    Raises:
        FileFormatError: A cell is no number; names the line.
    """
    values = np.full((len(table.rows) - header.first, len(header.titles)), np.nan)
    for k, (line, cells) in enumerate(table.rows[header.first :]):
        for column, cell in enumerate(cells[: len(header.titles)]):
            if cell:
                try:
                    values[k, column] = table.number(cell)
                except ValueError as error:
                    if _name(header.titles[column], "") is not None:
                        raise FileFormatError(
                            table.path, f"'{cell}' is not a number; export it again", line
                        ) from error
    return values


def _sampled(
    table: TableText, header: _Header, values: Array, column: int, stated_hz: float
) -> tuple[float | None, float, Array]:
    """Time of the first sample, rate, and samples of a channel up to its last one.

    Raises:
        FileFormatError: Neither times nor a rate is stated, or the times are not even.
    """
    last = np.flatnonzero(np.isfinite(values[:, column]))
    samples = values[: last[-1] + 1 if len(last) else 0, column]
    before = [k for k in range(column) if _TIME.fullmatch(header.titles[k].strip())]
    if before:
        times_s = values[: len(samples), before[-1]] * _seconds(header.titles[before[-1]])
        if len(times_s) and np.isfinite(times_s).all():
            return float(times_s[0]), even_rate(table.path, times_s), samples
    own = header.rates[column] if column < len(header.rates) else header.titles[column]
    hertz = _HERTZ.search(own)
    rate = stated_hz or (float(hertz[1]) if hertz else 0.0) or (rate_above(table, header.head) or 0.0)
    if not rate > 0.0:
        raise FileFormatError(
            table.path,
            f"channel '{header.titles[column]}' states neither times nor a rate; add a column of times, or the line "
            "'# sampling rate: 1000' at the top",
        )
    return None, rate, samples


def _seconds(title: str) -> float:
    """Seconds of a column's unit."""
    match = _TIME.fullmatch(title.strip())
    unit = (match[1] or match[2] or "s") if match else "s"
    return 1e-3 if unit.lower() == "ms" else 1.0
