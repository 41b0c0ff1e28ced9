"""Files of a laboratory's own reference bands, ``norms.toml``: mean and spread between persons over the gait cycle."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass
from pathlib import Path

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError
from mbkf.io import fields
from mbkf.io.fields import Field
from mbkf.io.toml import Entries, write_toml

FORMAT, FORMAT_VERSION = "mbkf norms", 1

POINTS = 101
"""Points of a curve: 0, 1, … 100 % of the cycle."""

LARGEST = 1e6
"""Largest number of a band."""

CurveName = tuple[str, str, str]
"""Kind of movement ("walk"), quantity ("angle", "torque", "power", "reaction") and coordinate without its side."""


_NAME = fields.text("name", "name in reports; of the coordinate or parameter", required=True, empty=True)
_KIND = fields.text("kind", "kind of movement", required=True, empty=True)
_QUANTITY = fields.text("quantity", "angle, torque, power or reaction", required=True, empty=True)
_UNIT = fields.text("unit", "unit of mean and spread", required=True, empty=True)
_PERSONS: Field[int] = Field(
    "persons",
    "number of persons",
    "a whole number of 1 or more",
    lambda v: v if isinstance(v, int) and not isinstance(v, bool) and v >= 1 else None,
    required=True,
)
_CURVE_MEAN = fields.numbers("mean", "mean over the cycle, at 0, 1, … 100 %", POINTS, LARGEST, required=True)
_CURVE_SD = fields.numbers("sd", "standard deviation between persons", POINTS, LARGEST, required=True)
_MEASURE_MEAN = fields.numbers("mean", "mean", 1, LARGEST, required=True)
_MEASURE_SD = fields.numbers("sd", "standard deviation between persons", 1, LARGEST, required=True)
CURVE = fields.record("curve", _KIND, _QUANTITY, _NAME, _UNIT, _PERSONS, _CURVE_MEAN, _CURVE_SD)
MEASURE = fields.record("measure", _KIND, _NAME, _UNIT, _PERSONS, _MEASURE_MEAN, _MEASURE_SD)
_CURVES = fields.part("curve", "a band over the cycle", "[[curve]]")
_MEASURES = fields.part("measure", "a band of a spatiotemporal parameter", "[[measure]]")
NORMS = fields.record(
    "norms",
    fields.text("format", "kind of the file", required=True),
    fields.number("format_version", "version of the format", required=True),
    _NAME,
    _CURVES,
    _MEASURES,
)
"""Entries of a file of norms."""


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
        UnknownEntry: The file has an entry that norms do not have.
        FileFormatError: The file is missing or damaged, or holds something else.
    """
    read = Entries.of_file(NORMS, path, "a file of norms", "make one with 'mbkf norms build'")
    if read.table.get("format") != FORMAT or read.table.get("format_version") != FORMAT_VERSION:
        raise FileFormatError(read.file, "not a file of norms; make one with 'mbkf norms build'")
    curves: dict[CurveName, Band] = {}
    for one in read.list_of_tables(_CURVES, CURVE) or ():
        key = one.need(_KIND), one.need(_QUANTITY), one.need(_NAME)
        _refuse_second(one, key, curves)
        curves[key] = _band(one, _CURVE_MEAN, _CURVE_SD)
    measures: dict[tuple[str, str], Band] = {}
    for one in read.list_of_tables(_MEASURES, MEASURE) or ():
        pair = one.need(_KIND), one.need(_NAME)
        _refuse_second(one, pair, measures)
        measures[pair] = _band(one, _MEASURE_MEAN, _MEASURE_SD)
    return Norms(read.need(_NAME), curves, measures)


def _refuse_second(read: Entries, key: tuple[str, ...], known: Container[object]) -> None:
    if key in known:
        raise read.fault(f"{' '.join(key)} stands twice; keep one of both")


def _band_table(band: Band) -> dict[str, object]:
    mean, sd = ([float(f"{value:.6g}") for value in values] for values in (band.mean, band.sd))
    return {"unit": band.unit, "persons": band.persons, "mean": mean, "sd": sd}


def _band(read: Entries, mean: Field[Array], sd: Field[Array]) -> Band:
    spread = read.need(sd)
    if (spread < 0.0).any():
        raise read.fault("sd must not be negative", sd.key)
    return Band(read.need(_UNIT), read.need(_PERSONS), read.need(mean), spread)
