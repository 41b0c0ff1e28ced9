"""A benchmark's input (the context) and its output (checks of numbers against bounds)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from mbkf.errors import InvalidInput


@dataclass(frozen=True)
class Check:
    """One measured number and the bound it has to keep.

    Attributes:
        name: What is measured, and on which trial.
        value: The measured number; NaN never passes.
        bound: The number it is compared with; infinite where the value is shown for information only.
        relation: "<=" where the value may not exceed the bound, ">=" where it must reach it.
        unit: Unit of value and bound, "" for pure numbers.
        note: Why the row was left out and what it needs; empty where it was measured.
    """

    name: str
    value: float
    bound: float
    relation: Literal["<=", ">="]
    unit: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        if self.relation not in {"<=", ">="}:
            raise InvalidInput(f"check '{self.name}': relation must be '<=' or '>=', got '{self.relation}'")

    @property
    def bounded(self) -> bool:
        """Whether there is a bound to keep."""
        return math.isfinite(self.bound)

    @property
    def left_out(self) -> bool:
        """True for a row without a measurement, which neither keeps nor breaks a bound."""
        return bool(self.note)

    @property
    def passed(self) -> bool:
        """Whether the value keeps its bound, or there is none."""
        if not self.bounded:
            return True
        return bool(self.value <= self.bound if self.relation == "<=" else self.value >= self.bound)


@dataclass(frozen=True)
class Context:
    """A benchmark's input.

    Attributes:
        data: Folder of the public reference captures, or None when there is none.
        out: Folder for the benchmark's files; exists.
        quick: Whether to do a shorter run, for a first look.
        old: Folder of another source tree that this one is compared with, or None when there is none.
        minutes: How long a benchmark that can run for long is to run in place of its rows; None for its rows.
        seed: Of what is made at random, in benchmarks that take one.
        only: Parts to run, in benchmarks that have parts; empty for all.
    """

    data: Path | None
    out: Path
    quick: bool = False
    old: Path | None = None
    minutes: float | None = None
    seed: int = 0
    only: tuple[str, ...] = ()

    def require_data(self) -> Path:
        """The folder of reference captures.

        Raises:
            InvalidInput: No folder was given.
        """
        if self.data is None:
            raise InvalidInput("the reference captures are needed; give --data DIR or set MBKF_DATA")
        return self.data


def within(name: str, value: float, least: float, most: float, unit: str = "") -> list[Check]:
    """The two checks of a number that has to lie in a band.

    Args:
        name: Name of the checks.
        value: The number.
        least: Lower end of the band.
        most: Upper end of the band.
        unit: Unit of the number.
    """
    return [
        Check(f"{name}, at least", value, least, ">=", unit),
        Check(f"{name}, at most", value, most, "<=", unit),
    ]


def information(name: str, value: float, unit: str = "") -> Check:
    """A number shown without a bound.

    Args:
        name: Name of the row.
        value: The number.
        unit: Its unit.
    """
    return Check(name, value, math.inf, "<=", unit)


def left_out(name: str, note: str) -> Check:
    """A row that was not measured: it neither passes nor fails.

    Args:
        name: Name of the row.
        note: Why, and what it needs.
    """
    return Check(name, math.nan, math.inf, "<=", note=note)


def number(value: float | None) -> float:
    """A number of a summary; NaN, which passes no bound, where it is missing."""
    return math.nan if value is None else float(value)
