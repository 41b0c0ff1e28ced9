"""Entries of tables that people write, declared once: key, meaning, unit and range.

From one declaration follow the reading of a table, its messages and its table in the documentation. A cell of a CSV
file may hold a decimal comma, or the number's own unit behind it; both are read and reported. Everything else that is
not as declared is refused, with a mend where one number is meant.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import date
from typing import Generic, TypeVar

import numpy as np

from mbkf.conventions import Array

T_co = TypeVar("T_co", covariant=True)

OTHER_UNITS: Mapping[str, Mapping[str, float]] = {
    "kg": {"g": 1e-3, "lb": 0.45359237, "lbs": 0.45359237},
    "m": {"cm": 1e-2, "mm": 1e-3, "in": 0.0254, "ft": 0.3048},
    "s": {"ms": 1e-3, "min": 60.0},
}
"""Units in which people write a number of another unit, with their size in it."""

DECIMAL_UNITS: Mapping[str, tuple[str, ...]] = {"kg": ("g",), "m": ("cm", "mm"), "s": ("ms",)}
"""Those among them in which a number is often given that is too large."""

_NUMBER = re.compile(r"([+-]?\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)\s*([A-Za-z]*)", re.ASCII)
_DAY = re.compile(r"\d{4}-\d{2}-\d{2}", re.ASCII)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}", re.ASCII)
_SHOWN = 40

FIRST_YEAR = 1850
"""First year of a day; an earlier one is a mistake of typing."""


@dataclass(frozen=True)
class Field(Generic[T_co]):
    """One entry of a table.

    Attributes:
        key: Its name.
        meaning: For the documentation.
        expected: Values that it may have, in words.
        parse: The value of plain data; None where they are not such a value.
        required: True where the table is refused without it.
        unit: Of a number.
        span: Least and greatest number; None for other entries.
    """

    key: str
    meaning: str
    expected: str
    parse: Callable[[object], T_co | None]
    required: bool = False
    unit: str = ""
    span: tuple[float, float] | None = None

    def mend(self, value: object) -> str:
        """Advice for a wrong value, such as "; write height_m = 1.78"; empty where no single number is meant."""
        if self.span is None or isinstance(value, bool):
            return ""
        if isinstance(value, str):
            meant = self._converted(value)
            return "" if meant is None else f"; write {self.key} = {meant:.4g}"
        if not isinstance(value, int | float) or not math.isfinite(value):
            return ""
        meant_in = {
            unit: value * OTHER_UNITS[self.unit][unit]
            for unit in DECIMAL_UNITS.get(self.unit, ())
            if _number_in(value * OTHER_UNITS[self.unit][unit], *self.span) is not None
        }
        ways = (f"{self.key} = {meant:.4g} if it is in {unit}" for unit, meant in meant_in.items())
        return f"; write {', '.join(ways)}" if meant_in else ""

    def of_cell(self, text: str) -> tuple[object, str]:
        """Plain data of a CSV cell, and a note where it was not plainly written; a number that is none stays a text.

        Args:
            text: The cell, without spaces around it.
        """
        if self.span is None:
            return text, ""
        plain = number_of(text)
        if plain is not None:
            return plain, ""
        meant = self._meant(text)
        if meant is None:
            return text, ""
        return meant, f"{self.key} '{text}' is read as {meant:g} {self.unit}".rstrip()

    def _meant(self, text: str) -> float | None:
        """The number of a text with a decimal comma or this unit; None where several or other ones are possible."""
        assert self.span is not None
        match = _NUMBER.fullmatch(text)
        if match is None or match[2] not in ("", self.unit):
            return None
        value = float(match[1].replace(",", "."))
        if (
            _THOUSANDS.fullmatch(match[1])
            and _number_in(float(match[1].replace(",", "")), *self.span) is not None
        ):
            return None
        return _number_in(value, *self.span)

    def _converted(self, text: str) -> float | None:
        """The number of a text in this unit or another one of its kind."""
        meant = self._meant(text.strip())
        match = _NUMBER.fullmatch(text.strip())
        if meant is not None or match is None or self.span is None:
            return meant
        size = OTHER_UNITS.get(self.unit, {}).get(match[2].lower())
        return None if size is None else _number_in(float(match[1].replace(",", ".")) * size, *self.span)


@dataclass(frozen=True)
class Record:
    """The entries that a table may have.

    Attributes:
        name: Noun of the table, for messages: "session", "marker".
        fields: Its entries, in the order of the documentation.
    """

    name: str
    fields: tuple[Field[object], ...]

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the entries."""
        return tuple(field.key for field in self.fields)

    def rows(self) -> list[str]:
        """Rows of the documentation's table: entry, value, meaning."""
        rows = []
        for field in self.fields:
            needed = " (required)" if field.required else ""
            rows.append(f"| `{field.key}` | {field.expected}{needed} | {field.meaning} |")
        return rows


def record(name: str, *fields: Field[object]) -> Record:
    """A record of declared entries."""
    return Record(name, fields)


