"""Bands in the cells of a table, long (a row for each curve and point) or wide (a column for each mean and spread).

Columns are known by their heads: a point of the cycle ("percent", "% gait cycle", "PercentageGaitCycle"), mean and
standard deviation ("mean", "average"; "sd", "std"), or both ends of mean ± 1 standard deviation ("mean-sd",
"mean+sd"; "lower", "upper"). The rest of a head names the curve, or, in a long table, the group.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.norm_files.raw import MEASURE, RawBand
from mbkf.io.text import number

MEAN, SD, LOWER, UPPER = "mean", "sd", "lower", "upper"

_STATISTICS = (
    (re.compile(r"mean\s*[-−]\s*(1\s*)?sd|lower|(?<![a-z])min(?![a-z])", re.IGNORECASE), LOWER),
    (re.compile(r"mean\s*\+\s*(1\s*)?sd|upper|(?<![a-z])max(?![a-z])", re.IGNORECASE), UPPER),
    (
        re.compile(r"(?i:standard\s*deviation|(?<![a-z])(?:sd|std|stdev|stddev)(?![a-z]))|(?<=[a-z])S[Dd]$"),
        SD,
    ),
    (re.compile(r"(?<![a-z])(?:mean|average|avg)(?![a-z])|(?<=[a-z])(?:Mean|Average)$", re.IGNORECASE), MEAN),
)
"""Words of statistics, those with two meanings first."""

_PERCENT = re.compile(
    r"\W*(%|percent\w*|(?:% ?|percentage ?|percent ?)?(?:of )?(?:the )?(?:gait ?)?cycle)\W*\w?\W*"
)

_COLUMNS: Mapping[str, str] = {
    **dict.fromkeys(("curve", "name", "variable", "signal", "label", "parameter", "angle", "moment", "power"), "curve"),
    "force": "curve",
    **dict.fromkeys(("component", "axis"), "component"),
    **dict.fromkeys(("group", "condition"), "group"),
    **dict.fromkeys(("unit", "units"), "unit"),
    **dict.fromkeys(("persons", "n", "subjects"), "persons"),
    "quantity": "quantity",
    "kind": "kind",
    "speed_from_m_s": "speed_from",
    "speed_to_m_s": "speed_to",
}  # fmt: skip

_OWN_QUANTITY = {"angle": "angle", "moment": "torque", "power": "power", "force": "reaction"}
"""Quantity by the head of a long table's names."""

_UNIT = re.compile(r"[\[(]([^\])]*)[\])]")


@dataclass(frozen=True)
class Table:
    """Cells of a table: its heads, and rows with their line numbers."""

    path: Path
    heads: tuple[str, ...]
    rows: tuple[tuple[int, tuple[str, ...]], ...]


@dataclass(frozen=True)
class _Columns:
    """Columns of a table: those known by name, and (mean or lower, sd or upper, whether these are ends) by the rest."""

    percent: int
    named: Mapping[str, int]
    pairs: Mapping[str, tuple[int, int, bool]]


def bands_of_table(table: Table) -> tuple[RawBand, ...]:
    """The bands of a table.

    Raises:
        FileFormatError: A column lacks, or a cell that must be one is no number.
    """
    columns = _columns(table)
    if "curve" in columns.named:
        return tuple(_long(table, columns))
    return tuple(_wide(table, columns))


def is_table_of_bands(heads: Sequence[str]) -> bool:
    """True for heads with a point of the cycle and a statistic."""
    return any(_PERCENT.fullmatch(one.lower()) for one in heads) and any(_statistic(one)[0] for one in heads)


def _statistic(head: str) -> tuple[str, str]:
    """The statistic of a head, and the rest of it."""
    for pattern, statistic in _STATISTICS:
        found = pattern.search(head)
        if found is not None:
            rest = head[: found.start()] + " " + head[found.end() :]
            return statistic, " ".join(rest.replace("_", " ").split()).strip(" -–,;:±")
    return "", head


