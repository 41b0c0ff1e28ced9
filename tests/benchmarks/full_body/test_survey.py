"""Outcomes pooled by filter and movement: lost trials do not count, ratios are over the trials that both followed."""

import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.full_body.filters import DYNAMIC, FCDI, FDMC, FDMC_PER_FRAME, FDMC_PRINTED
from benchmarks.full_body.survey import Survey, keys, measure, runs
from benchmarks.full_body.trials import BESIDE, GENERAL, JUMP, MOVEMENTS, VARIANTS, WALK
from tests.benchmarks.full_body.conftest import made_survey


def test_errors_are_pooled_as_rms_and_delays_as_means():
    found = made_survey({})
    values = np.array([1.0, 1.1, 2.0, 2.1])
    assert found.pooled(FCDI, WALK, "torque_nm") == pytest.approx(np.sqrt(np.mean(values**2)))
    assert found.pooled(FCDI, WALK, "torque_delay_ms") == pytest.approx(values.mean())
    assert np.isnan(Survey([]).pooled(FCDI, WALK, "torque_nm"))


def test_lost_trials_are_counted_and_left_out():
    found = made_survey({FDMC_PRINTED: 9.0})
    assert found.divergences(FDMC_PRINTED, JUMP) == 2
    assert found.divergences(FCDI) == 0
    assert found.pooled(FDMC_PRINTED, JUMP, "torque_nm") == pytest.approx(9.0 * np.sqrt((1 + 1.21) / 2))


def test_a_ratio_is_over_the_trials_that_nobody_lost():
    found = made_survey({DYNAMIC: 0.5, FDMC: 9.0, FDMC_PER_FRAME: 2.0})
    assert found.ratio(DYNAMIC, [FCDI], JUMP, "torque_nm") == pytest.approx(0.5)
    assert found.ratio(DYNAMIC, [FCDI, FDMC_PER_FRAME], JUMP, "torque_nm") == pytest.approx(0.5)
    assert found.ratio(FDMC, [FCDI], JUMP, "torque_nm") == pytest.approx(9.0)
    fewer = Survey([one for one in found.outcomes if one.filter != DYNAMIC or one.seed == 0])
    changed = [
        replace(one, scores=replace(one.scores, torque_nm=100.0)) if one.filter == FCDI and one.seed else one
        for one in fewer.outcomes
    ]
    assert Survey(changed).ratio(DYNAMIC, [FCDI], JUMP, "torque_nm") == pytest.approx(0.5)


def test_the_whole_study_has_160_trials_of_every_filter():
    wanted = keys()
    assert len(wanted) == len(set(wanted)) == 8 * 4 * 5 + 8 * 2
    assert sum(movement in MOVEMENTS for movement, _, _ in wanted) == 160
    assert {key for key in wanted if key[0] in VARIANTS} == {
        (name, k, 0) for name in VARIANTS for k in range(8)
    }
    assert wanted[0][0] == GENERAL


def test_a_quick_study_has_every_movement_and_variant_of_one_person_once():
    assert sorted(keys(quick=True)) == sorted((movement, 0, 0) for movement in (*MOVEMENTS, *VARIANTS))


def test_a_key_names_one_of_the_trials_that_are_made_together(monkeypatch):
    made = [SimpleNamespace(movement=name, person=3, seed=0) for name in (GENERAL, *VARIANTS)]
    asked = []
    module = sys.modules[measure.__module__]
    monkeypatch.setattr(module, "make_trials", lambda *key: asked.append(key) or made)
    monkeypatch.setattr(module, "filtered", lambda trial, quick: [(trial.movement, quick)])
    assert measure((BESIDE, 3, 0), quick=True) == [(BESIDE, True)]
    assert asked == [(GENERAL, 3, 0)]


def test_fdmc_as_printed_and_the_bounded_filters_run_on_every_trial():
    def count(name):
        return sum(
            runs(name, SimpleNamespace(movement=movement, person=person, seed=seed))
            for movement, person, seed in keys()
            if movement in MOVEMENTS
        )

    assert [count(name) for name in (FCDI, FDMC_PRINTED, DYNAMIC)] == [160] * 3
    assert (count(FDMC), count(FDMC_PER_FRAME), count(f"{DYNAMIC}, smoothed")) == (80, 40, 20)
    beside = SimpleNamespace(movement=BESIDE, person=1, seed=0)
    assert runs(FDMC_PER_FRAME, beside)
    assert not runs(FDMC_PRINTED, beside)
