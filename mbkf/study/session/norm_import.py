"""Norms of other tools as norms of mbkf: statements that they need, names, units and signs, 101 points of the cycle.

Curves are read in the convention that is stated with them; a name that states the direction in which it is positive
("knee extension") decides over the convention's sign, and the curve is turned. Means between the file's points are
those of a cubic spline, standard deviations those of a monotone one, which stays positive (F. N. Fritsch and R. E.
Carlson, SIAM J. Numer. Anal. 17 (1980) 238-246).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput
from mbkf.io.norm_files.labels import ANGLE, EXTERNAL, INTERNAL, POWER, REACTION, TORQUE, NamedCurve, curve_of
from mbkf.io.norm_files.raw import MEASURE, NAMES, OWN, RawBand, RawNorms
from mbkf.io.norms import POINTS, Band, CurveName, Norms, Span, Speeds
from mbkf.trial.gait.convention import (
    BY_CLINIC,
    CLINICAL,
    FOOT_PROGRESSION,
    TRUNK,
    Convention,
    convention_of,
)

UNITS: Mapping[str, tuple[str, str, float]] = {
    "deg": (ANGLE, "deg", 1.0), "°": (ANGLE, "deg", 1.0), "degree": (ANGLE, "deg", 1.0),
    "degrees": (ANGLE, "deg", 1.0), "rad": (ANGLE, "deg", 180.0 / np.pi),
    "nm/kg": (TORQUE, "N m/kg", 1.0), "nmm/kg": (TORQUE, "N m/kg", 1e-3),
    "w/kg": (POWER, "W/kg", 1.0), "mw/kg": (POWER, "W/kg", 1e-3),
    "%bw": (REACTION, "% BW", 1.0), "bw": (REACTION, "% BW", 100.0),
    "n/kg": (REACTION, "% BW", 100.0 / GRAVITY_M_S2),
}  # fmt: skip
"""Quantity, unit in reports and factor to it, by a unit in small letters without blanks and points."""

SUPPOSED = {ANGLE: "deg", POWER: "W/kg"}
"""Units of curves without one; moments and reactions are stated in several."""

LEAST_POINTS, MOST_RADIANS = 20, 3.2
"""A cycle of fewer points is no curve; angles that never exceed π may be in radians."""

AXES = {"clinical": "pig", "isb": "isb", "model": "model"}
"""Axes of a convention's angles, where nothing else is stated."""


LACKING: Mapping[str, str] = {
    "convention": "'# convention: clinical' (or isb, model) for its axes and signs",
    "source": "'# source: paper or laboratory'",
    "persons": "'# persons: 30'",
    "ages": "'# age: 20-40' (years)",
    "speeds": "'# speed: 1.1-1.4' (m/s)",
}
"""Lines that state a missing fact at the top of a table, by the fact's name in :class:`Statements`."""


@dataclass(frozen=True)
class Statements:
    """Facts about norms that their file may lack; empty or None where the file states them.

    Attributes:
        name: How reports call them.
        source: Paper, laboratory or data set that they are from.
        convention: "clinical", "isb" or "model".
        moments: "internal" or "external", of moments whose names state a direction alone.
        persons: Number of persons.
        ages, speeds: Of the persons, in years and m/s.
        unit: Of moments without one.
        groups: Groups of the file: speeds that the band of each is for, None for the one that stands for all speeds.
    """

    name: str = ""
    source: str = ""
    convention: str = ""
    moments: str = ""
    persons: int = 0
    ages: Span | None = None
    speeds: Span | None = None
    unit: str = ""
    groups: Mapping[str, Speeds | None] | None = None


@dataclass(frozen=True)
class ImportedNorms:
    """Norms from a file.

    Attributes:
        norms: They.
        turned: Names of curves whose sign was turned.
        left_out: Names of curves that are not in them, with the reason.
    """

    norms: Norms
    turned: tuple[str, ...]
    left_out: tuple[str, ...]


def span_of(text: str) -> Span:
    """Two numbers such as "20-40" or "1,1–1,4"; one number is both.

    Raises:
        InvalidInput: The text is something else.
    """
    found = re.fullmatch(r"\s*(\d+(?:[.,]\d+)?)\s*(?:(?:-|–|to|a)\s*(\d+(?:[.,]\d+)?))?\D*", text)
    if found is None:
        raise InvalidInput(f"'{text}' is no range; write two numbers, such as 20-40")
    low, high = (float((one or found[1]).replace(",", ".")) for one in found.groups())
    if low > high:
        raise InvalidInput(f"'{text}' begins with the greater number; write {high:g}-{low:g}")
    return low, high


