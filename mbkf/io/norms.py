"""Files of a laboratory's own reference bands, ``norms.toml``: mean and spread between persons over the gait cycle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError
from mbkf.io.toml import Entries, write_toml

FORMAT, FORMAT_VERSION = "mbkf norms", 1

POINTS = 101
"""Points of a curve: 0, 1, … 100 % of the cycle."""

LARGEST = 1e6
"""Largest number of a band."""

CurveName = tuple[str, str, str]
"""Kind of movement ("walk"), quantity ("angle", "torque", "power", "reaction") and coordinate without its side."""


@dataclass(frozen=True)
class Band:
    """A reference: mean and standard deviation between persons.

    Attributes:
        unit: Of mean and spread.
        persons: Number of persons.
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
        name: Their name in reports.
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
    curves = [
        {"kind": kind, "quantity": quantity, "name": name, **_band_table(band)}
        for (kind, quantity, name), band in norms.curves.items()
    ]
    measures = [
        {"kind": kind, "name": name, **_band_table(band)} for (kind, name), band in norms.measures.items()
    ]
    head = {"format": FORMAT, "format_version": FORMAT_VERSION, "name": norms.name}
    write_toml(
        path,
        "Reference bands of a laboratory, written by mbkf.",
        {**head, "curve": curves, "measure": measures},
    )


def read_norms(path: str | Path) -> Norms:
    """Reads norms.

    Raises:
        FileFormatError: The file is missing or damaged, or holds something else.
    """
    read = Entries.of_file(path, "a file of norms", "make one with 'mbkf norms build'")
    if read.table.get("format") != FORMAT or read.table.get("format_version") != FORMAT_VERSION:
        raise FileFormatError(read.file, "not a file of norms; make one with 'mbkf norms build'")
    curves = {
        (_text(one, "kind"), _text(one, "quantity"), _text(one, "name")): _band(one, POINTS)
        for one in read.list_of_tables("curve") or ()
    }
    measures = {
        (_text(one, "kind"), _text(one, "name")): _band(one, 1)
        for one in read.list_of_tables("measure") or ()
    }
    return Norms(_text(read, "name"), curves, measures)


def _band_table(band: Band) -> dict[str, object]:
    mean, sd = ([float(f"{value:.6g}") for value in values] for values in (band.mean, band.sd))
    return {"unit": band.unit, "persons": band.persons, "mean": mean, "sd": sd}


def _text(read: Entries, key: str) -> str:
    return read.required(key, read.text(key, empty=True))


def _band(read: Entries, points: int) -> Band:
    persons = read.table.get("persons")
    if not isinstance(persons, int) or isinstance(persons, bool) or persons < 1:
        raise FileFormatError(read.file, "persons must be a whole number of 1 or more")
    mean, sd = (read.required(key, read.numbers(key, points, LARGEST)) for key in ("mean", "sd"))
    if (sd < 0.0).any():
        raise FileFormatError(read.file, "sd must not be negative")
    return Band(_text(read, "unit"), persons, mean, sd)
