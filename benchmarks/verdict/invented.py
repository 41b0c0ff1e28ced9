"""Seats, rails and hands that are found where a person only runs, lands or walks, under a wrong mass or clock."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check, information
from benchmarks.loads.faults import Clock, Fault, Mass
from benchmarks.loads.trials import ALL_SOURCES
from benchmarks.verdict.persons import MORE
from benchmarks.verdict.recorded import Base, Recorded, load, real
from mbkf.io.contacts import FEET
from mbkf.numerics.threads import single_threaded
from mbkf.trial.reconstruct import reconstruct

FAULTS: tuple[Fault, ...] = (Mass(1.1), Mass(0.9), Clock(0.04), Clock(-0.04))

PUBLIC = (
    "rajagopal run",
    "bmc run",
    "fukuchi run",
    "rajagopal walk",
    "gait2354",
    "biomechzoo HC032A",
    "biomechzoo HC044A",
    "rehazenter",
    "knee challenge 1",
    "opencap",
    "cgm24",
    "judgement walk",
    "gaitalytics",
    "landing",
)
MADE = (
    ("foreign", "run", "adult"),
    ("foreign", "run", "child"),
    ("foreign", "walk", "adult"),
    ("foreign", "walk", "child"),
    ("own", "jump", "22"),
    ("own", "jump", "32"),
    ("own", "walk", "30"),
)


@dataclass(frozen=True)
class Moved:
    """A run, landing or walk.

    Attributes:
        data: Folder of the reference captures.
        name: One of :data:`PUBLIC`; empty for a person made.
        made: Kind, motion and person of one made.
    """

    data: Path
    name: str = ""
    made: tuple[str, str, str] = ("", "", "")

    @property
    def label(self) -> str:
        """Its name in rows."""
        return self.name or " ".join(self.made[1:])

    def recorded(self) -> Recorded:
        """The trial."""
        if self.name:
            return real({**ALL_SOURCES, **MORE}[self.name], self.data)
        kind, motion, who = self.made
        return load(Base(kind, motion, self.data, who))[0]


def moved_trials(data: Path, quick: bool = False) -> list[Moved]:
    """Runs, landings and walks; the rules of contacts were set on the landing among them.

    Args:
        data: Folder of the reference captures.
        quick: Every fifth of them.
    """
    found = [Moved(data, name) for name in PUBLIC] + [Moved(data, made=made) for made in MADE]
    return found[::5] if quick else found


def invented(trial: Moved) -> list[tuple[str, str]]:
    """Parts besides the feet that are found to bear, with each fault's label, and without a fault.

    Args:
        trial: The trial.
    """
    with single_threaded():
        recorded, said = trial.recorded(), []
        for fault in (None, *FAULTS):
            capture, subject = recorded.capture, recorded.subject
            if fault is not None:
                capture, subject, _ = fault.put_into(capture, subject)
            found = reconstruct(capture, subject)
            parts = sorted({one.part for one in found.contacts if one.part not in FEET})
            label = trial.label if fault is None else f"{trial.label}, {fault.label}"
            said.append((label, ", ".join(parts)))
    return said


def invented_rows(found: Sequence[Sequence[tuple[str, str]]]) -> Iterator[Check]:
    """Rows of contacts that are not there.

    Args:
        found: Parts by trial and fault.
    """
    every = [one for of_trial in found for one in of_trial]
    for label, parts in every:
        if parts:
            yield information(f"contact that is not there: {label}: {parts}", float("nan"))
    name = (
        f"contacts that are not there, {len(found)} runs, landings and walks with {len(FAULTS)} faults each"
    )
    yield Check(name, sum(bool(parts) for _, parts in every), 0.0, "<=")
