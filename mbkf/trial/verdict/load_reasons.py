"""Reasons against loads: plates and clocks against the motion, mass, forces that nothing explains, and poor motion."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from mbkf.io.findings import Finding
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.verdict import LOAD_PARTS, MOTION_PARTS, TITLES, Reason, Word, gravest
from mbkf.trial.checks import clocks, floor, gains, in_view, lengths, mass, newton, persons, places, rigidity
from mbkf.trial.verdict.evidence import Evidence
from mbkf.trial.verdict.motion_reasons import Bounds
from mbkf.trial.verdict.parts import LEGS, PELVIS, TRUNK

RIGHT, LEFT, OF_TRUNK = LOAD_PARTS


class Rule(NamedTuple):
    """The words on a check.

    Attributes:
        name: Beginning of its name.
        bounds: Sizes in the check's unit.
        means: Meaning for the results.
        do: Remedy.
        whole_body: True where it compares plates with the motion of the whole body, so that it counts only if the trunk
            is shown.
    """

    name: str
    bounds: Bounds
    means: str
    do: str
    whole_body: bool = True


RULES = (
    Rule(mass.NAME, Bounds(5.0, 15.0), "torques are those of another mass", "scale with the right mass"),
    Rule(
        "axes of ",
        Bounds(2.0, 3.0),
        "shear and centre of pressure point the wrong way",
        "correct the plate's corners and axes",
    ),
    Rule(
        "order of plates",
        Bounds(2.0, 3.0),
        "each foot has the load of the other",
        "exchange the plates' channels, or their corners",
    ),
    Rule(
        "place of plate",
        Bounds(75.0, 150.0),
        "torques are wrong by the force times this distance",
        "correct the plate's corners",
    ),
    Rule(
        "place of all plates",
        Bounds(50.0, 100.0),
        "torques are wrong by the force times this distance",
        "correct the plates' corners, or the origin of the markers",
    ),
    Rule(
        clocks.NAME,
        Bounds(12.0, 40.0),
        "loads belong to other frames",
        "shift the plates, or synchronise them",
    ),
    Rule(gains.NAME, Bounds(8.0, 20.0), "one plate reads too much or too little", "calibrate the plates"),
    Rule(
        floor.NAME,
        Bounds(120.0, math.inf),
        "centres of pressure act at the wrong height",
        "check the plate's height",
    ),
)
"""Words on checks outside their own bounds, by their size: right captures have plates 21 ms late, and soles
104 mm off on steps whose plates state the height of the floor."""

LAW_NAMES = (newton.FORCE, newton.MOMENT)
LAW = Bounds(2.0, 4.0)
"""Force or moment that plates lack, over their bound or the part that noise explains; at most 1.6 in right trials,
2.9 in a walk whose file states twice its rate."""

PLACES_LEAVE = 2.5
"""Displacement of a leg's markers over their usual spread from which its motion is not to be used."""

OTHER_PERSON = Bounds(persons.LOOK, persons.LEAVE)
"""Powers of ten for segment lengths of another person."""

CAUSE = 10.0
"""Weight of another person over that of other findings: it explains most of them, and stands before them."""

SPOILT = Bounds(0.0, 0.1)
"""Share of the frames that an unexplained force spoils."""

MASS_SHARE = Bounds(0.0, 0.15)
"""Unexplained force of a wrong mass, as a share of body weight: within it torques are wrong by as much."""


def load_reasons(evidence: Evidence, motion: Iterable[Reason]) -> Iterator[Reason]:
    """All reasons against loads that are shown.

    Args:
        evidence: The evidence.
        motion: Reasons against motions of parts, which loads rest on.
    """
    shown = [part for part in LOAD_PARTS if part not in evidence.unshown]
    found = [
        *_checks(evidence),
        *_unexplained(evidence),
        *_contacts(evidence),
        *_from_motion(list(motion)),
    ]
    yield from (one for one in found if one.part in shown)


def check_reasons(evidence: Evidence) -> Iterator[Reason]:
    """Reasons against motions by checks that need no plates.

    Args:
        evidence: The evidence.
    """
    yield from _another_person(evidence)
    outside = {one.name: one for one in evidence.checks if one.verdict == "outside"}
    second = outside.get(in_view.NAME)
    if second is not None:
        found, todo = second.hint.split(in_view.REMEDY)[0], in_view.REMEDY.removeprefix("; ")
        means = "names may pass from one person to the other, and plates may carry both"
        for part in MOTION_PARTS:
            if part not in evidence.unshown:
                yield Reason(part, "look", found, means, todo, _times(second))
    loose = outside.get(rigidity.NAME)
    if loose is not None:
        found, todo = _stated(loose, "check its name")
        part = evidence.part_of.get(loose.segment, PELVIS)
        means = "a marker came loose, or belongs to another segment"
        yield Reason(part, "look", found, means, todo, _times(loose))
    moved = outside.get(places.NAME)
    if moved is not None:
        found, todo = _stated(moved, "scale again")
        means, own = (
            "the body was scaled from other names, or another person",
            evidence.part_of.get(moved.segment),
        )
        leaves = _size(moved) >= PLACES_LEAVE
        for leg in LEGS:
            yield Reason(
                leg, "do not use" if leaves and leg == own else "look", found, means, todo, _times(moved)
            )
    uneven = outside.get(lengths.NAME)
    if uneven is not None:
        found, todo = _stated(uneven, "scale again")
        for leg in LEGS:
            yield Reason(
                leg, "look", found, "one leg may be scaled from exchanged markers", todo, _times(uneven)
            )


