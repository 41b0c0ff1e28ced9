"""Motive's CSV exports: measured markers of a take.

The first line holds pairs of a name and a value (Format Version, Capture Frame Rate, Length Units …). Rows of titles
follow: kind of a column (Marker, Rigid Body, Bone …), its name, its ID, Position or Rotation; then a row Frame, Time,
X, Y, Z …, and the frames. Only positions of type Marker are measured; those of a rigid body's or a bone's markers
are where the solver expects them. Motive has y up unless the export chose other axes, which the file does not state.

Source: OptiTrack documentation, page Data Export: CSV (docs.optitrack.com).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import up_axis
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.imu.session import names_readings
from mbkf.io.labels import unique_labels, without_subject
from mbkf.io.marker_capture import StatedUnit, marker_capture
from mbkf.io.records import Capture
from mbkf.io.text import (
    TextFile,
    check_order,
    compare_count,
    compare_rate,
    csv_rows,
    number,
    numbers,
    read_text,
)

_MOST_HEADER_LINES = 20
_UNLABELLED = re.compile(r"(?:unlabeled|unlabelled)\W*(?P<number>\d+)", re.IGNORECASE)


@dataclass(frozen=True)
class _Take:
    """A take's header.

    Attributes:
        entries: Name in lower case → value, of the first line.
        titles: Rows of titles, the last one with Frame, Time, X, Y, Z ….
        start: Index of the first row of numbers.
    """

    entries: dict[str, str]
    titles: list[list[str]]
    start: int


def read_motive(path: str | Path, options: CaptureOptions) -> Capture:
    """Measured markers of a take; Motive's "Unlabeled 1189" becomes ``*1189``, a remark names other columns.

    Raises:
        FileFormatError: The file is missing, not of that kind, broken, or holds no measured markers.
        InvalidInput: The markers cannot be in that unit.
        UnknownName: Unknown axis or unit.
    """
    file = read_text(Path(path), "a CSV file of Motive")
    take = _take(file)
    notes: list[str] = []
    columns, names = _markers(file, take, notes)
    times, values = _rows(file, take, columns)
    rate_hz = _rate(file, take)
    notes += compare_count(file, _frames(take), len(times), "frames")
    notes += compare_rate(rate_hz, times)
    unit = StatedUnit("Length Units", take.entries.get("length units", ""), "m", 1)
    axis, start_s = up_axis(options.up or "y"), float(times[0])
    used_unit = unit.of(file.path, options, notes)
    return marker_capture(file.path, names, values, rate_hz, start_s, axis, used_unit, options, notes)


def _take(file: TextFile) -> _Take:
    first = next(csv_rows(file.lines[:1], file.path), [])
    if not first or first[0].strip().lower() != "format version":
        reason = "not an export of Motive (it does not begin with Format Version)"
        if names_readings(file.path):
            reason = (
                "its columns are readings of inertial sensors, not markers; mbkf imu orient and mbkf imu stride "
                "read them, mbkf reconstruct takes them with --imu"
            )
        raise FileFormatError(file.path, reason, 1)
    cells = [cell.strip() for cell in first]
    entries = {name.lower(): value for name, value in zip(cells[::2], cells[1::2], strict=False)}
    titles: list[list[str]] = []
    for index, row in enumerate(csv_rows(file.lines[1:_MOST_HEADER_LINES], file.path, 2), start=1):
        words = [cell.strip() for cell in row]
        if not any(words):
            continue
        titles.append(words)
        if words[0].lower() == "frame":
            return _Take(entries, titles, index + 1)
    raise FileFormatError(file.path, "no row of titles that begins with Frame; export it with its header")


def _markers(file: TextFile, take: _Take, notes: list[str]) -> tuple[list[list[int]], list[str]]:
    """Columns of each marker's x, y and z, and the markers' names."""
    axes = take.titles[-1]
    rows = [row + [""] * (len(axes) - len(row)) for row in take.titles[:-1]]
    kinds = next((row for row in rows if {"marker", "rigid body", "bone"} & {c.lower() for c in row}), None)
    if kinds is None or rows.index(kinds) + 1 == len(rows):
        raise FileFormatError(file.path, "no row states which columns are markers; export it with its header")
    labels = rows[rows.index(kinds) + 1]
    quantities = rows[-1]
    columns: list[list[int]] = []
    names: list[str] = []
    left_out: dict[str, None] = {}
    index = 1
    while index < len(axes):
        triple = [axis.lower() for axis in axes[index : index + 3]]
        kind = kinds[index].lower()
        if kind == "marker" and quantities[index].lower() == "position" and triple == ["x", "y", "z"]:
            columns.append([index, index + 1, index + 2])
            names.append(labels[index])
            index += 3
            continue
        if kind and kind not in {"marker", "type"}:
            left_out[kinds[index]] = None
        index += 1
    if not names:
        found = f"; it holds {', '.join(left_out)}" if left_out else ""
        raise FileFormatError(
            file.path, f"holds no measured markers{found}; export it with Markers switched on"
        )
    if left_out:
        notes.append(f"columns of {', '.join(left_out)} are solved, not measured, and left out")
    unlabelled = [_UNLABELLED.fullmatch(name) for name in names]
    names = [f"*{match['number']}" if match else name for match, name in zip(unlabelled, names, strict=True)]
    return columns, unique_labels(without_subject(names), notes)


def _rows(file: TextFile, take: _Take, columns: list[list[int]]) -> tuple[Array, Array]:
    """(T,) times in s and (T, M, 3) coordinates, NaN where a cell is blank."""
    titles = [title.lower() for title in take.titles[-1]]
    time = next(
        (i for i, title in enumerate(titles) if title.startswith("time") and title != "timecode"), None
    )
    if time is None:
        raise FileFormatError(file.path, "no column of times; export it with its header", take.start)
    wanted = [time, *(index for triple in columns for index in triple)]
    table, widths = [], []
    for line, row in enumerate(csv_rows(file.lines[take.start :], file.path, take.start + 1), take.start + 1):
        if not any(cell.strip() for cell in row):
            continue
        widths.append(len(row))
        cells = row + [""] * (len(titles) - len(row))
        found = numbers([cells[index] for index in wanted], file.path, line)
        if np.isnan(found[0]):
            raise FileFormatError(file.path, "the row has no time; export the file again", line)
        table.append(found)
    if not table:
        raise FileFormatError(file.path, "cut short: no frames after the titles", take.start)
    if not file.whole and widths[-1] < widths[0]:
        raise FileFormatError(file.path, "cut short within a row; copy or export it again", len(file.lines))
    values = np.array(table)
    check_order(file.path, values[:, 0], "the time")
    return values[:, 0], values[:, 1:].reshape(len(values), len(columns), 3)


def _rate(file: TextFile, take: _Take) -> float:
    for name in ("export frame rate", "capture frame rate"):
        rate = number(take.entries.get(name, ""))
        if rate is not None and rate > 0.0:
            return rate
    raise FileFormatError(file.path, "the header gives no Capture Frame Rate; export it with its header", 1)


def _frames(take: _Take) -> int | None:
    """Frames that the header promises."""
    count = number(take.entries.get("total exported frames", take.entries.get("total frames in take", "")))
    return None if count is None else int(count)
