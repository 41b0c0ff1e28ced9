"""TRC files, OpenSim's text format of marker positions, read and written."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.atomic import replacing_text
from mbkf.io.axes import METRES_PER_UNIT, rotation_to_world, up_axis
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.labels import unique_labels, without_subject
from mbkf.io.marker_capture import StatedUnit, marker_capture
from mbkf.io.number_text import number_rows
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.text import TextFile, compare_count, compare_rate, number, numbers, read_text
from mbkf.io.written import MARK

_TITLES = (
    "DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units", "OrigDataRate", "OrigDataStartFrame",
    "OrigNumFrames",
)  # fmt: skip
_HEADER_LINES = 5
_UNEVEN = 0.25
"""Share of a frame by which times may be off, by rounding or by an inexact rate."""

_COLUMNS_BEFORE_MARKERS = 2
_ALIGNED = re.compile(r"\t+|\s{2,}")
_MOST_NAMED = 6


@dataclass(frozen=True)
class TrcHeader:
    """Third line of a TRC file.

    Attributes:
        rate_hz: DataRate in Hz.
        frames: NumFrames, None where it is not stated.
        markers: NumMarkers, None where it is not stated.
        unit: Units as written, "" where none is stated.
        shifted: The fields do not stand under their titles.
    """

    rate_hz: float
    frames: int | None
    markers: int | None
    unit: str
    shifted: bool


def read_trc(path: str | Path, options: CaptureOptions) -> Capture:
    """Markers of a TRC file at the header's rate; the Time column gives the time of the first frame.

    Blank cells, NaN and exact zeros are missing samples. The header's fields are found by their order, since
    some programs put extra tabs between them. Columns stand between tabs or blanks, numbers have decimal points or
    commas; lines that begin with # are comments. A subject's name before all names ("Anna:LASI") is taken off. Remarks
    name counts that disagree with the rows, rows that are cut short, points beyond the names, names that occur twice
    and another order of axes. TRC files do not state which axis points up; without an
    axis in the options it is OpenSim's y.

    Raises:
        FileFormatError: The file is missing or not a TRC file; names the line.
        InvalidInput: The markers cannot be in that unit.
        UnknownName: Unknown axis or unit.
    """
    path, up = Path(path), up_axis("y" if options.up is None else options.up)
    file = _file(path)
    header = _header(file)
    cells = _rows(file)
    names = _names(file.lines[3], cells.points)
    if not any(names):
        raise FileFormatError(path, "no marker is named", file.line(3))
    if cells.longest > 3 * len([name for name in names if name]) and cells.longest % 3:
        width = cells.longest + _COLUMNS_BEFORE_MARKERS
        raise FileFormatError(path, f"{width} columns; each point needs 3 beside frame and time")
    notes = []
    if header.shifted:
        notes.append("header line 3 is shifted against its titles; its fields were read in order")
    named = sum(bool(name) for name in names)
    if header.markers is not None and header.markers != named:
        notes.append(f"the header counts {header.markers} markers, {named} are named")
    cells = _without_cut_rows(cells, len(names), notes)
    labels = _labels(names, notes)
    times = cells.times_s
    values = cells.of(len(names))[:, :, _order_of_axes(file.lines[4], len(names), notes)]
    values = _with_gaps(path, times, values, header.rate_hz, notes)
    notes += compare_count(file, header.frames, len(values), "frames")
    if len(values) == len(times):
        notes += compare_rate(header.rate_hz, times)
    unit = StatedUnit("Units", header.unit, "mm", file.line(2)).of(path, options, notes)
    return marker_capture(path, labels, values, header.rate_hz, float(times[0]), up, unit, options, notes)


def _with_gaps(path: Path, times_s: Array, values: Array, rate_hz: float, notes: list[str]) -> Array:
    """The coordinates (T, M, 3) with frames of NaN where the Time column (T,) shows that rows are missing.

    Times are rounded and rates not exact, so that each step from row to row is counted for itself.

    Raises:
        FileFormatError: Times go back, or jump further than the trial is long.
    """
    with np.errstate(over="ignore"):  # times without end are refused as any other jump
        steps = np.diff(times_s) * rate_hz
    back = np.flatnonzero(steps < -_UNEVEN)
    if len(back):
        raise FileFormatError(path, f"in row {back[0] + 2}, the time goes back; export the file again")
    if not len(steps) or abs(float(np.median(steps)) - 1.0) > _UNEVEN:
        return values  # the header's rate is not that of the rows, on which there is a remark
    frames = np.concatenate([[0], np.cumsum(np.maximum(np.rint(np.minimum(steps, 1e9)), 1.0))]).astype(int)
    missing = int(frames[-1]) + 1 - len(values)
    if not missing:
        return values
    if missing > len(values) + rate_hz:
        row, jump_s = int(np.argmax(steps)) + 2, float(np.max(np.diff(times_s)))
        raise FileFormatError(path, f"in row {row}, the time jumps by {jump_s:g} s; export the file again")
    notes.append(f"rows of {missing} frames are missing by the Time column; they are gaps")
    whole = np.full((frames[-1] + 1, *values.shape[1:]), np.nan)
    whole[frames] = values
    return whole


def write_trc(markers: MarkerTrajectories, path: str | Path) -> None:
    """Writes marker positions as OpenSim reads them: y up, mm, missing samples as NaN; whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    values = markers.positions_m @ rotation_to_world("y") / METRES_PER_UNIT["mm"]
    rate, frames, count = repr(float(markers.rate_hz)), markers.frames, len(markers.names)
    table = values.reshape(frames, 3 * count)
    with replacing_text(path) as file:
        file.write(f"PathFileType\t4\t(X/Y/Z)\t{Path(path).name}\t{MARK}\n")
        file.write("\t".join(_TITLES) + "\n")
        file.write(f"{rate}\t{rate}\t{frames}\t{count}\tmm\t{rate}\t1\t{frames}\n")
        file.write("Frame#\tTime\t" + "\t\t\t".join(markers.names) + "\t\t\n")
        file.write("\t\t" + "\t".join(f"{axis}{i + 1}" for i in range(count) for axis in "XYZ") + "\n\n")
        numbered = np.column_stack([np.arange(1.0, frames + 1.0), markers.times_s, table])
        for lines in number_rows(numbered, [0, -8, *[-6] * (3 * count)]):
            file.write(lines.replace("nan", "NaN"))


