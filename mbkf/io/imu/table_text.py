"""Text of a table: decoded, cut into cells by its own delimiter, with decimal points or commas."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_input, read_bytes
from mbkf.io.text import decoded

_COMMENT = ("#", "//", "%")
_DELIMITERS = "\t;,"
_BLANK = " "


@dataclass(frozen=True)
class TableText:
    """Cells of a table.

    Attributes:
        path: The file.
        rows: Line number and cells of every line that is neither blank nor a comment; cells have no space around.
        comments: The comments.
        decimal_comma: Whether numbers have a comma for a point.
    """

    path: Path
    rows: list[tuple[int, list[str]]]
    comments: list[str]
    decimal_comma: bool = False

    def number(self, cell: str) -> float:
        """A cell as a number; a date with a time of day as seconds since 1970.

        Raises:
            ValueError: It is not one.
        """
        try:
            return float(cell.replace(",", ".") if self.decimal_comma else cell)
        except ValueError:
            if len(cell) < 10 or not cell[:4].isdigit():
                raise
            return datetime.fromisoformat(cell).timestamp()


def read_table_text(path: Path) -> TableText:
    """The cells of a file.

    Raises:
        FileFormatError: The file is missing, damaged or has no rows.
    """
    check_input(path, "name a CSV table of inertial readings")
    return split_table(path, decoded(read_bytes(path)))


def split_table(path: Path, text: str) -> TableText:
    """The cells of a text; ``path`` is its file, for messages.

    Raises:
        FileFormatError: It is damaged or has no rows.
    """
    lines = text.splitlines()
    delimiter = None
    if lines and lines[0].strip().lower().replace('"', "").startswith("sep="):
        delimiter = lines[0].replace('"', "")[4:5] or None
        lines[0] = ""
    comments = [line for line in lines if line.lstrip().startswith(_COMMENT)]
    kept = [
        (number, line)
        for number, line in enumerate(lines, start=1)
        if line.strip(" ,;\t") and not line.lstrip().startswith(_COMMENT)
    ]
    delimiter = delimiter or _delimiter([line for _, line in kept])
    if delimiter == _BLANK:
        kept = [(number, _BLANK.join(line.split())) for number, line in kept]
    kept = _with_commented_names(kept, lines, delimiter)
    if len(kept) < 2:
        raise FileFormatError(path, "cut short: no rows after the column names")
    cells = csv.reader((line for _, line in kept), delimiter=delimiter)
    try:
        rows = [
            (number, [cell.strip() for cell in row]) for (number, _), row in zip(kept, cells, strict=True)
        ]
    except (csv.Error, ValueError) as error:  # a quotation mark that does not end joins rows
        raise FileFormatError(path, f"damaged ({error}); export it again") from error
    return TableText(path, rows, comments, delimiter != "," and _decimal_commas(rows))


def is_number(cell: str) -> bool:
    """True for a cell that is a number, whatever its decimal mark, or a date."""
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return len(cell) >= 10 and cell[:4].isdigit() and cell[4] == "-"
    return bool(cell)


def _delimiter(lines: list[str]) -> str:
    """The mark that cuts most lines; a comma only where no other does, since it may stand in numbers; else blanks."""
    sample = lines[-20:] + lines[:60]
    counts = {mark: sum(line.count(mark) > 0 for line in sample) for mark in _DELIMITERS}
    blank = bool(sample) and not any(counts.values()) and all(len(line.split()) > 1 for line in sample)
    return _BLANK if blank else max(_DELIMITERS, key=lambda mark: counts[mark])


def _with_commented_names(
    kept: list[tuple[int, str]], lines: list[str], delimiter: str
) -> list[tuple[int, str]]:
    """The lines, after the comment above them where it names as many columns: numpy.savetxt and others write so."""
    if not kept:
        return kept
    number, first = kept[0]
    above = lines[number - 2].strip() if number > 1 else ""
    if not above.startswith(_COMMENT) or not all(map(is_number, first.replace('"', "").split(delimiter))):
        return kept
    names = above.lstrip("#/% ")
    if delimiter == _BLANK:
        names = _BLANK.join(names.split())
    same = names.count(delimiter) == first.count(delimiter)
    return [(number - 1, names), *kept] if same else kept


def _decimal_commas(rows: list[tuple[int, list[str]]]) -> bool:
    """True where numbers of the last rows are written with commas."""
    cells = [cell for _, row in rows[-20:] for cell in row if cell]
    return sum("," in cell and is_number(cell) for cell in cells) > len(cells) // 4
