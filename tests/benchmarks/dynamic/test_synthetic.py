"""Synthetic cases: errors against the truth, consistency, the bounds' ratios."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.dynamic import synthetic as dynamic_synthetic
from benchmarks.dynamic.methods import in_turn
from benchmarks.dynamic.synthetic import (
    FCDI,
    MATCHED,
    Baseline,
    Errors,
    baseline,
    differences,
    errors_of,
    make_case,
    method_rows,
)
from mbkf.trial.results.summary import compare_with_truth

BASE = Baseline(torque_nm=5.0, torque_scale=0.1, velocity_rad_s=1.0, velocity_scale=0.6, offline_nm=2.0)
FOUND = Errors(
    torque_nm=2.5, torque_inside_nm=1.8, velocity_rad_s=0.9, angle_deg=3.0, farthest_mm=40.0, untracked=0
)


@pytest.fixture(scope="module")
def case():
    return make_case(("squat", 0), MATCHED, correct=False)


def test_a_case_is_made_the_same_every_time_and_states_its_noise(case):
    again = make_case(("squat", 0), MATCHED, correct=False)
    np.testing.assert_array_equal(again.capture.markers.positions_m, case.capture.markers.positions_m)
    assert {marker.noise_m for marker in case.subject.markers} == {MATCHED.markers_sd_m}
    assert case.given is case.subject


def test_errors_are_those_of_the_summary(case):
    found = FCDI.run(case.capture, case.subject)
    summary = compare_with_truth(found, case.truth)
    errors = errors_of(case, FCDI)
    assert errors.torque_nm == pytest.approx(summary["torque_rms_nm"])
    assert errors.velocity_rad_s == pytest.approx(summary["velocity_rms_rad_s"])
    assert errors.angle_deg == pytest.approx(summary["angle_rms_deg"])
    assert 0.0 < errors.farthest_mm < 50.0
    assert errors.untracked == 0


def test_untracked_frames_are_left_out(case):
    found = FCDI.run(case.capture, case.subject)
    tracked = found.tracked.copy()
    tracked[10:20] = False
    for error in differences(replace(found, tracked=tracked), case.truth):
        assert error.shape == (found.frames, 46)
        assert np.isnan(error[10:20]).all()
        assert np.isfinite(error[20:]).all()


def test_a_method_is_bounded_by_its_ratio_to_others():
    rows = method_rows("m", [FOUND, FOUND], BASE, smooth=False)
    ratios = {row.name: (row.value, row.bound, row.passed) for row in rows if row.bounded}
    assert ratios["m, torque RMS / FCDI"] == (pytest.approx(0.5), 0.6, True)
    assert ratios["m, velocity RMS / FCDI"] == (pytest.approx(0.9), 0.8, False)
    smoothed = {row.name: row for row in method_rows("m", [FOUND], BASE, smooth=True)}
    assert smoothed["m, torque RMS / FCDI"].bound == 0.45
    assert smoothed["m, torque RMS / 6 Hz offline"].value == pytest.approx(0.9)


@pytest.mark.parametrize("bad", [{"farthest_mm": 250.0}, {"farthest_mm": math.nan}, {"untracked": 3}])
def test_divergence_in_one_seed_is_not_averaged_away(bad):
    rows = method_rows("m", [FOUND, replace(FOUND, **bad)], BASE, smooth=False)
    assert not all(row.passed for row in rows[3:])


def test_fcdi_is_compared_at_its_own_best(monkeypatch):
    def errors(trials, method, mapper):
        torque, velocity = abs(method.scale - 0.3) + 1.0, abs(method.scale - 1.2) + 0.5
        return [replace(FOUND, torque_nm=torque, velocity_rad_s=velocity) for _ in trials]

    monkeypatch.setattr(dynamic_synthetic, "errors", errors)
    monkeypatch.setattr(dynamic_synthetic, "offline_torque_nm", lambda trial: 2.0)
    found = baseline([None] * 6, in_turn)
    assert found == Baseline(1.0, 0.3, 0.5, 1.2, 2.0)
