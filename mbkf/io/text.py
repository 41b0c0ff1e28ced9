"""Common parts of text files: encodings, lines, numbers in cells, counts and rates that disagree with the rows."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io import files_read

RATE_TOLERANCE = 0.005
_EVEN_TOLERANCE = 0.5

COMMENT = "#"
"""Begins a line that people add to a table."""

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2},\d{3}")
_LEAST_WHOLE = 3
"""Numbers without a comma in a row whose commas may be those of thousands: frame, time, and a coordinate. Zeros alone
are no evidence: tables with decimal commas write them without one."""

_UTF_16 = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}


@dataclass(frozen=True)
class TextFile:
    """Lines of a text file.

    Attributes:
        path: The file.
        lines: Its lines without line ends.
        whole: Whether the last line is ended, as a program leaves it and a copy that broke off does not.
        places: Numbers of the lines in the file, from 1; empty where they are all of its lines.
    """

    path: Path
    lines: list[str]
    whole: bool
    places: tuple[int, ...] = ()

    def line(self, index: int) -> int:
        """Number in the file of the line with an index, from 1."""
        return self.places[index] if self.places else index + 1

    def without_comments(self) -> TextFile:
        """The file without the lines that begin with #."""
        kept = [(n, text) for n, text in enumerate(self.lines, start=1) if not is_comment(text)]
        lines, places = [text for _, text in kept], tuple(n for n, _ in kept)
        return TextFile(self.path, lines, self.whole, places)


def read_text(path: Path, kind: str) -> TextFile:
    """Lines of a file; ``kind`` is the expected kind with its article, for the message: "a TRC file".

    Raises:
        FileFormatError: The file does not exist.
    """
    files_read.check_input(path, f"name {kind}")
    text = decoded(files_read.read_bytes(path))
    return TextFile(path, text.splitlines(), text.endswith(("\n", "\r")))


def decoded(data: bytes) -> str:
    """Text of bytes: by the mark at their beginning, as UTF-8, else as Windows writes."""
    encoding = _UTF_16.get(data[:2])
    if encoding is not None:
        return data[2:].decode(encoding, "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def is_comment(line: str) -> bool:
    """True for a line that begins with #."""
    return line.lstrip().startswith(COMMENT)


def numbers(cells: Sequence[str], path: Path, line: int) -> list[float]:
    """Cells as numbers, NaN where one is blank; in a row without decimal points, commas are decimal.

    Args:
        cells: The cells.
        path: The file, for messages.
        line: Number of the line, from 1.

    Raises:
        FileFormatError: A cell is not a number, or commas may be those of thousands; names the line.
    """
    try:
        return [float(cell) if cell.strip() else math.nan for cell in cells]
    except ValueError as error:
        if any("," in cell for cell in cells) and not any("." in cell for cell in cells):
            with_points = [_with_point(cell) for cell in cells]
            if not any("," in cell for cell in with_points):
                _check_thousands(cells, path, line)
                return numbers(with_points, path, line)
        raise FileFormatError(path, f"not a number ({error}); correct or blank it", line) from error


def _check_thousands(cells: Sequence[str], path: Path, line: int) -> None:
    """Refuses a row of whole numbers, some with a comma before their last three digits: "1,234" beside "567"."""
    stripped = [cell.strip() for cell in cells if cell.strip()]
    commas = [cell for cell in stripped if "," in cell]
    whole = [cell for cell in stripped if "," not in cell]
    if (
        len(whole) >= _LEAST_WHOLE
        and set(whole) != {"0"}
        and all(_THOUSANDS.fullmatch(cell) for cell in commas)
    ):
        reason = f"'{commas[0]}' beside whole numbers may be a thousand or a decimal"
        raise FileFormatError(path, f"{reason}; export the file without commas for thousands", line)


def _with_point(cell: str) -> str:
    """A cell with a point for its decimal comma; another cell, as one with a comma for thousands, stays."""
    return cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell.strip()) else cell


def blank_separated(lines: Sequence[str], path: Path, start: int, width: int) -> Array:
    """(T, width) numbers of the lines from an index on; blank lines and comments are passed over.

    Args:
        lines: Lines of the file.
        path: The file, for messages.
        start: Index of the first row.
        width: Number of columns.

    Raises:
        FileFormatError: A row has another length, a value is not a number, or there are no rows; names the line.
    """
    rows = []
    for line, text in enumerate(lines[start:], start=start + 1):
        cells = [] if is_comment(text) else text.split()
        if cells and len(cells) != width:
            raise FileFormatError(path, f"{len(cells)} values for {width} columns; export it again", line)
        if cells:
            rows.append(numbers(cells, path, line))
    if not rows:
        raise FileFormatError(path, "cut short: no rows after the column names; export it again", start)
    return np.array(rows)


