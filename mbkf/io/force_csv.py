"""Delimited tables of ground reactions with named columns: exports of Motive's and other programs' force plates.

Lines with settings may stand first; the first line whose cells name a force (:mod:`mbkf.io.force_names`) is the line
of titles, and a line of units may follow. Time comes from a column of times, from frames and sub frames, or from a
sample rate among the settings. A table whose file name ends in the kinds of its columns needs no titles:
``walk_F1Cop1F2Cop2.csv`` holds time, force and centre of pressure of two plates.

A plate without a centre of pressure is read with its corners, which stand among the settings, one a line: a cell with
the word Corner, then x, y and z. Its force and moment are then in the plate's axes, z down. That is how Motive stores
plates (NatNet SDK, description of force plates).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import METRES_PER_UNIT, UNIT_SPELLINGS
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_names import ForceSet, force_column, force_sets
from mbkf.io.force_table import ForceTable, plates_of_table
from mbkf.io.numbered_files import numbered_files
from mbkf.io.plate_table import PlateTable, faced_axes, plates_with_corners
from mbkf.io.records import PlateReadings
from mbkf.io.text import (
    TextFile,
    check_order,
    csv_rows,
    even_rate,
    is_comment,
    number,
    numbers,
    read_text,
)

_MOST_HEADER_LINES = 60
_KINDS_IN_NAME = re.compile(r"(?:[A-Za-z]+\d+){2,}")
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d+(?:[eE][-+]?\d+)?$)")
_KIND = re.compile(r"([A-Za-z]+)(\d+)")
_NUMBERED = re.compile(r"(?P<trial>.*(?:plate|fp|amti|kistler|bertec)[ _#-]*)(?P<plate>\d+)", re.IGNORECASE)


@dataclass(frozen=True)
class _Titled:
    """A file's titles and where they stand.

    Attributes:
        titles: Cells of the line of titles.
        units: Cells of the line of units, empty where there is none.
        settings: Lines before the titles, as cells.
        start: Index of the first row.
    """

    titles: list[str]
    units: list[str]
    settings: list[list[str]]
    start: int


def read_forces_csv(path: str | Path, options: CaptureOptions) -> tuple[PlateReadings, ...]:
    """Ground reactions of a table with named columns, one set per plate or foot.

    Of files that hold one numbered plate each, those of the others beside it are read too. Without an axis in the
    options, the one that plates with corners face points up, else the one that carries the weight, else y.

    Raises:
        FileFormatError: A file is missing or broken, or states no names, times, points of application or corners.
        InvalidInput: A force, point or moment is not a number.
        UnknownName: No column follows a known naming.
    """
    path = Path(path)
    numbered = _NUMBERED.fullmatch(path.stem)
    plates: list[PlateReadings] = []
    cornered: list[PlateTable] = []
    for one in numbered_files(path, _NUMBERED, options.notes) if numbered else (path,):
        file = read_text(one, "a table of ground reactions")
        titled = _titled(file)
        table = _table(file, titled)
        sets = force_sets(table.names, table.path)
        corners = _corners(titled.settings)
        match = _NUMBERED.fullmatch(one.stem)
        if corners is not None and len(sets) == 1 and all(index is None for index in sets[0].point):
            cornered.append(_plate(table, sets[0], corners, match["plate"] if match else sets[0].name))
            continue
        found = plates_of_table(table, options)
        if match and len(found) == 1:
            found = (replace(found[0], name=match["plate"]),)
        plates += found
    if cornered:
        faced = [
            *faced_axes(cornered),
            "z",
        ]  # the last without usable corners, so that each plate is left out
        plates += plates_with_corners(cornered, options.up or faced[0], options)
    return tuple(plates)


def _cells(file: TextFile, index: int) -> list[str]:
    """Cells of a line: between tabs, else semicolons (with decimal commas), else commas, else blanks."""
    text = file.lines[index]
    delimiter = next((mark for mark in "\t;," if mark in text), None)
    if delimiter is None:
        return text.split()
    cells = [cell.strip() for cell in next(csv_rows([text], file.path, index + 1, delimiter))]
    return cells if delimiter == "," else [_DECIMAL_COMMA.sub(".", cell) for cell in cells]


def _titled(file: TextFile) -> _Titled:
    settings: list[list[str]] = []
    for index in range(min(len(file.lines), _MOST_HEADER_LINES)):
        cells = _cells(file, index)
        found = [column for cell in cells if (column := force_column(cell)) is not None]
        if {column.axis for column in found if column.quantity == "force"} == {0, 1, 2}:
            after = _cells(file, index + 1) if index + 1 < len(file.lines) else []
            units = after if any(after) and not any(number(cell) is not None for cell in after) else []
            return _Titled(cells, units, settings, index + (2 if units else 1))
        settings.append(cells)
    titles = _titles_of_name(file.path.stem)
    width = len(_cells(file, 0)) if file.lines else 0
    if titles and len(titles) == width:
        return _Titled(titles, [], [], 0)
    raise FileFormatError(file.path, "no line names the columns of a force (Fx, Fy, Fz …); give them names")


def _titles_of_name(stem: str) -> list[str]:
    """Titles of a table without any, from a file name such as ``walk_F1Cop1F2Cop2``; else empty."""
    last = stem.rpartition("_")[2]
    if not _KINDS_IN_NAME.fullmatch(last):
        return []
    titles = [f"{kind}{plate}{axis}" for kind, plate in _KIND.findall(last) for axis in "xyz"]
    columns = [force_column(title) for title in titles]
    return ["time", *titles] if all(column and column.quantity for column in columns) else []


def _table(file: TextFile, titled: _Titled) -> ForceTable:
    """The numbers below the titles, with their rate."""
    rows: list[list[float]] = []
    width = len(titled.titles)
    for line in range(titled.start + 1, len(file.lines) + 1):
        cells = _cells(file, line - 1)
        if is_comment(file.lines[line - 1]):
            continue
        if not any(cells):
            if rows:
                break  # another table may follow
            continue
        if any(cells[width:]):
            raise FileFormatError(
                file.path, f"{len(cells)} values for {width} columns; export it again", line
            )
        found = numbers(cells[:width], file.path, line)
        rows.append(found + [np.nan] * (width - len(found)))
    if not rows:
        raise FileFormatError(file.path, "cut short: no rows after the titles; export it again", titled.start)
    values = np.array(rows)
    names = [title.lower() for title in titled.titles]
    rate_hz, start_s = _timing(file.path, names, values, titled.settings)
    columns = [force_column(name) for name in titled.titles]
    kept = [i for i, column in enumerate(columns) if column is not None and not names[i].startswith("time")]
    metres, newton_metres = _units(titled, kept)
    return ForceTable(
        str(file.path),
        tuple(titled.titles[i] for i in kept),
        values[:, kept],
        rate_hz,
        start_s,
        metres,
        newton_metres,
        at_point=False,
        on_body=False,
    )


def _timing(path: Path, names: list[str], values: Array, settings: list[list[str]]) -> tuple[float, float]:
    """Sample rate in Hz and time of the first sample in s."""
    times = [i for i, name in enumerate(names) if "time" in name and "code" not in name]
    for index in times:
        column = values[:, index]
        if np.isfinite(column).all() and (np.diff(column) > 0.0).all():
            return even_rate(path, column), float(column[0])
        if names[index].startswith("time") and np.isfinite(column).all():
            check_order(path, column, "the time")
    rate_hz = _stated_rate(settings)
    if rate_hz is None:
        raise FileFormatError(path, "states neither times nor a sample rate; add a column of times")
    frames = [i for i, name in enumerate(names) if "frame" in name]
    if len(frames) < 2:
        return rate_hz, 0.0
    sub = values[:, frames[1]]
    counted = (values[:, frames[0]] - 1.0) * (sub.max() + 1.0) + sub
    check_order(path, counted, "the frame")
    return rate_hz, float(counted[0]) / rate_hz


def _stated_rate(settings: list[list[str]]) -> float | None:
    """A rate among the settings: a number after a cell that says so, or a number alone on its line."""
    for cells in settings:
        for name, value in pairwise(cells):
            rate = number(value)
            if rate is not None and rate > 0.0 and re.search(r"rate|frequency", name, re.IGNORECASE):
                return rate
    alone = [number(cells[0]) for cells in settings if cells and not any(cells[1:])]
    return next((value for value in alone if value is not None and value > 0.0), None)


def _units(titled: _Titled, kept: list[int]) -> tuple[float | None, float | None]:
    """Metres per unit of points and N m per unit of moments; None where the file does not state them."""
    found: dict[str, float] = {}
    for index in kept:
        column = force_column(titled.titles[index])
        text = titled.units[index] if index < len(titled.units) else ""
        text = text or " ".join(re.findall(r"[(\[]([^)\]]*)[)\]]", titled.titles[index]))
        if column is None or not text:
            continue
        word = re.sub(r"newtons?", "n", text.lower())
        lengths = [part for part in re.split(r"[^a-z]+", word) if part and part != "n"]
        length = lengths[0] if lengths else ""
        length = length.removeprefix("n") if column.quantity == "moment" else length
        length = UNIT_SPELLINGS.get(length, length)
        if column.quantity in {"moment", "point", None} and length in METRES_PER_UNIT:
            found.setdefault("moment" if column.quantity == "moment" else "point", METRES_PER_UNIT[length])
    return found.get("point"), found.get("moment")


def _corners(settings: list[list[str]]) -> Array | None:
    """(4, 3) corners in m that the settings state, or None."""
    rows = []
    for cells in settings:
        if cells and "corner" in cells[0].lower():
            values = [value for cell in cells[1:] if (value := number(cell)) is not None]
            rows += [values] if len(values) == 3 else []
    if len(rows) != 4:
        return None
    corners = np.array(rows)
    return corners if np.ptp(corners, axis=0).max() < 20.0 else corners * METRES_PER_UNIT["mm"]


def _plate(table: ForceTable, one: ForceSet, corners_m: Array, name: str) -> PlateTable:
    """A plate without a centre of pressure, whose channels are in its own axes."""
    if None in one.moment:
        raise FileFormatError(
            table.path, f"plate '{name}' has neither centre of pressure nor moments; export them"
        )
    moment = [index for index in one.moment if index is not None]
    return PlateTable(
        table.path,
        name,
        corners_m,
        table.values[:, list(one.force)],
        table.values[:, moment],
        None,
        table.rate_hz,
        table.start_time_s,
        in_plate_axes=True,
    )
