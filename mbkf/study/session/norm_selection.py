"""Persons of norms: walks that may be used, of named persons with age, sex and speed; all others with the reason."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.errors import UnknownName
from mbkf.io.norms import NormPerson
from mbkf.io.session import TrialKind
from mbkf.io.visit import UNAIDED
from mbkf.study.session.cycles import Curves, SideCycles
from mbkf.study.session.records import Measure, MovementGroup, Session, SessionTrial
from mbkf.trial.gait.convention import MODEL

SPEED = "Speed"
"""Measure that states the walking speed."""


REASONS = {
    "in_view": "the person in view is compared with others alone",
    "unknown_kind": "movement not recognised; state its kind in the session",
    "other_kind": "no walk ({0})",
    "condition": "condition {0}",
    "verdict": "{0}: {1}",
    "no_walk": "no walk that may be used",
    "age_and_sex": "age and sex not stated; write them into the session",
    "age": "age not stated; write it into the session",
    "sex": "sex not stated; write it into the session",
    "one_foot": "no whole cycle of both feet",
    "no_speed": "walking speed not known",
}
"""Reasons to leave a person or a trial out, with places for details."""


@dataclass(frozen=True)
class LeftOut:
    """A person or a trial that norms leave out.

    Attributes:
        person: The person.
        trial: The trial; empty for the whole person.
        why: One of :data:`REASONS`.
        details: Its details.
    """

    person: str
    trial: str
    why: str
    details: tuple[str, ...] = ()

    @property
    def reason(self) -> str:
        """In English."""
        return REASONS[self.why].format(*self.details)

    @property
    def who(self) -> str:
        """The person, and the trial."""
        return f"{self.person}, {self.trial}" if self.trial else self.person

    @property
    def sentence(self) -> str:
        """Who, and why."""
        return f"{self.who}: {self.reason}"


@dataclass(frozen=True)
class ChosenPerson:
    """A person that norms are made of: facts, the walks that count, and convention and axes of their curves."""

    facts: NormPerson
    gait: MovementGroup
    read: tuple[str, ...] = (MODEL, MODEL)


@dataclass(frozen=True)
class NormSelection:
    """Persons of norms.

    Attributes:
        persons: Those that count.
        left_out: All others, and trials of those that count.
    """

    persons: tuple[ChosenPerson, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def cycles(self) -> int:
        """Number of cycles."""
        return sum(one.facts.cycles for one in self.persons)


def norm_selection(sessions: Iterable[Session], in_view: Collection[str] = ()) -> NormSelection:
    """The persons of norms among sessions, one session for each.

    Args:
        sessions: The sessions, in any order.
        in_view: Names of persons that the norms are for, and that are never among them.

    Raises:
        UnknownName: The folder holds no session of that person.
    """
    sessions, persons, left_out = list(sessions), [], []
    names = [session.name for session in sessions]
    for name in in_view:
        if name not in names:
            raise UnknownName("person", name, names)
    for session in sessions:
        if session.name in in_view:
            left_out.append(LeftOut(session.name, "", "in_view"))
            continue
        against = {trial.name: _against(session, trial) for trial in session.trials}
        left_out += [one for one in against.values() if one is not None]
        found = _person(session, {name for name, one in against.items() if one is None})
        if isinstance(found, str):
            left_out.append(LeftOut(session.name, "", found))
        else:
            persons.append(found)
    return NormSelection(tuple(persons), tuple(left_out))


def _against(session: Session, trial: SessionTrial) -> LeftOut | None:
    """The reason to leave a trial out; None for one that counts."""
    if trial.kind == TrialKind.UNKNOWN:
        return LeftOut(session.name, trial.name, "unknown_kind")
    if trial.kind != TrialKind.WALK:
        return LeftOut(session.name, trial.name, "other_kind", (trial.kind.value.replace("_", " "),))
    walk = session.gait(TrialKind.WALK)
    if trial.condition not in UNAIDED or (walk is not None and trial.condition != walk.condition):
        return LeftOut(session.name, trial.name, "condition", (trial.condition or "–",))
    if trial.verdict != "use":
        remark = trial.remarks[0] if trial.remarks else "see its report"
        return LeftOut(session.name, trial.name, "verdict", (trial.verdict, remark))
    doubt = next((one for one in session.disagreements if trial.name in one.trials), None)
    if doubt is None:
        return None
    return LeftOut(session.name, trial.name, "verdict", (doubt.word, doubt.sentence))


def _person(session: Session, trials: Collection[str]) -> ChosenPerson | str:
    """The walks of a person in some trials, or the key of the reason that there are none."""
    walk = session.gait(TrialKind.WALK)
    if walk is None or not trials:
        return "no_walk"
    lacking = [word for word, value in (("age", session.age), ("sex", session.sex)) if value is None]
    if session.age is None or session.sex is None:
        return "_and_".join(lacking)
    gait = of_trials(walk, trials)
    counts = [len(side.cycles) for side in gait.sides]
    if not all(counts):
        return "one_foot"
    speed = speed_of(gait)
    if not np.isfinite(speed):
        return "no_speed"
    facts = NormPerson(session.name, session.sex, session.age, speed, sum(counts))
    return ChosenPerson(facts, gait, (session.convention.name, *session.axes))


def speed_of(gait: MovementGroup) -> float:
    """Mean speed over all cycles, m/s; NaN where it is not known."""
    speeds = [np.concatenate(list(one.values.values())) for one in gait.measures if one.name == SPEED]
    return float(np.nanmean(speeds[0])) if speeds and np.isfinite(speeds[0]).any() else float("nan")


def of_trials(gait: MovementGroup, trials: Collection[str]) -> MovementGroup:
    """The part of a gait that some of its trials are.

    Args:
        gait: The gait.
        trials: Names of the trials.
    """
    names = tuple(name for name in gait.trials if name in trials)
    right, left = (_side(side, trials) for side in gait.sides)
    measures = tuple(_measure(one, trials) for one in gait.measures)
    return MovementGroup(gait.kind, names, (right, left), measures, gait.condition)


def _side(side: SideCycles, trials: Collection[str]) -> SideCycles:
    rows = [k for k, cycle in enumerate(side.cycles) if cycle.trial in trials]

    def part(one: Curves) -> Curves:
        own = (one.values[rows], one.sd[rows], one.shift_sd[rows], one.change_sd[rows])
        return Curves(one.unit, *own, one.midline)

    curves = {key: part(one) for key, one in side.curves.items()} if rows else {}
    return SideCycles(side.side, tuple(side.cycles[k] for k in rows), curves)


def _measure(one: Measure, trials: Collection[str]) -> Measure:
    counts = {
        side: np.array([name in trials for name in names], dtype=bool) for side, names in one.trials.items()
    }
    return replace(
        one,
        values={side: values[counts[side]] for side, values in one.values.items()},
        trials={side: tuple(name for name in names if name in trials) for side, names in one.trials.items()},
    )
