"""Cells of Excel's workbooks (.xlsx, ECMA-376), as texts; formulas by the value that the program stored."""

from __future__ import annotations

import re
import zipfile
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree

from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_input, read_bytes

Sheet = list[list[str]]
"""Rows of cells; those that lack are empty texts."""

_MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
_RELATION = "{http://schemas.openxmlformats.org/officeDocument/2006/relationships}id"
_PLACE = re.compile(r"([A-Z]{1,3})([0-9]{1,7})")

MOST_BYTES = 1 << 26
"""Largest unpacked part of a workbook; a damaged or hostile one unpacks to much more."""

MOST_ROWS, MOST_COLUMNS = 1 << 16, 1 << 10


def read_workbook(path: Path) -> dict[str, Sheet]:
    """The sheets of a workbook by name, in its order.

    Args:
        path: The file.

    Raises:
        FileFormatError: The file is missing, or no workbook.
    """
    check_input(path, "name a workbook (.xlsx)")
    try:
        with zipfile.ZipFile(BytesIO(read_bytes(path))) as parts:
            return _sheets(path, parts)
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError, ValueError, IndexError) as error:
        raise FileFormatError(
            path, f"no workbook that can be read ({error}); save it as .xlsx again"
        ) from error


def _sheets(path: Path, parts: zipfile.ZipFile) -> dict[str, Sheet]:
    book = _part(path, parts, "xl/workbook.xml")
    links = {one.get("Id"): one.get("Target", "") for one in _part(path, parts, "xl/_rels/workbook.xml.rels")}
    texts = []
    if "xl/sharedStrings.xml" in parts.namelist():
        texts = [_text(one) for one in _part(path, parts, "xl/sharedStrings.xml").iter(f"{_MAIN}si")]
    found = {}
    for sheet in book.iter(f"{_MAIN}sheet"):
        target = links[sheet.get(_RELATION)].lstrip("/")
        place = target if target.startswith("xl/") else f"xl/{target}"
        found[sheet.get("name", "")] = _cells(_part(path, parts, place), texts)
    return found


def _part(path: Path, parts: zipfile.ZipFile, name: str) -> ElementTree.Element:
    if parts.getinfo(name).file_size > MOST_BYTES:
        raise FileFormatError(
            path, f"its part {name} is larger than {MOST_BYTES >> 20} MB; save a smaller workbook"
        )
    return ElementTree.fromstring(parts.read(name))


def _text(element: ElementTree.Element) -> str:
    return "".join(one.text or "" for one in element.iter(f"{_MAIN}t"))


def _cells(sheet: ElementTree.Element, texts: list[str]) -> Sheet:
    rows: Sheet = []
    for cell in sheet.iter(f"{_MAIN}c"):
        place = _PLACE.fullmatch(cell.get("r", ""))
        if place is None:
            raise ValueError(f"a cell at '{cell.get('r')}'")
        row, column = int(place[2]) - 1, _column(place[1])
        if row >= MOST_ROWS or column >= MOST_COLUMNS:
            raise ValueError(f"a cell at {place[0]}, more than bands need")
        rows.extend([] for _ in range(row + 1 - len(rows)))
        rows[row].extend("" for _ in range(column + 1 - len(rows[row])))
        rows[row][column] = _content(cell, texts)
    return rows


def _column(letters: str) -> int:
    """Number of a column from 0: A is 0, Z is 25, AA is 26."""
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - ord("A") + 1
    return number - 1


def _content(cell: ElementTree.Element, texts: list[str]) -> str:
    kind, value = cell.get("t", "n"), cell.find(f"{_MAIN}v")
    if kind == "inlineStr":
        return _text(cell)
    if value is None or value.text is None or kind == "e":
        return ""
    return texts[int(value.text)] if kind == "s" else value.text
