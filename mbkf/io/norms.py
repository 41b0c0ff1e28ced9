"""Files of a laboratory's own reference bands, ``norms.toml``: mean and spread between persons over the gait cycle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, TomlTable, read_only
from mbkf.errors import FileFormatError
from mbkf.io.atomic import replacing
from mbkf.io.plain_data import read_toml
from mbkf.io.text import toml_text

FORMAT, FORMAT_VERSION = "mbkf norms", 1

POINTS = 101
"""Points of a curve: 0, 1, … 100 % of the cycle."""

LARGEST = 1e6
"""No number of a band is larger."""

CurveName = tuple[str, str, str]
"""Kind of movement ("walk"), quantity ("angle", "torque", "power", "reaction") and coordinate without its side."""


@dataclass(frozen=True)
class Band:
    """A reference: what is usual, and how much persons differ.

    Attributes:
        unit: Of mean and spread.
        persons: How many persons it is from.
        mean, sd: (101,) of a curve, (1,) of a measure.
    """

    unit: str
    persons: int
    mean: Array
    sd: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", read_only(self.mean))
        object.__setattr__(self, "sd", read_only(self.sd))


@dataclass(frozen=True)
class Norms:
    """The reference bands of a laboratory.

    Attributes:
        name: As reports call them.
        curves: Bands over the cycle.
        measures: Of spatiotemporal parameters, by kind of movement and name.
    """

    name: str
    curves: Mapping[CurveName, Band]
    measures: Mapping[tuple[str, str], Band]


def write_norms(norms: Norms, path: str | Path) -> None:
    """Writes norms, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    lines = [f'format = "{FORMAT}"', f"format_version = {FORMAT_VERSION}", f"name = {toml_text(norms.name)}"]
    for (kind, quantity, name), band in norms.curves.items():
        lines += ["", "[[curve]]", *_words(kind=kind, quantity=quantity, name=name), *_numbers(band)]
    for (kind, name), band in norms.measures.items():
        lines += ["", "[[measure]]", *_words(kind=kind, name=name), *_numbers(band)]
    with replacing(path) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_norms(path: str | Path) -> Norms:
    """Reads norms.

    Raises:
        FileFormatError: The file is missing or damaged, or holds something else.
    """
    file = Path(path)
    try:
        table = read_toml(file)
    except (OSError, ValueError) as error:
        raise FileFormatError(file, f"is no file of norms ({error})") from error
    if table.get("format") != FORMAT or table.get("format_version") != FORMAT_VERSION:
        raise FileFormatError(file, "is no file of norms; make one with 'mbkf norms build'")
    name = table.get("name")
    if not isinstance(name, str):
        raise FileFormatError(file, "name must be a text")
    curves = {
        (_word(one, "kind", file), _word(one, "quantity", file), _word(one, "name", file)): _band(
            one, POINTS, file
        )
        for one in _tables(table, "curve", file)
    }
    measures = {
        (_word(one, "kind", file), _word(one, "name", file)): _band(one, 1, file)
        for one in _tables(table, "measure", file)
    }
    return Norms(name, curves, measures)


def _words(**words: str) -> list[str]:
    return [f"{key} = {toml_text(word)}" for key, word in words.items()]


def _numbers(band: Band) -> list[str]:
    mean, sd = (", ".join(f"{value:.6g}" for value in values) for values in (band.mean, band.sd))
    return [
        f"unit = {toml_text(band.unit)}",
        f"persons = {band.persons}",
        f"mean = [{_float(mean)}]",
        f"sd = [{_float(sd)}]",
    ]


def _float(numbers: str) -> str:
    """Whole numbers with a point, since an array of TOML may mix both but readers of other programs may not."""
    return ", ".join(n if any(c in n for c in ".en") else n + ".0" for n in numbers.split(", "))


def _tables(table: TomlTable, key: str, file: Path) -> list[TomlTable]:
    found = table.get(key, [])
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise FileFormatError(file, f"[[{key}]] must be tables")
    return found


def _word(table: TomlTable, key: str, file: Path) -> str:
    found = table.get(key)
    if not isinstance(found, str):
        raise FileFormatError(file, f"{key} must be a text")
    return found


def _band(table: TomlTable, points: int, file: Path) -> Band:
    persons = table.get("persons")
    if not isinstance(persons, int) or isinstance(persons, bool) or persons < 1:
        raise FileFormatError(file, "persons must be a whole number of 1 or more")
    mean, sd = (_row(table.get(key), key, points, file) for key in ("mean", "sd"))
    if (sd < 0.0).any():
        raise FileFormatError(file, "sd must not be negative")
    return Band(_word(table, "unit", file), persons, mean, sd)


def _row(found: object, key: str, points: int, file: Path) -> Array:
    numbers = found if isinstance(found, list) else []
    good = all(isinstance(n, int | float) and not isinstance(n, bool) and abs(n) <= LARGEST for n in numbers)
    if len(numbers) != points or not good:
        raise FileFormatError(file, f"{key} must be {points} numbers")
    return np.array(numbers, dtype=float)