def _columns(table: Table) -> _Columns:
    percent, named, found = -1, {}, dict[str, dict[str, int]]()
    for k, head in enumerate(table.heads):
        known = _COLUMNS.get(head.strip().lower())
        statistic, rest = _statistic(head)
        if percent < 0 and _PERCENT.fullmatch(head.strip().lower()):
            percent = k
        elif known is not None and known not in named:
            named[known] = k
        elif statistic:
            if statistic in found.setdefault(rest, {}):
                raise FileFormatError(table.path, f"column '{head}' stands twice; keep one of both")
            found[rest][statistic] = k
    if percent < 0:
        raise FileFormatError(
            table.path, "no column states the per cent of the gait cycle; name it 'percent', from 0 to 100"
        )
    pairs = {}
    for rest, each in found.items():
        if MEAN in each and SD in each:
            pairs[rest] = (each[MEAN], each[SD], False)
        elif LOWER in each and UPPER in each:
            pairs[rest] = (each[LOWER], each[UPPER], True)
        else:
            here = " and ".join(each)
            raise FileFormatError(
                table.path,
                f"'{rest or table.heads[next(iter(each.values()))]}' has {here} alone; bands need mean and sd, in "
                "columns such as 'hip flexion mean' and 'hip flexion sd'",
            )
    if not pairs:
        raise FileFormatError(
            table.path,
            "no columns of mean and sd; name them 'mean' and 'sd', or 'hip flexion mean' and so on",
        )
    return _Columns(percent, named, pairs)


def _value(table: Table, row: tuple[int, tuple[str, ...]], column: int) -> float:
    """A cell as a number; NaN where it is blank."""
    line, cells = row
    cell = cells[column].strip() if column < len(cells) else ""
    if not cell:
        return float("nan")
    value = number(cell.rstrip("%").strip())
    if value is None:
        raise FileFormatError(table.path, f"'{cell}' in column '{table.heads[column]}' is not a number", line)
    return value


def _ends(first: Array, second: Array, ends: bool) -> tuple[Array, Array]:
    """Mean and standard deviation of two columns."""
    return (0.5 * (first + second), 0.5 * (second - first)) if ends else (first, second)


def _wide(table: Table, columns: _Columns) -> list[RawBand]:
    bands = []
    percent = np.array([_value(table, row, columns.percent) for row in table.rows])
    for rest, (a, b, ends) in columns.pairs.items():
        first, second = (np.array([_value(table, row, k) for row in table.rows]) for k in (a, b))
        known = np.isfinite(percent) & np.isfinite(first) & np.isfinite(second)
        mean, sd = _ends(first[known], second[known], ends)
        unit = _UNIT.search(rest)
        label = " ".join(_UNIT.sub(" ", rest).split())
        bands.append(RawBand(label, mean, sd, percent[known], unit="" if unit is None else unit[1]))
    return bands


def _long(table: Table, columns: _Columns) -> list[RawBand]:
    """A band for each curve, component, group and speed, of the rows that have the same."""
    head = table.heads[columns.named["curve"]].strip().lower()
    rows: dict[tuple[str, ...], list[tuple[int, tuple[str, ...]]]] = {}
    keys = ("curve", "component", "group", "kind", "quantity", "unit", "persons", "speed_from", "speed_to")

    def cell(row: tuple[int, tuple[str, ...]], key: str) -> str:
        column = columns.named.get(key)
        return row[1][column].strip() if column is not None and column < len(row[1]) else ""

    for row in table.rows:
        if cell(row, "curve"):
            rows.setdefault(tuple(cell(row, key) for key in keys), []).append(row)
    bands = []
    for key, own in rows.items():
        label, component, group, kind, quantity, unit, persons, low, high = key
        for rest, (a, b, ends) in columns.pairs.items():
            values = np.array([[_value(table, row, k) for k in (columns.percent, a, b)] for row in own])
            known = np.isfinite(values[:, 1:]).all(axis=1)
            mean, sd = _ends(values[known, 1], values[known, 2], ends)
            percent = np.empty(0) if quantity == MEASURE else values[known, 0]
            bands.append(
                RawBand(
                    label,
                    mean,
                    sd,
                    percent,
                    component.upper(),
                    " ".join((group, rest)).strip(),
                    kind or "walk",
                    quantity or _OWN_QUANTITY.get(head, ""),
                    unit,
                    int(number(persons) or 0),
                    _speeds(table, own[0][0], low, high),
                )
            )
    return [one for one in bands if len(one.mean)]


def _speeds(table: Table, line: int, low: str, high: str) -> tuple[float, float] | None:
    """Two speeds; None where the cells are blank."""
    if not low and not high:
        return None
    one, other = number(low), number(high)
    if one is None or other is None or not 0.0 <= one < other:
        raise FileFormatError(
            table.path, f"speeds from '{low}' to '{high}' are none; the lower one comes first", line
        )
    return one, other
