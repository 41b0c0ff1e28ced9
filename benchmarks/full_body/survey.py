"""Every filter on every trial of the study, and what they score by filter and movement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.dynamic.methods import Mapper
from benchmarks.full_body.filters import CAUSAL, DYNAMIC, FCDI, FDMC, FDMC_PER_FRAME, SMOOTHED
from benchmarks.full_body.persons import PERSONS
from benchmarks.full_body.scores import Scores, score
from benchmarks.full_body.trials import (
    GENERAL,
    LOST,
    MOVEMENTS,
    SQUAT,
    SYNTHESISED,
    VARIANTS,
    Trial,
    make_trials,
)
from mbkf.conventions import Array

SEEDS = 4
SEEDS_OF = {FDMC: 2, FDMC_PER_FRAME: 1, **dict.fromkeys(SMOOTHED, 1)}
"""Seeds on which a filter runs where that is not all of them: those that lose no trial need fewer for their errors."""

SMOOTHED_PERSONS = 2
"""Smoothed filters run on every so many-th person."""

OF_VARIANTS = (FCDI, FDMC_PER_FRAME, FDMC, DYNAMIC)
"""Filters that run on the variants of the general movement."""

Key = tuple[str, int, int]
"""Movement or variant, person and seed."""

MADE_FROM: Mapping[str, str] = {LOST: SQUAT, **dict.fromkeys(VARIANTS, GENERAL)}
"""Movements whose trials are made from those of another one."""


@dataclass(frozen=True)
class Outcome:
    """Scores of one filter on one trial."""

    movement: str
    person: int
    seed: int
    filter: str
    scores: Scores


def measure(key: Key, quick: bool = False) -> list[Outcome]:
    """All filters on the trial of a movement, a person and a seed; no smoothed ones when quick."""
    movement, person, seed = key
    made = make_trials(MADE_FROM.get(movement, movement), person, seed)
    return [one for trial in made if trial.movement == movement for one in filtered(trial, quick)]


def filtered(trial: Trial, quick: bool = False) -> list[Outcome]:
    """All filters on a trial, no smoothed ones when quick; FCDI's run also gives the wrenches under each foot."""
    measured = CAUSAL[FCDI].run(trial.capture, trial.subject)
    every = CAUSAL if quick else {**CAUSAL, **SMOOTHED}
    found = []
    for name, method in every.items():
        if not runs(name, trial):
            continue
        with np.errstate(all="ignore"):
            run = measured if name == FCDI else method.run(trial.capture, trial.subject)
            scores = score(trial, run, measured.foot_wrench)
        found.append(Outcome(trial.movement, trial.person, trial.seed, name, scores))
    return found


def runs(name: str, trial: Trial) -> bool:
    """Whether a filter runs on a trial; every one of them would take an hour."""
    if trial.movement in VARIANTS:
        return name in OF_VARIANTS
    chosen = name not in SMOOTHED or trial.person % SMOOTHED_PERSONS == 0
    return chosen and trial.seed < SEEDS_OF.get(name, SEEDS)


@dataclass(frozen=True)
class Survey:
    """All outcomes."""

    outcomes: Sequence[Outcome]

    def of(self, filter_name: str, movement: str | None = None) -> list[Outcome]:
        """The outcomes of a filter, of one movement or of all."""
        return [
            one for one in self.outcomes if one.filter == filter_name and movement in (None, one.movement)
        ]

    def divergences(self, filter_name: str, movement: str | None = None) -> int:
        """How many trials a filter lost."""
        return sum(one.scores.diverged for one in self.of(filter_name, movement))

    def values(self, filter_name: str, movement: str, number: str) -> Array:
        """(n,) one number over the trials that the filter did not lose.

        Args:
            filter_name: Name of the filter.
            movement: One of the movements.
            number: A field of :class:`benchmarks.full_body.scores.Scores`.
        """
        return np.array(
            [getattr(one.scores, number) for one in self.of(filter_name, movement) if not one.scores.diverged]
        )

    def pooled(self, filter_name: str, movement: str, number: str) -> float:
        """RMS of errors over trials, mean of delays and of innovations; NaN where every trial was lost.

        Args:
            filter_name: Name of the filter.
            movement: One of the movements.
            number: A field of :class:`benchmarks.full_body.scores.Scores`.
        """
        values = self.values(filter_name, movement, number)
        if not values.size:
            return np.nan
        if number.endswith("_ms") or number in ("nis", "knee_deg", "flexion_deg"):
            return float(values.mean())
        return float(np.sqrt(np.mean(values**2)))

    def common(self, names: Sequence[str], movement: str) -> Survey:
        """The outcomes of some filters on the trials of a movement that all of them ran and none of them lost.

        Args:
            names: Names of the filters.
            movement: One of the movements.
        """
        followed = [
            {(o.person, o.seed) for o in self.of(name, movement) if not o.scores.diverged} for name in names
        ]
        kept = set.intersection(*followed)
        chosen = [o for name in names for o in self.of(name, movement) if (o.person, o.seed) in kept]
        return Survey(chosen)

    def ratio(self, filter_name: str, others: Sequence[str], movement: str, number: str) -> float:
        """A filter's pooled number over the least of others', all over their common trials.

        Args:
            filter_name: Name of the filter.
            others: Names of those it is compared with.
            movement: One of the movements.
            number: A field of :class:`benchmarks.full_body.scores.Scores`.
        """
        same = self.common((filter_name, *others), movement)
        return same.pooled(filter_name, movement, number) / min(
            same.pooled(name, movement, number) for name in others
        )


def keys(*, quick: bool = False) -> list[Key]:
    """Trials to measure, the longest first so that two workers end together; of one person and one seed if quick."""
    made = sorted((*MOVEMENTS, *VARIANTS), key=lambda name: -SYNTHESISED[MADE_FROM.get(name, name)][1])
    persons, seeds = (1, 1) if quick else (len(PERSONS), SEEDS)
    return [
        (name, person, seed)
        for name in made
        for person in range(persons)
        for seed in range(1 if name in VARIANTS else seeds)
    ]


def survey(mapper: Mapper, *, quick: bool = False) -> Survey:
    """Measures all trials.

    Args:
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether one person and seed are enough, without smoothed filters.
    """
    found = mapper(partial(measure, quick=quick), keys(quick=quick))
    return Survey([outcome for part in found for outcome in part])
