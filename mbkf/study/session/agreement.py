"""Trials of a session against each other: one person, one subject file, markers that stay where they were put on.

Each trial is judged against the subject file by itself (:mod:`mbkf.trial.checks.persons`). Together they show more: one
trial of another person among right ones, a file that is wrong for all of them, trials with different files, and markers
that were put on anew between two trials.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.findings import Finding
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.verdict import Word
from mbkf.trial.checks.persons import LOOK, NAME

LEAST_TRIALS = 3
"""Places of markers are compared from so many trials on: of two trials it is not known which one differs."""

MOVED_M, MOVED_SD, ALONE = 0.035, 3.0, 1.8
"""Distance of a marker from its place in the other trials, m, in its spreads between sessions, and over the median of
its segment's markers, beyond which it was put on anew. Skin moves the markers of a pelvis by up to 43 mm between a walk
and a squat, all of them (four persons made from OpenSim bodies)."""

LONGER = 1.01
"""Ratio of scale factors from which two subject files are of different bodies."""


@dataclass(frozen=True)
class TrialBody:
    """The body of a trial.

    Attributes:
        name: The trial.
        subject: The person, with markers corrected on the trial.
        places_m: (3,) place of each marker that the trial shows, in its segment's frame.
        lengths: The check of segment lengths; None where it was not made.
    """

    name: str
    subject: Subject
    places_m: Mapping[str, Array]
    lengths: Finding | None

    @classmethod
    def of(cls, r: Reconstruction) -> TrialBody:
        """Of a result."""
        seen = {
            name
            for name, there in zip(r.marker_names, np.asarray(r.present.any(axis=0)), strict=True)
            if there
        }
        places = {marker.name: marker.neutral_m for marker in r.subject.markers if marker.name in seen}
        return cls(r.trial, r.subject, places, next((one for one in r.checks if one.name == NAME), None))

    @property
    def powers(self) -> float:
        """Powers of ten for another person; 0 where it was not judged."""
        return 0.0 if self.lengths is None or self.lengths.value is None else self.lengths.value


class Disagreement(NamedTuple):
    """Trials that disagree with the others.

    Attributes:
        trials: Their names.
        word: "look" or "do not use".
        sentence: What was found, what it means, and what to do.
    """

    trials: tuple[str, ...]
    word: Word
    sentence: str


def disagreements(trials: Sequence[TrialBody]) -> tuple[Disagreement, ...]:
    """The disagreements of a session, those about persons first.

    Args:
        trials: Its trials.
    """
    return (*_other_persons(trials), *_other_files(trials), *_moved_markers(trials))


def _other_persons(trials: Sequence[TrialBody]) -> tuple[Disagreement, ...]:
    other = [one for one in trials if one.powers >= LOOK]
    if not other or len(trials) == 1:
        return ()
    names = tuple(one.name for one in other)
    worst = max(other, key=lambda one: one.powers)
    found = "" if worst.lengths is None else worst.lengths.hint.split(": ")[0]
    if len(other) == len(trials):
        sentence = (
            f"no trial has the segment lengths of the subject file ({worst.name}: {found}): "
            "the file is another person's; scale from a static trial of this person"
        )
    else:
        sentence = (
            f"{', '.join(names)}: {found}, the other {len(trials) - len(other)} trials have the file's lengths: "
            "another person is in it; move it to that person's session"
        )
    return (Disagreement(names, "do not use", sentence),)


def _other_files(trials: Sequence[TrialBody]) -> tuple[Disagreement, ...]:
    """Trials whose body differs from that of most trials."""
    factors = [np.array(list(one.subject.scale_factors.values())) for one in trials]
    alike = [[_same(a, b) for b in factors] for a in factors]
    usual = int(np.argmax(np.sum(alike, axis=1))) if trials else 0
    other = tuple(
        one.name for one, same in zip(trials, alike[usual] if alike else (), strict=True) if not same
    )
    if not other:
        return ()
    sentence = (
        f"{', '.join(other)}: reconstructed with another subject file than {trials[usual].name}: angles and torques do "
        "not belong to one body; reconstruct all trials with one file"
    )
    return (Disagreement(other, "do not use", sentence),)


def _same(one: Array, other: Array) -> bool:
    return len(one) == len(other) and bool((np.abs(np.log(one / other)) < np.log(LONGER)).all())


def _moved_markers(trials: Sequence[TrialBody]) -> tuple[Disagreement, ...]:
    """For each trial, markers that sit elsewhere than in the others; the farthest is named with its distance."""
    found = []
    for one in trials:
        moved = _moved_mm(one, [other for other in trials if other is not one])
        if not moved:
            continue
        worst = max(moved, key=lambda name: moved[name])
        more = f" (and {len(moved) - 1} more markers)" if len(moved) > 1 else ""
        sentence = (
            f"{one.name}: {worst} sits {moved[worst]:.0f} mm from its place in the other trials{more}: it was put on "
            "anew, or its name is another marker's; compare its angles with those of other trials with care"
        )
        found.append(Disagreement((one.name,), "look", sentence))
    return tuple(found)


def _moved_mm(one: TrialBody, others: Sequence[TrialBody]) -> dict[str, float]:
    """Distance in mm of each marker that was put on anew: of all from its place in other trials, the (lower) median."""
    away: dict[str, float] = {}
    for name, place in one.places_m.items():
        known = [other.places_m[name] for other in others if name in other.places_m]
        if len(known) + 1 >= LEAST_TRIALS:
            distances = sorted(float(np.linalg.norm(place - other)) for other in known)
            away[name] = distances[(len(distances) - 1) // 2]
    segments: dict[str, list[float]] = {}
    own = {marker.name: marker for marker in one.subject.markers}
    for name, size in away.items():
        segments.setdefault(own[name].segment, []).append(size)
    usual = {segment: float(np.median(sizes)) for segment, sizes in segments.items()}
    return {
        name: 1e3 * size
        for name, size in away.items()
        if size > max(MOVED_M, MOVED_SD * own[name].session_sd_m, ALONE * usual[own[name].segment])
        and len(segments[own[name].segment]) > 1
    }
