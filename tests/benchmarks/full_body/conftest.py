"""Made-up outcomes of the full-body study, and a short squat followed by the kinematic filter."""

from dataclasses import fields

import pytest

from benchmarks.full_body.filters import CAUSAL, FCDI, SMOOTHED
from benchmarks.full_body.scores import Scores
from benchmarks.full_body.survey import Outcome, Survey
from benchmarks.full_body.trials import MOVEMENTS, VARIANTS

NUMBERS = tuple(item.name for item in fields(Scores))


def scores(**numbers):
    """Scores of 1 everywhere, but for some."""
    return Scores(**{**dict.fromkeys(NUMBERS, 1.0), "untracked": 0, **numbers})


def made_survey(factors, persons=2, seeds=2):
    """Every filter's numbers are its factor times those of FCDI, which grow with person and seed."""
    return Survey(
        [
            Outcome(
                movement,
                person,
                seed,
                name,
                scores(**{key: factors.get(name, 1.0) * (1.0 + person + 0.1 * seed) for key in NUMBERS[:-1]}),
            )
            for movement in (*MOVEMENTS, *VARIANTS)
            for person in range(persons)
            for seed in range(seeds)
            for name in (*CAUSAL, *SMOOTHED)
        ]
    )


@pytest.fixture(scope="session")
def short_squat():
    """(trial, its reconstruction by the kinematic filter) of a person's squat of 2 s."""
    from benchmarks.full_body import trials

    whole = trials.SYNTHESISED[trials.SQUAT]
    trials.SYNTHESISED[trials.SQUAT] = (whole[0], 2.0)
    try:
        trial = trials.make_trials(trials.SQUAT, 0, 0)[0]
    finally:
        trials.SYNTHESISED[trials.SQUAT] = whole
    return trial, CAUSAL[FCDI].run(trial.capture, trial.subject)