def completed(raw: RawNorms, stated: Statements) -> Statements:
    """The statements, with those of the file where one is missing.

    Args:
        raw: The file's norms.
        stated: What is stated besides; it decides over the file's own statements.

    Raises:
        InvalidInput: Ages or speeds of the file are no range.
    """
    said = raw.statements
    counts = [one.persons for one in raw.bands]
    return replace(
        stated,
        source=stated.source or said.get("source", ""),
        convention=stated.convention or said.get("convention", "").lower(),
        persons=stated.persons or _count(said.get("persons", "")) or min(counts, default=0),
        ages=stated.ages or _span(said.get("age", "")),
        speeds=stated.speeds or _span(said.get("speed", "")),
        moments=stated.moments or said.get("moments", "").lower(),
    )


def missing_facts(stated: Statements) -> tuple[str, ...]:
    """Names of the facts without which bands could be misread and that are not stated, of :data:`LACKING`."""
    return tuple(name for name in LACKING if not getattr(stated, name))


def imported(raw: RawNorms, stated: Statements) -> ImportedNorms:
    """The norms of a file.

    Args:
        raw: The file's.
        stated: What is stated besides; it decides over the file's own statements.

    Raises:
        InvalidInput: A statement lacks, or no curve is left.
    """
    facts = _Facts.of(raw, stated)
    curves: dict[CurveName, Band] = {}
    by_speed: dict[Speeds, dict[CurveName, Band]] = {}
    measures: dict[tuple[str, str], Band] = {}
    turned, left_out = [], []
    for band in facts.chosen(raw, stated.groups):
        title = " ".join(word for word in (band.label, band.component) if word)
        if band.quantity == MEASURE:
            measures[band.kind, band.label] = Band(
                band.unit, band.persons or facts.persons, band.mean, band.sd
            )
            continue
        found = _own(band, facts) if raw.statements.get(NAMES) == OWN else _curve(band, facts)
        if isinstance(found, str):
            left_out.append(f"{title}: {found}")
            continue
        key, made, sign = found
        speeds = band.speeds if stated.groups is None else stated.groups[band.group]
        here = curves if speeds is None else by_speed.setdefault(speeds, {})
        if key in here:
            raise InvalidInput(f"{title}: {key[1]} {key[2]} stands twice in the file; keep one of both")
        here[key] = made
        turned += [title] if sign < 0.0 else []
    if not curves:
        reasons = "; ".join(dict.fromkeys(left_out))
        raise InvalidInput(f"no curve is left of the file's {len(raw.bands)}: {reasons}")
    norms = Norms(
        facts.name, curves, measures, by_speed, source=facts.source, convention=facts.convention.name,
        axes=facts.axes, ages=facts.ages, speeds=facts.speeds,
    )  # fmt: skip
    return ImportedNorms(norms, tuple(dict.fromkeys(turned)), tuple(dict.fromkeys(left_out)))


@dataclass(frozen=True)
class _Facts:
    """Statements of an import, all of them known."""

    name: str
    source: str
    convention: Convention
    axes: str
    moments: str
    persons: int
    ages: Span | None
    speeds: Span | None
    unit: str

    @classmethod
    def of(cls, raw: RawNorms, stated: Statements) -> _Facts:
        """Those stated, else those of the file.

        Raises:
            InvalidInput: One lacks; the sentence to add is in the text.
        """
        said, facts = raw.statements, completed(raw, stated)
        if missing := missing_facts(facts):
            raise InvalidInput(
                f"the {raw.form} lacks statements without which its bands could be misread. Add these lines at the top "
                f"of a table, with your own values, or state them with the import: "
                f"{', '.join(LACKING[name] for name in missing)}"
            )
        convention, moments = facts.convention, facts.moments
        found = convention_of(convention, moments or INTERNAL)
        if moments == EXTERNAL and convention != CLINICAL:
            raise InvalidInput(
                "external moments belong to the clinical convention; state internal ones, or clinical"
            )
        axes = said.get("axes", "") or AXES[convention]
        if axes not in AXES.values():
            raise InvalidInput(f"axes '{axes}' are unknown; write one of {', '.join(AXES.values())}")
        name = stated.name or said.get("name", "") or facts.source
        unit = stated.unit or said.get("unit", "")
        return cls(name, facts.source, found, axes, moments, facts.persons, facts.ages, facts.speeds, unit)

    def chosen(self, raw: RawNorms, groups: Mapping[str, Speeds | None] | None) -> Sequence[RawBand]:
        """The bands of the groups that are asked for.

        Raises:
            InvalidInput: The file has several groups and not one is asked for, or another one.
        """
        if groups is None:
            if len(raw.groups) > 1:
                raise InvalidInput(
                    f"the {raw.form} has the groups {', '.join(raw.groups)}; state the one to import, others with "
                    "the speeds that they are for"
                )
            return raw.bands
        unknown = [name for name in groups if name not in raw.groups]
        if unknown:
            raise InvalidInput(
                f"the {raw.form} has no group '{unknown[0]}'; its groups are {', '.join(raw.groups)}"
            )
        return [one for one in raw.bands if one.group in groups]


