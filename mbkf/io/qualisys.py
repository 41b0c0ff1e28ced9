"""Qualisys's TSV exports: trajectories in one file, each force plate in a file of its own beside it.

A file begins with lines of a name in capitals, a tab and its value (NO_OF_FRAMES, FREQUENCY, MARKER_NAMES …);
a line of column titles, then the rows. Frame and time stand before the values where they were exported. Lengths are
mm. The files of the plates are called after that of the trajectories, ``walk_f_1.tsv`` beside ``walk.tsv``, and hold
force, moment and centre of pressure, in plate axes (z down) or laboratory axes as their DESCRIPTION says, and the
corners of the plate. QTM shows forces on the plate, opposite to those on the body.

Source: Qualisys Track Manager, sections Motion data (.tsv) and Force data information of its manual
(docs.qualisys.com).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import METRES_PER_UNIT, length_unit, up_axis
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_names import force_sets
from mbkf.io.labels import unique_labels, without_subject
from mbkf.io.marker_capture import marker_capture
from mbkf.io.numbered_files import numbered_files, plate_files
from mbkf.io.plate_table import PlateTable, faced_axes, plates_with_corners
from mbkf.io.records import AxesSource, Capture, CaptureEvent, PlateReadings
from mbkf.io.text import TextFile, check_order, compare_count, compare_rate, number, numbers, read_text
from mbkf.io.wrench import offset_remarks

_KEY = re.compile(r"[A-Z][A-Z0-9_]+")
PLATE_FILE = re.compile(r"(?P<trial>.*)_f_(?P<plate>\d+)", re.IGNORECASE)
_QUADRANTS = ("POSX_POSY", "NEGX_POSY", "NEGX_NEGY", "POSX_NEGY")
_MM = METRES_PER_UNIT["mm"]


@dataclass(frozen=True)
class QualisysTable:
    """One TSV file.

    Attributes:
        file: Its lines.
        header: Entries, name → cells; the last one where a name occurs twice.
        events: Cells of the lines called EVENT.
        titles: Column titles, empty where there are none.
        values: (T, C) numbers, NaN where a cell is blank.
    """

    file: TextFile
    header: dict[str, list[str]]
    events: list[list[str]]
    titles: list[str]
    values: Array

    def number(self, name: str) -> float | None:
        """An entry of the header as a number, or None."""
        cells = self.header.get(name, [])
        return number(cells[0]) if cells else None

    def count(self, name: str) -> int | None:
        """An entry of the header as a whole number, or None."""
        value = self.number(name)
        return None if value is None else int(value)

    def rate_hz(self) -> float:
        """FREQUENCY.

        Raises:
            FileFormatError: It is missing, or not a number (an external time base).
        """
        rate = self.number("FREQUENCY")
        if rate is None or not rate > 0.0:
            raise FileFormatError(self.file.path, "FREQUENCY is not a rate in Hz; write it into the header")
        return rate


def read_qualisys(path: str | Path, options: CaptureOptions) -> Capture:
    """Markers, events and plates of a TSV file of trajectories and of the files of force plates beside it.

    A sample is missing where it is blank or exactly 0. Without options, lengths are mm, and the axis that the plates
    face points up, z where there are none.

    Raises:
        FileFormatError: The file is missing, not of that kind, or broken; or one of a plate is.
        InvalidInput: The markers cannot be in that unit, or a force is not a number.
        UnknownName: Unknown axis or unit.
    """
    path = Path(path)
    table = _table(path)
    if table.header.get("DATA_INCLUDED", ["3D"])[0].strip().upper() != "3D" or not _names(table):
        reason = "holds no trajectories (DATA_INCLUDED 3D, MARKER_NAMES); export 3D data"
        raise FileFormatError(path, reason)
    notes: list[str] = []
    names = unique_labels(without_subject(_names(table)), notes)
    times, values = _trajectories(table, len(names), notes)
    notes += compare_count(table.file, table.count("NO_OF_FRAMES"), len(values), "frames")
    stated = table.count("NO_OF_MARKERS")
    if stated is not None and stated != len(names):
        notes.append(f"the header counts {stated} markers, {len(names)} are named")
    rate_hz = table.rate_hz()
    if times is not None:
        notes += compare_rate(rate_hz, times)
    start_s = 0.0 if times is None else float(times[0])
    beside = plate_files(path, PLATE_FILE) if options.plates else ()
    tables = [_plate(one, notes) for one in beside]
    axis = _up(options.up, tables, notes)
    source = AxesSource.PLATES if tables else AxesSource.DEFAULT
    if beside:
        notes.append(f"ground reactions from {', '.join(one.name for one in beside)}")
    unit = length_unit(options.unit or "mm")
    capture = marker_capture(path, names, values, rate_hz, start_s, axis, unit, options, notes, source)
    readings = plates_with_corners(tables, axis, options, needs_one=False)
    notes = [*capture.notes, *options.notes, *offset_remarks(readings)]
    return replace(capture, plates=readings, events=_events(table), notes=tuple(notes))


def read_forces_qualisys(path: str | Path, options: CaptureOptions) -> tuple[PlateReadings, ...]:
    """The plate of a file, or those of a file of trajectories, and the trial's other plates, named by their numbers.

    Without an axis in the options, the one that the plates face points up.

    Raises:
        FileFormatError: A file is missing, not of that kind, or broken.
        InvalidInput: A force or moment is not a number.
        UnknownName: Unknown axis.
    """
    tables = [_plate(one, options.notes) for one in numbered_files(Path(path), PLATE_FILE, options.notes)]
    return plates_with_corners(tables, _up(options.up, tables, options.notes), options)


def _table(path: Path) -> QualisysTable:
    file = read_text(path, "a TSV file of Qualisys")
    header: dict[str, list[str]] = {}
    events: list[list[str]] = []
    titles: list[str] = []
    rows: list[tuple[int, list[str]]] = []
    for line, text in enumerate(file.lines, start=1):
        cells = [cell.strip() for cell in text.split("\t")]
        if not rows and not titles and _KEY.fullmatch(cells[0]) and not _is_titles(cells):
            header[cells[0]] = cells[1:]
            events += [cells[1:]] if cells[0] == "EVENT" else []
        elif not any(cells):
            continue
        elif not rows and not titles and any(cell and not _is_number(cell) for cell in cells):
            titles = cells
        else:
            rows.append((line, cells))
    if not {"NO_OF_FRAMES", "NO_OF_SAMPLES", "MARKER_NAMES"} & set(header):
        raise FileFormatError(
            path, "not a TSV file of Qualisys (no NO_OF_FRAMES or NO_OF_SAMPLES); export it with header", 1
        )
    if not rows:
        raise FileFormatError(path, "cut short: no rows after the header; export it again", len(file.lines))
    width = max(len(cells) - _blank_end(cells) for _, cells in rows)
    if not file.whole and len(rows[-1][1]) < len(rows[0][1]):
        raise FileFormatError(path, "cut short within a row; copy or export it again", rows[-1][0])
    values = np.full((len(rows), width), np.nan)
    for row, (line, cells) in zip(values, rows, strict=True):
        found = numbers(cells[:width], path, line)
        row[: len(found)] = found
    return QualisysTable(file, header, events, titles, values)


def _is_number(cell: str) -> bool:
    return number(cell) is not None or cell.lower() in {"nan", "null"}


def _is_titles(cells: list[str]) -> bool:
    """True for column titles in capitals (SAMPLE, TIME …), which are not entries of the header."""
    return cells[0] in {"SAMPLE", "FRAME", "TIME"}


def _blank_end(cells: list[str]) -> int:
    """Number of blank cells at the end."""
    return next((i for i, cell in enumerate(reversed(cells)) if cell), len(cells))


def _names(table: QualisysTable) -> list[str]:
    return [name for name in table.header.get("MARKER_NAMES", []) if name]


def _trajectories(table: QualisysTable, count: int, notes: list[str]) -> tuple[Array | None, Array]:
    """(T,) times where the rows state them, and (T, M, 3) coordinates."""
    width = table.values.shape[1]
    before = [title.lower() for title in table.titles[:2]] == ["frame", "time"] or (
        not table.titles and width == 3 * count + 2
    )
    first = 2 if before else 0
    if width > first + 3 * count:
        raise FileFormatError(
            table.file.path, f"{width} columns, but {count} markers need {first + 3 * count}; export it again"
        )
    values = np.full((len(table.values), 3 * count), np.nan)
    values[:, : width - first] = table.values[:, first:]
    times = table.values[:, 1] if before else None
    if times is not None and not np.isfinite(times).all():
        notes.append("rows without a time; times follow from FREQUENCY")
        times = None
    if times is not None:
        check_order(table.file.path, times, "the time")
    return times, values.reshape(len(values), count, 3)


def _events(table: QualisysTable) -> tuple[CaptureEvent, ...]:
    """Events: label, frame, time in s."""
    found = []
    for cells in table.events:
        time_s = number(cells[2]) if len(cells) > 2 else None
        if time_s is not None:
            found.append(CaptureEvent(cells[0], "", time_s))
    return tuple(sorted(found, key=lambda event: event.time_s))


def _plate(path: Path, notes: list[str]) -> PlateTable:
    """The rows and the corners of a plate."""
    table = _table(path)
    width = table.values.shape[1]
    if "NO_OF_SAMPLES" not in table.header or not (table.titles or width in {9, 11}):
        reason = "holds no force plate (NO_OF_SAMPLES and columns Force_X …); name another"
        raise FileFormatError(path, reason)
    notes += compare_count(table.file, table.count("NO_OF_SAMPLES"), len(table.values), "samples")
    titles = table.titles or [
        *(("SAMPLE", "TIME") if width == 11 else ()),
        *(f"{kind}_{axis}" for kind in ("Force", "Moment", "COP") for axis in "XYZ"),
    ]
    (columns,) = force_sets(titles[:width], str(path))
    if None in columns.moment:
        raise FileFormatError(path, "columns of the moment are missing; export the plate again")
    force, moment, point = (
        table.values[:, [index for index in group if index is not None]]
        for group in (columns.force, columns.moment, columns.point)
    )
    times = [i for i, title in enumerate(titles[:2]) if title.lower() == "time"]
    if times and np.isfinite(table.values[:, times[0]]).all():
        check_order(path, table.values[:, times[0]], "the time")
    match = PLATE_FILE.fullmatch(path.stem)
    return PlateTable(
        str(path),
        match["plate"] if match else (table.header.get("FORCE_PLATE_NAME") or ["1"])[0],
        _corners(table),
        force,
        moment,
        _MM * point if point.shape[1] == 3 else None,
        table.rate_hz(),
        float(table.values[0, times[0]]) if times else 0.0,
        _in_plate_axes(" ".join(table.header.get("DESCRIPTION", []))),
    )


def _in_plate_axes(description: str) -> bool | None:
    """True where DESCRIPTION names plate axes, False where it names the laboratory's; None otherwise."""
    words = description.lower()
    if "local" in words:
        return True
    return False if "world" in words or "lab" in words else None


def _corners(table: QualisysTable) -> Array:
    """(4, 3) corners in m, laboratory axes; NaN where they are not stated."""
    stated = [
        [table.number(f"FORCE_PLATE_CORNER_{quadrant}_{axis}") for axis in "XYZ"] for quadrant in _QUADRANTS
    ]
    return _MM * np.array([[np.nan if value is None else value for value in row] for row in stated])


def _up(given: str | None, plates: list[PlateTable], notes: list[str]) -> str:
    """The axis that points up: the one given, else the one all plates face, else z."""
    if given is not None:
        return up_axis(given)
    found = faced_axes(plates)
    if len(found) == 1:
        return found[0]
    notes.append("no plate shows which axis points up; taken as z (--up changes it)")
    return "z"