def csv_rows(lines: Sequence[str], path: Path, first: int = 1, delimiter: str = ",") -> Iterator[list[str]]:
    """Cells of lines, of which quotation marks may join some.

    Args:
        lines: The lines.
        path: The file, for messages.
        first: Number of the first line, from 1.
        delimiter: Mark between cells.

    Raises:
        FileFormatError: A quotation mark does not end, so that a cell is too long; names the line.
    """
    rows = csv.reader(lines, delimiter=delimiter)
    try:
        yield from rows
    except csv.Error as error:
        line = first - 1 + rows.line_num
        raise FileFormatError(path, f"damaged ({error}); export it again", line) from error


def number(word: str) -> float | None:
    """A finite number, with a decimal point or comma, or None for any other word."""
    try:
        value = float(_with_point(word))
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def compare_count(file: TextFile, promised: int | None, found: int, noun: str) -> list[str]:
    """A remark where a header counts other rows than there are.

    A file that broke off does not end with a whole line; one that does had a wrong count from the start.

    Args:
        file: The file.
        promised: Count of the header; None where it states none.
        found: Rows that are there.
        noun: What a row is, in the plural.

    Raises:
        FileFormatError: Rows are missing and the last line is not whole.
    """
    if promised is None or promised == found:
        return []
    if promised > found and not file.whole:
        reason = f"cut short: the header promises {promised} {noun}, {found} are there"
        raise FileFormatError(file.path, f"{reason}; copy or export it again")
    return [f"the header counts {promised} {noun}, {found} are there"]


def compare_rate(rate_hz: float, times_s: Array) -> list[str]:
    """A remark where a header's rate in Hz and the (T,) times disagree."""
    if len(times_s) < 2:
        return []
    span_s = times_s[-1] - times_s[0]
    if not span_s > 0.0:
        return ["the Time column does not increase; times follow from the header's rate"]
    from_times = (len(times_s) - 1) / span_s
    if abs(from_times - rate_hz) > RATE_TOLERANCE * rate_hz:
        return [f"the header states {rate_hz:g} Hz, the Time column {from_times:.6g} Hz; the header is used"]
    return []


def check_order(path: Path, counted: Array, name: str, first_line: int | None = None) -> None:
    """Refuses rows in another order than they were measured, or with gaps.

    Args:
        path: The file, for the message.
        counted: (T,) times or numbers of samples, which increase by the same step from row to row.
        name: Their name, for the message.
        first_line: Line of the first row, where each row is a line.

    Raises:
        FileFormatError: A step is less than half or more than one and a half of the usual one; names the line.
    """
    with np.errstate(invalid="ignore"):  # steps to missing numbers do not count
        steps = np.diff(counted)
    finite = steps[np.isfinite(steps)]
    usual = float(np.median(finite)) if len(finite) else 1.0
    uneven = ~((steps > 0.5 * usual) & (steps < 1.5 * usual)) if usual > 0.0 else ~(steps > 0.0)
    if uneven.any():
        row = int(np.argmax(uneven)) + 1
        line = None if first_line is None else first_line + row
        reason = (
            f"{name} goes from {counted[row - 1]:.6g} to {counted[row]:.6g}; rows are missing or out of order"
        )
        raise FileFormatError(path, f"{reason}; export it again", line)


def even_rate(path: Path, times_s: Array) -> float:
    """Sample rate in Hz of (T,) evenly spaced times; rounded ones count as even.

    Raises:
        FileFormatError: The times do not increase, or are not even.
    """
    if len(times_s) < 2 or not times_s[-1] > times_s[0]:
        raise FileFormatError(path, "the time column does not increase; export the file again")
    rate_hz = float((len(times_s) - 1) / (times_s[-1] - times_s[0]))
    off = np.abs((times_s - times_s[0]) * rate_hz - np.arange(len(times_s)))
    if not off.max() <= _EVEN_TOLERANCE:
        worst = times_s[int(np.argmax(off))]
        raise FileFormatError(path, f"times are not evenly spaced near {worst:.4f} s; resample them first")
    return round(rate_hz, 6)
