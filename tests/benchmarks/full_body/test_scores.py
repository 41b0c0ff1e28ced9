"""What is measured on a reconstruction: nothing is wrong with the truth, noise is what is quick, lost is lost."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.full_body.scores import (
    clinical_flexion,
    leg_columns,
    noise,
    plain_rms,
    posture_error,
    prediction_residual_n,
    score,
)
from mbkf.conventions import GRAVITY_M_S2
from mbkf.synthesis.person import body_of
from tests.benchmarks.full_body.conftest import NUMBERS


@pytest.fixture(scope="module")
def truth_as_found(short_squat):
    """The trial, and a reconstruction that holds the true motion."""
    trial, run = short_squat
    truth = trial.truth
    exact = replace(
        run,
        q=truth.q,
        v=truth.v,
        a=truth.a,
        tau=truth.tau,
        foot_wrench=truth.foot_wrench,
        tracked=np.ones_like(run.tracked),
    )
    return trial, exact


def test_the_truth_has_no_error(truth_as_found):
    trial, exact = truth_as_found
    found = score(trial, exact, trial.truth.foot_wrench)
    for name in ("angle_deg", "velocity_rad_s", "torque_nm", "reaction_n", "knee_deg", "knee_torque_nm"):
        assert getattr(found, name) == pytest.approx(0.0, abs=1e-6)
    assert abs(found.velocity_delay_ms) < 0.05
    assert not found.diverged


def test_newton_s_law_holds_in_the_truth_s_own_prediction(truth_as_found):
    trial, exact = truth_as_found
    model = body_of(trial.subject)
    missing = prediction_residual_n(model, exact, trial.truth.foot_wrench)
    assert missing < 0.02 * model.mass_kg * GRAVITY_M_S2
    without = prediction_residual_n(model, exact, np.zeros_like(trial.truth.foot_wrench))
    assert without == pytest.approx(model.mass_kg * GRAVITY_M_S2, rel=0.03)


def test_the_kinematic_filter_s_scores_are_finite_and_plausible(short_squat):
    trial, run = short_squat
    found = score(trial, run, run.foot_wrench)
    assert all(np.isfinite(getattr(found, name)) for name in NUMBERS)
    assert 0.5 < found.angle_deg < 10.0
    assert found.residual_before_n > 10.0


def test_a_turned_knee_is_measured_by_its_angle(truth_as_found):
    trial, exact = truth_as_found
    model, q = body_of(trial.subject), exact.q.copy()
    step = np.zeros(model.nv)
    step[model.joint("right_shank").v.start + 1] = np.deg2rad(3.0)
    at = int(np.flatnonzero(trial.stretch)[10])
    q[at] = model.integrate(q[at], step)
    found = score(trial, replace(exact, q=q), trial.truth.foot_wrench)
    assert found.knee_deg == pytest.approx(3.0, abs=1e-6)
    turned = np.rad2deg(clinical_flexion(model, q) - clinical_flexion(model, trial.truth.q))[at]
    assert turned == pytest.approx(3.0, abs=0.2)


def test_lost_numbers_are_a_divergence(truth_as_found):
    trial, exact = truth_as_found
    q = exact.q.copy()
    q[-1] = np.nan
    with np.errstate(all="ignore"):
        found = score(trial, replace(exact, q=q), trial.truth.foot_wrench)
    assert found.diverged
    assert np.isinf(found.angle_deg)
    assert np.isnan(found.residual_before_n)


def test_noise_is_what_is_quicker_than_6_hz():
    t = np.arange(400) / 100.0
    slow, quick = (np.sin(2 * np.pi * hz * t)[:, None] for hz in (1.0, 20.0))
    inside = (t > 0.5) & (t < 3.5)
    assert noise(slow, inside, 100.0) < 0.01
    assert noise(quick, inside, 100.0) == pytest.approx(np.sqrt(0.5), rel=0.02)
    assert np.isinf(noise(np.full((400, 1), np.nan), inside, 100.0))


def test_rms_of_a_breakdown_is_infinite():
    assert plain_rms(np.array([3.0, -4.0])) == pytest.approx(np.sqrt(12.5))
    assert np.isinf(plain_rms(np.array([1.0, np.nan])))


def test_legs_are_hips_knees_and_ankles(short_squat):
    model = body_of(short_squat[0].subject)
    assert len(leg_columns(model)) == 18
    assert posture_error(model, short_squat[0].truth.q, short_squat[0].truth.q) == pytest.approx(
        0.0, abs=1e-9
    )