def _count(text: str) -> int:
    return int(text) if text.isdecimal() and len(text) < 7 else 0


def _span(text: str) -> Span | None:
    return span_of(text) if text else None


def _own(band: RawBand, facts: _Facts) -> tuple[CurveName, Band, float] | str:
    """Key and band of a curve that has mbkf's name, unit and sign, or the reason that it is left out."""
    if len(band.mean) != POINTS or (band.sd < 0.0).any():
        return f"it has {len(band.mean)} points of {POINTS}, or a negative standard deviation"
    persons = band.persons or facts.persons
    return (band.kind, band.quantity, band.label), Band(band.unit, persons, band.mean, band.sd), 1.0


def _curve(band: RawBand, facts: _Facts) -> tuple[CurveName, Band, float] | str:
    """Key, band and sign of a curve, or the reason that it is left out."""
    named = curve_of(band.label, band.component, band.quantity)
    if named is None:
        return "no curve of mbkf has this name"
    if named.name in (FOOT_PROGRESSION, *TRUNK) and not facts.convention.walking:
        return f"the convention {facts.convention.name} has no such curve"
    unit = band.unit or SUPPOSED.get(named.quantity) or (facts.unit if named.quantity == TORQUE else "")
    quantity, shown, factor = UNITS.get(re.sub(r"[\s.·*()]", "", unit).lower(), ("", "", 0.0))
    if quantity != named.quantity:
        return f"its unit '{unit}' is not known; state one" if unit else "its unit is not stated"
    sign = _sign(named, facts)
    if isinstance(sign, str):
        return sign
    points = _points(band.percent, band.mean, band.sd)
    if isinstance(points, str):
        return points
    mean, sd = factor * points[0], abs(factor) * points[1]
    if (
        not band.unit
        and named.quantity == ANGLE
        and float(np.abs(mean).max()) <= MOST_RADIANS
        and _swings(named)
    ):
        return f"its values, {np.abs(mean).max():.2g} at most, may be radians; state the unit"
    persons = band.persons or facts.persons
    return (band.kind, named.quantity, named.name), Band(shown, persons, sign * mean, sd), sign


def _swings(named: NamedCurve) -> bool:
    """True of the angles that exceed a few degrees in every gait."""
    return named.name in ("hip_flexion", "knee_angle", "ankle_angle")


def _sign(named: NamedCurve, facts: _Facts) -> float | str:
    """Factor from the file's values to the convention's, or the reason that it is not known."""
    c = facts.convention
    if named.quantity == REACTION:
        return float(named.sense or 1)
    if named.sense is None or named.quantity == POWER:
        return 1.0
    if named.quantity == ANGLE:
        return named.sense * BY_CLINIC.angle_sign(named.name) * c.angle_sign(named.name)
    frame = named.frame or facts.moments
    if not frame:
        return "it is not stated whether moments are internal or external"
    towards = named.sense if frame == INTERNAL else -named.sense
    return towards * c.moment_sign(named.name)


def _points(percent: Array, mean: Array, sd: Array) -> tuple[Array, Array] | str:
    """Mean and spread at 0, 1, … 100 %, or the reason that they are not known."""
    from scipy.interpolate import CubicSpline, PchipInterpolator

    if len(percent) < LEAST_POINTS:
        return f"it has {len(percent)} points, a cycle needs {LEAST_POINTS}"
    at = 100.0 * percent if percent.max() <= 1.0 else percent
    if not (np.diff(at) > 0.0).all():
        return "its per cent of the cycle do not increase"
    if abs(at[0]) > 0.5 or abs(at[-1] - 100.0) > 0.5:
        return f"it reaches from {at[0]:g} to {at[-1]:g} %, not from 0 to 100"
    if (sd < 0.0).any():
        return "a standard deviation is negative"
    if not sd.any():
        return "it has no spread"
    wanted = np.linspace(0.0, 100.0, POINTS)
    if len(at) == POINTS and np.allclose(at, wanted, atol=1e-6):
        return mean, sd
    return np.asarray(CubicSpline(at, mean)(wanted)), np.asarray(PchipInterpolator(at, sd)(wanted))