def text(key: str, meaning: str, *, required: bool = False, empty: bool = False) -> Field[str]:
    """A text.

    Args:
        key: Its name.
        meaning: For the documentation.
        required: True where the table is refused without it.
        empty: True where it may be empty.
    """
    return Field(
        key, meaning, "a text", lambda v: v if isinstance(v, str) and (v or empty) else None, required
    )


def word(key: str, meaning: str, known: tuple[str, ...], *, required: bool = False) -> Field[str]:
    """One of the known words.

    Args:
        key: Its name.
        meaning: For the documentation.
        known: The words.
        required: True where the table is refused without it.
    """
    return Field(
        key,
        meaning,
        f"one of {', '.join(known)}",
        lambda v: v if isinstance(v, str) and v in known else None,
        required,
    )


def day(key: str, meaning: str) -> Field[str]:
    """A day of the calendar, read as a text such as "2025-03-31"; TOML's own dates are such days, too."""
    return Field(key, meaning, "a day written as 2025-03-31", _day)


def flag(key: str, meaning: str) -> Field[bool]:
    """True or false."""
    return Field(key, meaning, "true or false", lambda v: v if isinstance(v, bool) else None)


def number(
    key: str,
    meaning: str,
    span: tuple[float, float] = (-math.inf, math.inf),
    unit: str = "",
    *,
    required: bool = False,
) -> Field[float]:
    """A finite number.

    Args:
        key: Its name.
        meaning: For the documentation.
        span: Least and greatest number.
        unit: Its unit; empty for a pure number.
        required: True where the table is refused without it.
    """
    if math.isinf(span[0]):
        expected = f"a number in {unit}" if unit else "a number"
    else:
        expected = f"a number between {span[0]:g} and {span[1]:g} {unit}".rstrip()
    return Field(key, meaning, expected, lambda v: _number_in(v, *span), required, unit, span)


def numbers(
    key: str, meaning: str, count: int | None, largest: float, unit: str = "", *, required: bool = False
) -> Field[Array]:
    """A list of finite numbers.

    Args:
        key: Its name.
        meaning: For the documentation.
        count: How many there are; None for any number of them.
        largest: Bound of their size.
        unit: Their unit; empty for pure numbers.
        required: True where the table is refused without it.
    """

    def read(value: object) -> Array | None:
        found = [_number_in(one, -largest, largest) for one in value] if isinstance(value, list) else [None]
        wrong = None in found or len(found) != (len(found) if count is None else count)
        return None if wrong else np.array(found, dtype=float)

    expected = f"{'a list of' if count is None else count} numbers of at most {largest:g} {unit}".rstrip()
    return Field(key, meaning, expected, read, required, unit)


def rows(key: str, meaning: str, width: int, largest: float, unit: str = "") -> Field[Array]:
    """Rows of finite numbers, read as (rows, width).

    Args:
        key: Its name.
        meaning: For the documentation.
        width: Number of numbers in a row.
        largest: Bound of their size.
        unit: Their unit; empty for pure numbers.
    """
    row = numbers(key, meaning, width, largest, unit)

    def read(value: object) -> Array | None:
        found = [row.parse(one) for one in value] if isinstance(value, list) else [None]
        known = [one for one in found if one is not None]
        return np.array(known).reshape(-1, width) if len(known) == len(found) else None

    return Field(key, meaning, f"rows of {row.expected}", read, unit=unit)


def texts(key: str, meaning: str, *, required: bool = False) -> Field[tuple[str, ...]]:
    """A list of texts.

    Args:
        key: Its name.
        meaning: For the documentation.
        required: True where the table is refused without it.
    """

    def read(value: object) -> tuple[str, ...] | None:
        listed = isinstance(value, list | tuple) and all(isinstance(one, str) for one in value)
        return tuple(value) if listed else None  # type: ignore[arg-type]

    return Field(key, meaning, "a list of texts", read, required)


def part(key: str, meaning: str, form: str, *, required: bool = False) -> Field[object]:
    """Tables under a key, which a reader takes with :meth:`mbkf.io.toml.Entries.tables` or ``list_of_tables``.

    Args:
        key: Its name.
        meaning: For the documentation.
        form: How the file writes it, such as "[[trial]]".
        required: True where the table is refused without it.
    """
    return Field(key, meaning, form, lambda value: value, required)


def number_of(text: str) -> float | None:
    """A number as programs write it; None for a decimal comma, a unit, and anything else."""
    match = _NUMBER.fullmatch(text)
    return None if match is None or match[2] or "," in match[1] else float(match[1])


def shown(value: object) -> str:
    """A wrong value for a message, cut where it is long."""
    text = str(value)
    return text if len(text) <= _SHOWN else text[:_SHOWN] + " …"


def _number_in(value: object, low: float, high: float) -> float | None:
    """A finite number between two others, None for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if low <= value <= high and math.isfinite(value) else None


def _day(value: object) -> str | None:
    """A day from 1850 on in the form of ISO 8601, None for anything else."""
    text = value.isoformat() if isinstance(value, date) else value
    if not isinstance(text, str) or not _DAY.fullmatch(text):
        return None
    try:
        return text if date.fromisoformat(text).year >= FIRST_YEAR else None
    except ValueError:
        return None
