"""Workbooks of norms: Polygon's sheet "Normal", or sheets with a table of bands each.

In Polygon's sheet two columns with one head, such as "HipAngles (1)", are mean less and plus one standard deviation;
the second row holds zeros, the third units, and the cycle follows in equal steps.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from mbkf.errors import FileFormatError
from mbkf.io.norm_files.raw import RawBand, RawNorms
from mbkf.io.norm_files.table import Table, bands_of_table, is_table_of_bands
from mbkf.io.norm_files.workbook import Sheet
from mbkf.io.text import number

POLYGON, WORKBOOK = "workbook of Polygon", "workbook"
SHEET, FIRST_ROW = "Normal", 3

_COMPONENT = re.compile(r"(.*?)\s*\(([123])\)")


def workbook_norms(path: Path, sheets: dict[str, Sheet]) -> RawNorms:
    """The bands of a workbook.

    Args:
        path: The file, for messages.
        sheets: Its sheets.

    Raises:
        FileFormatError: No sheet has bands, or one is damaged.
    """
    if SHEET in sheets:
        return RawNorms(POLYGON, tuple(_polygon(path, sheets[SHEET])))
    bands: list[RawBand] = []
    for rows in sheets.values():
        if rows and is_table_of_bands(rows[0]):
            kept = tuple((n, tuple(row)) for n, row in enumerate(rows[1:], start=2) if any(row))
            bands += bands_of_table(Table(path, tuple(rows[0]), kept))
    if not bands:
        raise FileFormatError(path, "no sheet has columns of per cent, mean and sd; save such a table as CSV")
    return RawNorms(WORKBOOK, tuple(bands))


def _polygon(path: Path, rows: Sheet) -> list[RawBand]:
    """The two columns of each head."""
    if len(rows) <= FIRST_ROW:
        raise FileFormatError(path, f"sheet {SHEET} has no values below its units")
    columns: dict[str, list[int]] = {}
    for k, head in enumerate(rows[0]):
        if head.strip():
            columns.setdefault(head.strip(), []).append(k)
    bands = []
    for head, places in columns.items():
        values = [[number(row[k]) if k < len(row) else None for k in places] for row in rows[FIRST_ROW:]]
        whole = np.array([row for row in values if None not in row], dtype=float)
        if len(places) != 2 or len(whole) < 2:
            continue
        part = _COMPONENT.fullmatch(head)
        label, component = (part[1], "XYZ"[int(part[2]) - 1]) if part else (head, "")
        unit = rows[2][places[0]] if places[0] < len(rows[2]) else ""
        mean, sd = whole.mean(axis=1), 0.5 * (whole[:, 1] - whole[:, 0])
        bands.append(RawBand(label, mean, sd, np.linspace(0.0, 100.0, len(whole)), component, unit=unit))
    return bands
