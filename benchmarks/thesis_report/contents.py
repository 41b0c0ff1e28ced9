"""Bounded numbers (bands), statements of a source text (claims), and tables written as CSV and shown on the page."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check

OPEN = math.inf

Row = tuple[str | float, ...]
"""Cells of a table."""


@dataclass(frozen=True)
class Band:
    """A measured number and the interval that a correct implementation keeps it in.

    Attributes:
        row: Group of the number on the page.
        name: What is measured.
        value: The number.
        low, high: The interval, infinite where it is open.
        unit: Of all three.
        needs_all_seeds: Whether a few seeds are too few to judge it, so that a quick run only shows it.
    """

    row: str
    name: str
    value: float
    low: float
    high: float
    unit: str = ""
    needs_all_seeds: bool = True

    @property
    def kept(self) -> bool:
        """Whether the value lies in the interval; NaN lies nowhere."""
        return bool(self.low <= self.value <= self.high)

    @property
    def interval(self) -> str:
        """As people write it."""
        if self.low == -OPEN:
            return f"≤ {self.high:.4g}"
        if self.high == OPEN:
            return f"≥ {self.low:.4g}"
        return f"{self.low:.4g} … {self.high:.4g}"

    def checks(self, quick: bool) -> list[Check]:
        """One check per closed end; for information where too few seeds were run to judge."""
        title = f"{self.row}: {self.name}"
        if quick and self.needs_all_seeds:
            return [Check(title, self.value, math.inf, "<=", self.unit)]
        found = []
        if self.low > -OPEN:
            found.append(Check(title, self.value, self.low, ">=", self.unit))
        if self.high < OPEN:
            found.append(Check(title, self.value, self.high, "<=", self.unit))
        return found


@dataclass(frozen=True)
class Sheet:
    """A table.

    Attributes:
        name: Of its file, without ``.csv``.
        title: What it shows.
        columns: Headings with units.
        rows: Texts and numbers.
        note: Remarks for the reader, in a sentence or two.
    """

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[Row, ...]
    note: str = ""

    def write(self, folder: Path) -> None:
        """Writes it as CSV."""
        with (folder / f"{self.name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(self.columns)
            writer.writerows([_plain(cell) for cell in row] for row in self.rows)


def _plain(cell: str | float) -> str:
    return cell if isinstance(cell, str) else f"{cell:.8g}"


@dataclass(frozen=True)
class Claim:
    """A statement of the source text, and its measurement.

    Attributes:
        source: Where it stands.
        statement: The statement in words.
        measured: The numbers found here.
        verdict: "holds", "partly" or "does not hold" where a statement is tested; "reproduced", "differs" or
            "cannot be had" where a published result is redone, with the reason in ``measured``.
    """

    source: str
    statement: str
    measured: str
    verdict: str


def judged(holds: bool, partly: bool = False) -> str:
    """The verdict on a claim."""
    return "holds" if holds else "partly" if partly else "does not hold"


CANNOT_BE_HAD = "cannot be had"
"""The verdict on a statement that nothing here can test; the reason stands in place of a measurement."""


def redone(same: bool) -> str:
    """The verdict on a published result that was redone."""
    return "reproduced" if same else "differs"


@dataclass(frozen=True)
class Findings:
    """Results of a part of the benchmark: ``bands``, ``sheets`` and ``claims``."""

    bands: Sequence[Band] = ()
    sheets: Sequence[Sheet] = ()
    claims: Sequence[Claim] = ()
