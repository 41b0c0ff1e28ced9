"""Wrong masses, plates that are late, turned, mirrored or read too much, and how they are told."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from benchmarks.checks import Check, information
from benchmarks.quality.spoilt import Followed
from mbkf.io.findings import Finding
from mbkf.io.records import PlateReadings
from mbkf.trial.checks import clocks, gains, mass, newton
from mbkf.trial.checks.clocks import delayed
from mbkf.trial.checks.orientation import laid

MASSES = (0.75, 0.9, 1.1, 1.3)
DELAYS_MS = (10.0, 20.0, 40.0)
GAINS = (0.9, 1.1)
MASS_PERCENT, LAG_MS = 2.0, 3.0

ALL_AT_ONCE = ("squat",)
"""Motions with both feet on two plates throughout: one plate's gain is no longer told apart from the mass."""

DELAY_UNKNOWN = ("biomechzoo HC032A", "biomechzoo HC044A", "gaitalytics")
"""Captures of 0.9 to 1.5 s that are found 6 to 8 ms late as they are, which may be true: what is added counts there.
Elsewhere plates are taken to be in time, as they are in synthetic captures."""

Findings = Sequence[Finding]


def fault_rows(one: Followed, bounded: bool) -> Iterator[Check]:
    """All faults of one capture.

    Args:
        one: The capture.
        bounded: Whether bounds hold; else numbers are shown for information.
    """
    right = one.judged()
    causes = (clocks.NAME, gains.NAME, mass.NAME)
    yield _at_most(
        f"{one.name}: checks that accuse the capture as it is", len(outside(right)), 0, bounded, ""
    )
    yield information(f"{one.name}: force that plates lack", number(right, newton.FORCE), "% BW")
    yield information(f"{one.name}: moment that plates lack", number(right, newton.MOMENT), "% BW m")
    by_mass = [one.judged(mass_factor=factor) for factor in MASSES]
    off = max(abs(better(found) / one.subject.mass_kg - 1.0) for found in (right, *by_mass))
    yield _at_most(f"{one.name}: mass by the plates, worst of five", 100.0 * off, MASS_PERCENT, bounded, "%")
    yield _told(f"{one.name}: wrong masses told", [mass.NAME in outside(found) for found in by_mass], bounded)
    by_delay = [one.judged(plates=delayed(one.plates, 1e-3 * ms)) for ms in DELAYS_MS]
    own = number(right, clocks.NAME)
    before = own if one.name in DELAY_UNKNOWN else 0.0
    lags = [abs(number(f, clocks.NAME) - before - ms) for f, ms in zip(by_delay, DELAYS_MS, strict=True)]
    yield information(f"{one.name}: delay as it is", own, "ms")
    yield _at_most(
        f"{one.name}: error of the delay, worst of three", max(lags, default=math.nan), LAG_MS, bounded, "ms"
    )
    yield _told(f"{one.name}: delays told", [clocks.NAME in outside(found) for found in by_delay], bounded)
    judged = [p for p, plate in enumerate(one.plates) if is_judged(right, plate)]
    for words, way in {
        "turned by 180°": (2, False),
        "mirrored": (0, True),
        "turned by 90°": (1, False),
    }.items():
        spoilt = {p: one.judged(plates=_with(one.plates, p, laid(one.plates[p], *way))) for p in judged}
        told = [_axes(one.plates[p]) in outside(found) for p, found in spoilt.items()]
        yield _told(f"{one.name}: a plate {words}, told", told, bounded)
    every = [one.judged(plates=[amplified(plate, gain) for plate in one.plates]) for gain in GAINS]
    yield _told(f"{one.name}: all gains off by 10 %, told", [mass.NAME in outside(f) for f in every], bounded)
    single = [
        one.judged(plates=_with(one.plates, p, amplified(one.plates[p], gain)))
        for p in judged
        for gain in GAINS
    ]
    told = [bool(outside(found) & set(causes)) for found in single]
    apart = bounded and not any(motion in one.name for motion in ALL_AT_ONCE) and len(one.plates) > 1
    yield _told(f"{one.name}: one gain off by 10 %, told", told, apart)


def outside(found: Findings) -> set[str]:
    """Names of checks that are outside."""
    return {one.name for one in found if one.verdict == "outside"}


def number(found: Findings, name: str) -> float:
    """A check's value, NaN where it is not judged."""
    value = next(one.value for one in found if one.name == name)
    return math.nan if value is None else value


def better(found: Findings) -> float:
    """The mass that plates say, NaN where they say none."""
    mass_kg = next(one.better for one in found if one.name == mass.NAME)
    return math.nan if mass_kg is None else mass_kg


def is_judged(found: Findings, plate: PlateReadings) -> bool:
    """Whether a plate's axes are judged."""
    return any(one.name == _axes(plate) and one.verdict != "not judged" for one in found)


def amplified(plate: PlateReadings, gain: float) -> PlateReadings:
    """A plate with a wrong gain."""
    return replace(plate, force_n=gain * plate.force_n, moment_nm=gain * plate.moment_nm)


def _axes(plate: PlateReadings) -> str:
    return f"axes of plate '{plate.name}'"


def _with(plates: Sequence[PlateReadings], p: int, plate: PlateReadings) -> list[PlateReadings]:
    return [plate if k == p else other for k, other in enumerate(plates)]


def _told(name: str, told: Sequence[bool], bounded: bool) -> Check:
    """Share of faults that are told, %; for information where there is none or no bound."""
    if not told or not bounded:
        return information(name, 100.0 * sum(told) / len(told) if told else math.nan, "%")
    return Check(name, 100.0 * sum(told) / len(told), 100.0, ">=", "%")


def _at_most(name: str, value: float, bound: float, bounded: bool, unit: str) -> Check:
    return Check(name, value, bound, "<=", unit) if bounded else information(name, value, unit)