def _another_person(evidence: Evidence) -> Iterator[Reason]:
    """Segment lengths of another person concern all that the trial shows."""
    found = next((one for one in evidence.checks if one.name == persons.NAME), None)
    off = None if found is None else OTHER_PERSON.reached(_size(found))
    if found is None or off is None:
        return
    for part in MOTION_PARTS:
        if part not in evidence.unshown:
            yield Reason(
                part,
                off[0],
                f"segment lengths differ from the subject file's: {_stated(found, '')[0].partition(', ')[2]} "
                f"(10^{_size(found):.0f} to 1)",
                "it is probably the file of another person, or its static trial had exchanged names",
                "take the subject file of this person, or scale from a static trial",
                CAUSE * off[1],
            )


def _checks(evidence: Evidence) -> Iterator[Reason]:
    outside = [one for one in evidence.checks if one.verdict == "outside" and one.value is not None]
    explained = False
    for rule in RULES:
        own = [one for one in outside if one.name.startswith(rule.name)]
        if not own or (rule.whole_body and not evidence.trunk_shown):
            continue
        worst = max(own, key=_size)
        off = rule.bounds.reached(_size(worst))
        if off is None:
            continue
        explained = True
        more = f" (and {len(own) - 1} more plates)" if len(own) > 1 else ""
        for part in LOAD_PARTS:
            found, todo = _stated(worst, rule.do)
            yield Reason(part, off[0], found + more, rule.means, todo, off[1])
    if explained or not evidence.trunk_shown:
        return
    law = [one for one in outside if one.name in LAW_NAMES]
    gravest_law = max(law, key=_times, default=None)
    off = None if gravest_law is None else LAW.reached(_times(gravest_law))
    if gravest_law is not None and off is not None:
        found, todo = _stated(gravest_law, "check plates, clocks, mass and names")
        for part in LOAD_PARTS:
            yield Reason(part, off[0], found, "plates and motion contradict each other", todo, off[1])


def _unexplained(evidence: Evidence) -> Iterator[Reason]:
    """The largest unexplained force of each cause."""
    causes: Mapping[str, list[UnexplainedLoad]] = {}
    for one in evidence.unexplained:
        causes.setdefault(one.cause, []).append(one)  # type: ignore[attr-defined]
    for cause, loads in causes.items():
        worst = max(loads, key=lambda one: one.force_n)
        word, weight = _spoils(evidence, worst)
        own = {"right_foot": RIGHT, "left_foot": LEFT}.get(cause)
        more = f"; {len(loads) - 1} more" if len(loads) > 1 else ""
        for part in LOAD_PARTS:
            yield Reason(
                part,
                word if own in (None, part) else "look",
                f"unexplained force {worst.size} from {worst.from_s:.2f} to {worst.to_s:.2f} s{more}",
                "the frames in which it acts are left out",
                worst.hint,
                weight,
            )


def _spoils(evidence: Evidence, worst: UnexplainedLoad) -> tuple[Word, float]:
    """The word on a trial in which a force acts, and its weight."""
    bounds, size = (
        (MASS_SHARE, worst.share) if worst.cause == "mass" else (SPOILT, evidence.unexplained_share)
    )
    weight = max(worst.share / 0.08, 1.0)
    return ("do not use", weight) if size >= bounds.leave else ("look", weight)


def _contacts(evidence: Evidence) -> Iterator[Reason]:
    """The largest load on another part than the feet: whether there was a seat or rail, a person knows."""
    if not evidence.contacts:
        return
    worst = max(evidence.contacts, key=lambda one: one.peak_n)
    others = sorted({one.part.replace("_", " ") for one in evidence.contacts if one.part != worst.part})
    more = f"; also {', '.join(others)}" if others else ""
    for part in LOAD_PARTS:
        yield Reason(
            part,
            "look",
            f"the {worst.part.replace('_', ' ')} bears up to {worst.peak_n:.0f} N from {worst.from_s:.2f} to "
            f"{worst.to_s:.2f} s, which nothing measures{more}",
            "the load is inferred from the motion and Newton's law",
            "make sure that it leant, sat or held there; if not, reconstruct with --feet-only",
            1.0,
        )


def _from_motion(motion: list[Reason]) -> Iterator[Reason]:
    """Loads rest on the motion of their own part; on that of pelvis and trunk, all do."""
    words = {
        part: gravest(one.word for one in motion if one.part == part and one.shown)
        for part in (PELVIS, TRUNK, *LEGS)
    }
    rests = {RIGHT: (LEGS[0], PELVIS), LEFT: (LEGS[1], PELVIS), OF_TRUNK: (TRUNK, PELVIS, *LEGS)}
    for loads, parts in rests.items():
        worst = max(parts, key=lambda part: ("use", "look", "do not use").index(words[part]))
        if words[worst] != "use":
            yield Reason(
                loads,
                words[worst],
                f"the verdict on the motion of the {TITLES[worst]} is '{words[worst]}'",
                "these loads are computed from it",
                "its own reasons say what to do",
                0.0,
            )


def _size(check: Finding) -> float:
    return abs(check.value) if check.value is not None else 0.0


def _times(check: Finding) -> float:
    """Size over the bound, or over the part that noise explains."""
    return _size(check) / max(check.bound, 2.0 * (check.expected_sd or 0.0))


def _stated(check: Finding, todo: str) -> tuple[str, str]:
    """The finding in words, and the remedy that its hint ends with, or else another one."""
    ends = [at for at in (check.hint.find("; "), check.hint.find(": ")) if at >= 0]
    meaning, remedy = (check.hint[: min(ends)], check.hint[min(ends) + 2 :]) if ends else (check.hint, todo)
    return f"{check.name} {check.value:+.3g} {check.unit}, {meaning}", remedy