def _file(path: Path) -> TextFile:
    file = read_text(path, "a TRC file").without_comments()
    if not file.lines or "pathfiletype" not in file.lines[0].lower():
        raise FileFormatError(path, "not a TRC file (it does not begin with PathFileType)", 1)
    if len(file.lines) <= _HEADER_LINES:
        raise FileFormatError(path, "cut short: no frames after the header; export it again", len(file.lines))
    return file


def _header(file: TextFile) -> TrcHeader:
    """The header's numbers in their order (DataRate, CameraRate, NumFrames, NumMarkers …) and its one word."""
    lines = file.lines
    words = lines[2].split()
    values = [value for word in words if (value := number(word)) is not None]
    unit = next((word for word in words if number(word) is None), "")
    if not values or not values[0] > 0.0:
        raise FileFormatError(
            file.path, "the header gives no DataRate; write it first in this line", file.line(2)
        )
    counts = [int(value) if value >= 0 and value == int(value) else None for value in values[2:4]]
    counts += [None] * (2 - len(counts))
    titles = [title.strip().lower() for title in lines[1].split("\t")]
    cells = [cell.strip() for cell in lines[2].split("\t")]
    column = titles.index("units") if "units" in titles else -1
    shifted = bool(unit) and (not 0 <= column < len(cells) or cells[column] != unit)
    return TrcHeader(values[0], counts[0], counts[1], unit, shifted)


