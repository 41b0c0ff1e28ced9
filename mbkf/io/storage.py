"""OpenSim's text tables (MOT and STO): a header up to ``endheader``, a line of names, rows of numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError, ShapeError, UnknownName
from mbkf.io.atomic import replacing_text
from mbkf.io.number_text import number_rows
from mbkf.io.text import blank_separated, is_comment, read_text
from mbkf.io.written import MARK

_WRITTEN_BY_US = {
    "nrows",
    "ncolumns",
    "indegrees",
    "version",
    "datarows",
    "datacolumns",
    "range",
    "name",
    "source",
}
_MOST_DIGITS = 16
_MOST_HEADER_LINES = 500


@dataclass(frozen=True)
class Table:
    """A table over time.

    Attributes:
        names: C column names, without time.
        times_s: (T,) times in s.
        columns: (T, C) values, in the units of the file.
        in_degrees: Whether rotational columns are in degrees.
        title: First line of the file.
        header: Header entries, name → text.
    """

    names: tuple[str, ...]
    times_s: Array
    columns: Array
    in_degrees: bool = False
    title: str = ""
    header: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "times_s", read_only(self.times_s))
        object.__setattr__(self, "columns", read_only(self.columns))
        object.__setattr__(self, "header", MappingProxyType(dict(self.header)))
        expected = (len(self.times_s), len(self.names))
        if self.columns.shape != expected:
            raise ShapeError("columns", str(expected), self.columns.shape)

    def column(self, name: str) -> Array:
        """(T,) values of one column.

        Raises:
            UnknownName: The column does not exist.
        """
        if name not in self.names:
            raise UnknownName("column", name, self.names)
        return self.columns[:, self.names.index(name)]


def read_storage(path: str | Path, *, check_rows: bool = True) -> Table:
    """Reads a MOT or STO file of any of the header dialects OpenSim has had; degrees stay degrees.

    ``check_rows`` refuses fewer rows than the header promises.

    Raises:
        FileFormatError: The file is missing, has no header or names, or a row is not as long as the names;
            names the line.
    """
    path = Path(path)
    lines = read_text(path, "a MOT or STO file").lines
    end = next((i for i, line in enumerate(lines[:_MOST_HEADER_LINES]) if _is_end(line)), None)
    if end is None:
        raise FileFormatError(path, "not a MOT or STO file (no line 'endheader')")
    title, header = _header(lines[:end])
    below = range(end + 1, len(lines))
    start = next((i for i in below if lines[i].strip() and not is_comment(lines[i])), None)
    if start is None:
        raise FileFormatError(path, "cut short: no column names after the header", end + 1)
    names = _cells(lines[start])
    if not names or names[0].lower() != "time":
        raise FileFormatError(path, "the first column is not 'time'", start + 1)
    rows = blank_separated(lines, path, start + 1, len(names))
    back = np.flatnonzero(~(np.diff(rows[:, 0]) >= 0.0))
    if len(back):
        raise FileFormatError(
            path, "times go back or are not numbers; export it again", start + 2 + int(back[0]) + 1
        )
    degrees = header.get("indegrees", "no").lower() in {"yes", "true", "1"}
    table = Table(tuple(names[1:]), rows[:, 0], rows[:, 1:], degrees, title, header)
    promised = promised_rows(table)
    if check_rows and promised is not None and promised > len(rows):
        reason = f"cut short: {promised} rows promised, {len(rows)} present; copy or export it again"
        raise FileFormatError(path, reason)
    return table


def promised_rows(table: Table) -> int | None:
    """Rows that a table's header promises, or None where it states no number."""
    text = table.header.get("nrows", table.header.get("datarows", "")).strip()
    return int(text) if text.isdecimal() and len(text) < _MOST_DIGITS else None


def write_storage(table: Table, path: str | Path) -> None:
    """Writes a table as OpenSim reads it, whole or not at all; other header entries follow the standard ones.

    Raises:
        OSError: The file cannot be written.
    """
    path = Path(path)
    degrees = "yes" if table.in_degrees else "no"
    lines = [table.title or path.stem, "version=1", f"nRows={len(table.times_s)}"]
    lines += [f"nColumns={len(table.names) + 1}", f"inDegrees={degrees}"]
    lines += [f"Source={MARK}"]
    lines += [f"{name}={text}" for name, text in table.header.items() if name.lower() not in _WRITTEN_BY_US]
    lines += ["endheader", "\t".join(["time", *table.names])]
    with replacing_text(path) as file:
        file.write("\n".join(lines) + "\n")
        file.writelines(
            number_rows(np.column_stack([table.times_s, table.columns]), [10, *[12] * len(table.names)])
        )


def _is_end(line: str) -> bool:
    return line.strip().lower() == "endheader"


def _header(lines: list[str]) -> tuple[str, dict[str, str]]:
    """Title and entries: "name=text" lines, and the older "name text" ones."""
    header: dict[str, str] = {}
    title = ""
    for number, line in enumerate(text.strip() for text in lines):
        if "=" in line:
            name, _, text = line.partition("=")
            header[name.strip().lower()] = text.strip()
        elif line.split(" ")[0].lower() in {"name", "datacolumns", "datarows", "range", "nrows", "ncolumns"}:
            name, _, text = line.partition(" ")
            header[name.lower()] = text.strip()
        elif number == 0:
            title = line
    return title or header.get("name", ""), header


def _cells(line: str) -> list[str]:
    """Names between tabs, or between blanks in a line without tabs."""
    cells = line.split("\t") if "\t" in line else line.split()
    return [cell.strip() for cell in cells if cell.strip()]
