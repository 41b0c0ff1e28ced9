"""CSV tables that people write, most often in a spreadsheet: with commas, semicolons or tabs, and titles in their way.

A column is found by its declared key; capitals, spaces and brackets do not count, so that "Mass (kg)" is ``mass_kg``. A
column that is not declared is refused, a row that cannot be right costs only itself.
"""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import FileFormatError, UnknownEntry
from mbkf.io.fields import Record
from mbkf.io.plain_data import plain_text
from mbkf.io.toml import Entries, Origin

DELIMITERS = (",", ";", "\t")

_STATED = re.compile(r'"?sep=(.)"?')


@dataclass(frozen=True)
class CsvRow:
    """A row of a table.

    Attributes:
        line: Its first line, from 1.
        entries: Its cells that are not blank; the fault instead, where the row cannot be right.
        cells: The same as texts, by column.
        notes: Cells that were not plainly written, and their reading.
    """

    line: int
    entries: Entries | FileFormatError
    cells: dict[str, str]
    notes: tuple[str, ...] = ()


def read_edited_csv(file: Path, record: Record) -> list[CsvRow]:
    """The rows of a table; blank ones are left out.

    Args:
        file: The file.
        record: Declaration of its columns.

    Raises:
        UnknownEntry: A column is not declared.
        FileFormatError: The file cannot be read, is no table, or a required column is missing or stands twice.
    """
    try:
        text = plain_text(file)
    except (OSError, ValueError) as error:
        raise FileFormatError(file, f"cannot be read as a {record.name} in CSV ({error})") from error
    lines, first = list(io.StringIO(text, newline="")), 0
    stated = _STATED.fullmatch(lines[0].strip(" \r\n")) if lines else None
    if stated is not None:
        first = 1
    while first < len(lines) and not lines[first].strip(" ,;\t\r\n"):
        first += 1
    if first == len(lines):
        return []
    delimiter = stated[1] if stated is not None else _delimiter(lines[first], record)
    rows = _cells(lines[first:], file, first, delimiter)
    line, titles = next(rows)
    columns = _columns(titles, record, file, line)
    return [_row(number, cells, columns, record, file) for number, cells in rows if any(cells)]


def _delimiter(title_line: str, record: Record) -> str:
    """The mark between cells with which most titles are known."""

    def known(delimiter: str) -> int:
        return sum(
            _folded(title) in record.keys for title in next(csv.reader([title_line], delimiter=delimiter), [])
        )

    return max(DELIMITERS, key=known)


def _cells(lines: Sequence[str], file: Path, before: int, delimiter: str) -> Iterator[tuple[int, list[str]]]:
    """First line and cells of each row, without the spaces around them."""
    rows, last = csv.reader(lines, delimiter=delimiter), 0
    try:
        for row in rows:
            yield before + last + 1, [cell.strip() for cell in row]
            last = rows.line_num
    except csv.Error as error:
        raise FileFormatError(file, f"is damaged ({error})", before + rows.line_num) from error


def _columns(titles: Sequence[str], record: Record, file: Path, line: int) -> list[str]:
    """The key of each column; empty for one without a title."""
    columns = [_folded(title) for title in titles]
    for title, key in zip(titles, columns, strict=True):
        if key and key not in record.keys:
            raise UnknownEntry(file, f"{record.name} column", title, record.keys, line)
    twice = [key for key, count in Counter(columns).items() if key and count > 1]
    if twice:
        raise FileFormatError(file, f"column {twice[0]} stands twice; keep one of both", line)
    for field in record.fields:
        if field.required and field.key not in columns:
            raise FileFormatError(
                file, f"has no column '{field.key}'; its columns are {', '.join(titles)}", line
            )
    return columns


def _row(line: int, cells: Sequence[str], columns: Sequence[str], record: Record, file: Path) -> CsvRow:
    found = {key: cell for key, cell in zip(columns, cells, strict=False) if cell and key}
    beyond = [cell for n, cell in enumerate(cells) if cell and (n >= len(columns) or not columns[n])]
    if beyond:
        reason = (
            f"{len(cells)} cells for {sum(map(bool, columns))} columns ('{beyond[0]}' has no title); put a text with a "
            "comma into quotation marks, and write decimals with a point"
        )
        return CsvRow(line, FileFormatError(file, reason, line), found)
    if cells[0].startswith("#"):
        reason = "begins with #, which is no comment in a list; remove the row"
        return CsvRow(line, FileFormatError(file, reason, line), found)
    table, notes = {}, []
    for field in record.fields:
        if field.key in found:
            table[field.key], note = field.of_cell(found[field.key])
            notes += [f"{file}, line {line}: {note}"] if note else []
    return CsvRow(line, Entries(record, table, Origin(file, line=line)), found, tuple(notes))


def _folded(title: str) -> str:
    """A title as a key: small letters, with low lines between words."""
    return "_".join(re.findall(r"[^\W_]+", title.lower()))
