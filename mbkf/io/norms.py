"""Files of a laboratory's own reference bands, ``norms.toml``: mean and spread between persons over the gait cycle."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError
from mbkf.io import fields
from mbkf.io.fields import Field
from mbkf.io.toml import Entries, write_toml

FORMAT, FORMAT_VERSION = "mbkf norms", 1

POINTS = 101
"""Points of a curve: 0, 1, … 100 % of the cycle."""

GDI_POINTS = 51
"""Points of a variable in a feature of the gait deviation index: 0, 2, … 100 % of the cycle."""

LARGEST = 1e6
"""Largest number of a band."""

CurveName = tuple[str, str, str]
"""Kind of movement ("walk"), quantity ("angle", "torque", "power", "reaction") and coordinate without its side."""


_NAME = fields.text("name", "name in reports; of the coordinate or parameter", required=True, empty=True)
_KIND = fields.text("kind", "kind of movement", required=True, empty=True)
_CONVENTION = fields.text("convention", "convention of the curves: clinical, isb or model (model)")
_AXES = fields.text("axes", "axes of the angles: pig, isb or model (model)")
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
_SPEEDS = fields.numbers(
    "speed_m_s", "speeds that the band is for: from the first to below the second", 2, 20.0, "m/s"
)
CURVE = fields.record("curve", _KIND, _QUANTITY, _NAME, _UNIT, _PERSONS, _CURVE_MEAN, _CURVE_SD, _SPEEDS)
MEASURE = fields.record("measure", _KIND, _NAME, _UNIT, _PERSONS, _MEASURE_MEAN, _MEASURE_SD)
_SOURCE = fields.text("source", "paper or file that the bands are from", empty=True)
_PERSON_NAME = fields.text("name", "name or code", required=True)
_SEX = fields.text("sex", "as the session states it", required=True)
_AGE = fields.number("age", "age", (0.0, 130.0), "years", required=True)
_SPEED = fields.number("speed_m_s", "mean walking speed", (0.0, 20.0), "m/s", required=True)
_CYCLES: Field[int] = Field(
    "cycles", "gait cycles that count", _PERSONS.expected, _PERSONS.parse, required=True
)
PERSON = fields.record("person", _PERSON_NAME, _SEX, _AGE, _SPEED, _CYCLES)
_VARIABLES = fields.texts(
    "variables", "coordinates without their side, in the order of a feature", required=True
)
_FEATURES = fields.numbers(
    "features",
    "unit vectors over the variables at 0, 2, … 100 %, one after the other",
    None,
    LARGEST,
    required=True,
)
_CENTRE = fields.numbers("centre", "mean of the controls along the features", None, LARGEST, required=True)
_LN_MEAN = fields.number("ln_mean", "mean of the logarithm of the controls' distances", required=True)
_LN_SD = fields.number("ln_sd", "standard deviation of these", (1e-9, LARGEST), required=True)
GDI = fields.record("gdi", _VARIABLES, _FEATURES, _CENTRE, _LN_MEAN, _LN_SD)
_GDI = fields.part("gdi", "the gait deviation index of walks", "[gdi]")
_AGES = fields.numbers("age_years", "ages of the persons, the least and the greatest", 2, 130.0, "years")
_RANGE = fields.numbers(
    "speed_m_s", "walking speeds of the persons, the least and the greatest", 2, 20.0, "m/s"
)
_PERSON_LIST = fields.part("person", "a person that the bands are of", "[[person]]")
_CURVES = fields.part("curve", "a band over the cycle", "[[curve]]")
_MEASURES = fields.part("measure", "a band of a spatiotemporal parameter", "[[measure]]")
NORMS = fields.record(
    "norms",
    fields.text("format", "kind of the file", required=True),
    fields.number("format_version", "version of the format", required=True),
    _NAME,
    _CONVENTION,
    _AXES,
    _SOURCE,
    _AGES,
    _RANGE,
    _PERSON_LIST,
    _CURVES,
    _MEASURES,
    _GDI,
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
class NormPerson:
    """A person that norms are of.

    Attributes:
        name: Name or code.
        sex: As stated.
        age: In years.
        speed_m_s: Mean walking speed.
        cycles: Number of cycles, both sides together.
    """

    name: str
    sex: str
    age: float
    speed_m_s: float
    cycles: int


@dataclass(frozen=True)
class GdiBasis:
    """Basis of the gait deviation index, of controls (M. H. Schwartz and A. Rozumalski, Gait Posture 28 (2008)).

    Attributes:
        variables: Coordinates without their side, in the order of a feature.
        features: (F, 51 V) unit vectors over the variables, each at 0, 2, … 100 % of the cycle.
        centre: (F,) mean of the controls along the features.
        ln_mean, ln_sd: Mean and standard deviation of the logarithm of the controls' distances from it.
    """

    variables: tuple[str, ...]
    features: Array
    centre: Array
    ln_mean: float
    ln_sd: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "features", read_only(self.features))
        object.__setattr__(self, "centre", read_only(self.centre))


Span = tuple[float, float]
"""Least and greatest of ages or speeds."""

Speeds = Span
"""Speeds that a band is for, m/s: from the first to below the second."""


@dataclass(frozen=True)
class Norms:
    """The reference bands of a laboratory.

    Attributes:
        name: Their name in reports.
        curves: Bands over the cycle.
        measures: Of spatiotemporal parameters and scores, by kind of movement and name.
        by_speed: Bands over the cycle of persons that walk at these speeds.
        persons: Whom they are of; empty where only the source knows.
        source: Paper or file that they are from; empty for the laboratory's own.
        gdi: For the gait deviation index; None without.
        convention: Of the curves: "clinical", "isb" or "model".
        axes: Axes that angles are read in: "pig", "isb" or "model".
        ages, speeds: Of the persons, in years and m/s; None where not stated.
    """

    name: str
    curves: Mapping[CurveName, Band]
    measures: Mapping[tuple[str, str], Band]
    by_speed: Mapping[Speeds, Mapping[CurveName, Band]] = field(default_factory=dict)
    persons: tuple[NormPerson, ...] = ()
    source: str = ""
    gdi: GdiBasis | None = None
    convention: str = "model"
    axes: str = "model"
    ages: Span | None = None
    speeds: Span | None = None

    @property
    def read(self) -> tuple[str, str]:
        """Convention and axes: curves are compared with those of the same ones."""
        return self.convention, self.axes

    def at_speed(self, speed_m_s: float) -> Norms:
        """The norms with the curves of persons that walk at a speed, where there are any, and the speeds in the name.

        Args:
            speed_m_s: The speed; NaN where it is not known.
        """
        for (low, high), curves in self.by_speed.items():
            if low <= speed_m_s < high:
                name = f"{self.name}, {low:.1f}–{high:.1f} m/s"
                return replace(self, name=name, curves={**self.curves, **curves})
        return self


def write_norms(norms: Norms, path: str | Path) -> None:
    """Writes norms, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """

    def tables(curves: Mapping[CurveName, Band], speeds: Speeds | None) -> list[dict[str, object]]:
        more = {} if speeds is None else {"speed_m_s": list(speeds)}
        return [
            {"kind": kind, "quantity": quantity, "name": name, **_band_table(band), **more}
            for (kind, quantity, name), band in curves.items()
        ]

    head: dict[str, object] = {"format": FORMAT, "format_version": FORMAT_VERSION, "name": norms.name}
    if norms.source:
        head["source"] = norms.source
    for field_, span in ((_AGES, norms.ages), (_RANGE, norms.speeds)):
        if span is not None:
            head[field_.key] = list(span)
    by_speed = [one for speeds, curves in norms.by_speed.items() for one in tables(curves, speeds)]
    measures = [
        {"kind": kind, "name": name, **_band_table(band)} for (kind, name), band in norms.measures.items()
    ]
    table = {
        **head,
        "convention": norms.convention,
        "axes": norms.axes,
        "person": [asdict(one) for one in norms.persons],
        "curve": [*tables(norms.curves, None), *by_speed],
        "measure": measures,
    }
    if norms.gdi is not None:
        table["gdi"] = _gdi_table(norms.gdi)
    write_toml(path, "Reference bands of a laboratory, written by mbkf.", table)


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
    by_speed: dict[Speeds, dict[CurveName, Band]] = {}
    for one in read.list_of_tables(_CURVES, CURVE) or ():
        key = one.need(_KIND), one.need(_QUANTITY), one.need(_NAME)
        speeds = one.get(_SPEEDS)
        if speeds is not None and not speeds[0] < speeds[1]:
            raise one.fault(f"speed_m_s {speeds.tolist()} needs the lower speed first")
        here = curves if speeds is None else by_speed.setdefault((float(speeds[0]), float(speeds[1])), {})
        _refuse_second(one, key, here)
        here[key] = _band(one, _CURVE_MEAN, _CURVE_SD)
    measures: dict[tuple[str, str], Band] = {}
    for one in read.list_of_tables(_MEASURES, MEASURE) or ():
        pair = one.need(_KIND), one.need(_NAME)
        _refuse_second(one, pair, measures)
        measures[pair] = _band(one, _MEASURE_MEAN, _MEASURE_SD)
    persons = tuple(_person(one) for one in read.list_of_tables(_PERSON_LIST, PERSON) or ())
    return Norms(
        read.need(_NAME),
        curves,
        measures,
        by_speed,
        persons,
        read.get(_SOURCE) or "",
        _gdi(read.table_of(_GDI, GDI)),
        read.get(_CONVENTION) or "model",
        read.get(_AXES) or "model",
        _span(read, _AGES),
        _span(read, _RANGE),
    )


def _span(read: Entries, field_: Field[Array]) -> Span | None:
    """Two numbers in order; None without the entry."""
    found = read.get(field_)
    if found is None:
        return None
    if found[0] > found[1]:
        raise read.fault("the lesser number comes first", field_.key)
    return float(found[0]), float(found[1])


def _refuse_second(read: Entries, key: tuple[str, ...], known: Container[object]) -> None:
    if key in known:
        raise read.fault(f"{' '.join(key)} stands twice; keep one of both")


def _person(read: Entries) -> NormPerson:
    return NormPerson(
        read.need(_PERSON_NAME), read.need(_SEX), read.need(_AGE), read.need(_SPEED), read.need(_CYCLES)
    )


def _gdi(read: Entries | None) -> GdiBasis | None:
    """The basis of a table whose sizes agree."""
    if read is None:
        return None
    features, centre, variables = read.need(_FEATURES), read.need(_CENTRE), read.need(_VARIABLES)
    if features.size != len(centre) * GDI_POINTS * len(variables) or not features.size:
        raise read.fault("features, centre and variables have different sizes; build the norms again")
    return GdiBasis(
        variables, features.reshape(len(centre), -1), centre, read.need(_LN_MEAN), read.need(_LN_SD)
    )


def _gdi_table(basis: GdiBasis) -> dict[str, object]:
    """A basis as plain data, to 9 digits."""

    def plain(values: Array) -> list[float]:
        return [float(f"{value:.9g}") for value in values]

    return {
        "variables": list(basis.variables),
        "features": plain(basis.features.ravel()),
        "centre": plain(basis.centre),
        "ln_mean": basis.ln_mean,
        "ln_sd": basis.ln_sd,
    }


def _band_table(band: Band) -> dict[str, object]:
    mean, sd = ([float(f"{value:.6g}") for value in values] for values in (band.mean, band.sd))
    return {"unit": band.unit, "persons": band.persons, "mean": mean, "sd": sd}


def _band(read: Entries, mean: Field[Array], sd: Field[Array]) -> Band:
    spread = read.need(sd)
    if (spread < 0.0).any():
        raise read.fault("sd must not be negative", sd.key)
    return Band(read.need(_UNIT), read.need(_PERSONS), read.need(mean), spread)