@dataclass(frozen=True)
class _Rows:
    """Frames of a file: (T,) times in s and T lists of coordinates, without blank cells at their ends.

    ``lines`` are their lines in the file, ``widths`` their cells, ``tabs`` whether tabs stand between these.
    """

    path: Path
    times_s: Array
    rows: list[list[float]]
    lines: list[int]
    widths: list[int]
    tabs: bool

    @property
    def longest(self) -> int:
        """Coordinates in the longest row."""
        return max(len(row) for row in self.rows)

    @property
    def points(self) -> int:
        """Points that the longest row holds."""
        return -(-self.longest // 3)

    def of(self, count: int) -> Array:
        """(T, count, 3) coordinates, NaN where a cell is blank."""
        table = np.full((len(self.rows), 3 * count), np.nan)
        for cells, row in zip(table, self.rows, strict=True):
            cells[: len(row)] = row
        return table.reshape(len(table), count, 3)


def _rows(file: TextFile) -> _Rows:
    times, table, lines, widths, tabs = [], [], [], [], False
    body = [
        (index, text) for index, text in enumerate(file.lines[_HEADER_LINES:], _HEADER_LINES) if text.strip()
    ]
    indent = int(_indented([text for _, text in body]))
    for index, whole in body:
        text = whole[indent:]
        line = file.line(index)
        lines.append(line)
        tabs = tabs or "\t" in text
        cells = text.split("\t") if "\t" in text else text.split()
        widths.append(len(cells))
        row = numbers("\t".join(cells).rstrip().split("\t"), file.path, line)
        if len(row) < _COLUMNS_BEFORE_MARKERS or math.isnan(row[1]):
            raise FileFormatError(file.path, "the row has no time; export the file again", line)
        times.append(row[1])
        table.append(row[_COLUMNS_BEFORE_MARKERS:])
    if not table:
        raise FileFormatError(file.path, "no frames after the header; export it again", len(file.lines))
    if not file.whole and widths[-1] < widths[0]:
        raise FileFormatError(file.path, "cut short within a row; copy or export it again", len(file.lines))
    return _Rows(file.path, np.array(times), table, lines, widths, tabs)


def _indented(rows: Sequence[str]) -> bool:
    """True where every row begins with an empty cell, and the number of its frame stands in the second one."""
    seconds = [row.split("\t", 2)[1].strip() for row in rows if row.startswith("\t")]
    if len(seconds) < len(rows) or not all(text.isdecimal() for text in seconds):
        return False
    frames = [int(text) for text in seconds]
    return bool(frames) and frames == list(range(frames[0], frames[0] + len(frames)))


def _without_cut_rows(rows: _Rows, points: int, notes: list[str]) -> _Rows:
    """The frames, with all markers missing in short rows whose lacking columns are unknown; remarks on short rows.

    Between tabs, the last columns are the ones that a short row lacks; between blanks, any of them may be.
    """
    full = _COLUMNS_BEFORE_MARKERS + (3 * points if rows.tabs else rows.longest)
    short = [i for i, width in enumerate(rows.widths) if width < full]
    if not short:
        return rows
    first = short[0]
    place = f"line {rows.lines[first]} ({rows.widths[first]} of {full} columns)"
    found = (
        f"1 row ends early, in {place}"
        if len(short) == 1
        else f"{len(short)} rows end early, the first in {place}"
    )
    if rows.tabs:
        notes.append(f"{found}; markers of lacking columns are missing there")
        return rows
    notes.append(f"{found}; blanks do not show which columns are lacking, so all markers are missing there")
    unknown = frozenset(short)
    return replace(rows, rows=[[] if i in unknown else row for i, row in enumerate(rows.rows)])


def _names(line: str, points: int) -> list[str]:
    """Marker names in the order of the columns of so many points, "" for points without a name.

    Where every name stands over the first column of a point, its place counts; some programs put any number of
    tabs between names, which then follow one another.
    """
    cells = _title_cells(line, points)
    places = [i - _COLUMNS_BEFORE_MARKERS for i, cell in enumerate(cells) if cell][_COLUMNS_BEFORE_MARKERS:]
    names = [cell for cell in cells if cell][_COLUMNS_BEFORE_MARKERS:]
    in_place = all(place % 3 == 0 for place in places) and (not places or places[-1] // 3 < max(points, 1))
    if in_place and len(places) > 1:
        placed = [""] * (places[-1] // 3 + 1)
        for place, name in zip(places, names, strict=True):
            placed[place // 3] = name
        names = placed
    return names + [""] * (points - len(names))


def _title_cells(line: str, points: int) -> list[str]:
    """Cells of the line of names: between tabs, unless blanks align more of the names; those may hold single blanks."""
    count = points + _COLUMNS_BEFORE_MARKERS
    by_tabs = [cell.strip() for cell in line.split("\t")]
    frame_and_time, rest = (words := line.split(None, 2))[:2], words[2:]
    aligned = frame_and_time + [cell for text in rest for cell in _ALIGNED.split(text.strip()) if cell]
    tabbed = sum(bool(cell) for cell in by_tabs)
    if tabbed >= count or (tabbed > _COLUMNS_BEFORE_MARKERS and len(aligned) != count):
        return by_tabs
    return aligned if len(aligned) == count else line.split()


def _labels(names: list[str], notes: list[str]) -> tuple[str, ...]:
    """Names that occur once each, without the subject's; points without one are called by their number."""
    unnamed = [f"*{i}" for i, name in enumerate(names) if not name]
    if unnamed:
        listed = ", ".join(unnamed[:_MOST_NAMED])
        notes.append(f"{len(unnamed)} points have columns and no name; called by their number: {listed}")
    return tuple(unique_labels(without_subject([name or f"*{i}" for i, name in enumerate(names)]), notes))


def _order_of_axes(line: str, count: int, notes: list[str]) -> list[int]:
    """Columns of a point's x, y and z, by the fifth line (X1 Y1 Z1 …) where that is whole."""
    letters = [cell.strip()[0].upper() for cell in line.split() if cell.strip()[0].upper() in "XYZ"]
    triples = {"".join(letters[i : i + 3]) for i in range(0, len(letters), 3)}
    if len(letters) < 3 * count or len(triples) != 1 or sorted(triple := triples.pop()) != ["X", "Y", "Z"]:
        return [0, 1, 2]
    order = [triple.index(axis) for axis in "XYZ"]
    if order != [0, 1, 2]:
        notes.append(f"the columns of each marker are ordered {', '.join(triple)}; read by their titles")
    return order
