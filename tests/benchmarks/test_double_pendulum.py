"""The pendulum's filters: readings and their Jacobians, what a missing sensor is, artefact states, smoothing."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from benchmarks.double_pendulum import consistency
from benchmarks.double_pendulum.acceleration import (
    PLATE,
    AccelerationMethod,
    AccelerationSettings,
    PendulumAccelerationFilter,
)
from benchmarks.double_pendulum.bodies import body_findings
from benchmarks.double_pendulum.consistency import SCHEMES_COMPARED, consistency_of
from benchmarks.double_pendulum.kinematic import KinematicMethod, joint_torque
from benchmarks.double_pendulum.motions import PendulumNoise, PendulumReadings
from benchmarks.double_pendulum.pendulum import DoublePendulum
from benchmarks.double_pendulum.thesis import ANNEX, FD, STUDY, TABLE_A2, annex_method
from benchmarks.double_pendulum.torque import (
    SENSORS,
    STANDARD_SENSORS,
    Artefact,
    PendulumFilter,
    PendulumSettings,
    TorqueMethod,
)
from benchmarks.double_pendulum.trials import Recipe, Trial, score
from mbkf.errors import UnknownName
from mbkf.filters.dynamic.plant import DynamicState
from tests.derivatives import slope

CLEAN = Recipe(noise=PendulumNoise(camera_m=0.0, artefact_m=0.0, force_n=0.0, moment_nm=0.0))


@pytest.fixture(scope="module")
def clean():
    return CLEAN.trial(0)


def shortened(trial, frames):
    motion, read = trial.motion, trial.read
    cut = {name: getattr(motion, name)[:frames] for name in ("times_s", "q", "v", "a", "efforts")}
    short = PendulumReadings(read.markers_m[:frames], read.efforts[:frames])
    return Trial(replace(motion, **cut), short, trial.hidden[:frames])


def test_every_row_of_the_first_band_is_kept():
    assert all(band.kept for band in body_findings().bands)


def test_the_24_rows_are_all_discretisations():
    schemes = {annex_method(name).settings.scheme for name in TABLE_A2}
    assert len(schemes) == 24
    assert {one.integrator for one in schemes} == {"FE", "HE", "TF", "TN"}
    assert annex_method("FE PE CT").shape == ANNEX


def test_perfect_readings_are_followed_closely(clean):
    """What remains is the lag of efforts that the plant takes to be constant."""
    for method in (FD, KinematicMethod(STUDY, 100.0), AccelerationMethod(STUDY)):
        found = score(clean, method.run(clean))
        assert found.position < 5e-4
        assert found.torque < 15.0


def test_a_sensor_that_is_off_is_one_whose_readings_are_missing(clean):
    trial = shortened(clean, 30)
    off = replace(
        FD,
        settings=replace(FD.settings, sensors=tuple(s for s in STANDARD_SENSORS if s not in {"m2", "F_y"})),
    )
    markers, efforts = trial.read.markers_m.copy(), trial.read.efforts.copy()
    markers[:, 2:4], efforts[:, 2] = np.nan, np.nan
    silent = replace(trial, read=PendulumReadings(markers, efforts))
    np.testing.assert_array_equal(off.run(trial).q, FD.run(silent).q)
    assert np.abs(off.run(trial).q - FD.run(trial).q).max() > 0.0


def test_the_torque_sensor_decides_the_torque(clean):
    trial = shortened(clean, 60)
    sensed = replace(FD, settings=replace(FD.settings, sensors=SENSORS, moment_nm=1e-3)).run(trial)
    np.testing.assert_allclose(sensed.efforts[1:, 0], trial.motion.efforts[1:, 0], atol=1e-3)


def test_unknown_sensor_is_refused():
    with pytest.raises(UnknownName, match="F_z"):
        PendulumFilter(STUDY, 0.01, PendulumSettings(sensors=("m1", "F_z")))


def test_without_residual_states_there_are_twelve(clean):
    settings = replace(FD.settings, residual_noise=None)
    kalman = PendulumFilter(STUDY, 0.01, settings)
    motion = clean.motion
    start = kalman.start(motion.q[0], motion.v[0], motion.efforts[0])
    assert len(start.P) == 12
    step = kalman.step(start, clean.read.markers_m[1], clean.read.efforts[1])
    assert step.evidence.readings == 11
    np.testing.assert_array_equal(step.state.P, step.state.P.T)


@pytest.mark.parametrize("order", [1, 2])
def test_artefact_states_are_stationary(order):
    """A V + V Aᵀ + Σ = 0."""
    one = Artefact(sd_m=0.02, cutoff_hz=0.7, order=order)
    V = scipy.linalg.solve_continuous_lyapunov(one.drift, -np.diag(one.density))
    np.testing.assert_allclose(np.diag(V), one.variance, rtol=1e-12)
    assert V[0, 0] == pytest.approx(0.02**2)


@pytest.mark.parametrize("order", [1, 2])
def test_artefact_states_take_up_what_slides(order):
    """A constant offset of one marker ends up in that marker's state, not in the motion."""
    trial = CLEAN.trial(0)
    markers = trial.read.markers_m.copy()
    markers[:, 0] += 0.02
    settings = replace(FD.settings, marker_m=1e-4, artefact=Artefact(order=order))
    kalman = PendulumFilter(STUDY, trial.dt_s, settings)
    state = kalman.start(trial.motion.q[0], trial.motion.v[0], trial.motion.efforts[0])
    for t in range(1, 60):
        state = kalman.step(state, markers[t], trial.read.efforts[t]).state
    slid = state.u[7::order]
    assert np.argmax(np.abs(slid)) == 0
    assert slid[0] > 0.008


def test_smoothing_changes_all_frames_but_the_last_and_helps():
    trial = Recipe().trial(3)
    causal = TorqueMethod(STUDY, PendulumSettings(effort_noise=100.0))
    before, after = causal.run(trial), replace(causal, smooth=True).run(trial)
    np.testing.assert_array_equal(after.q[-1], before.q[-1])
    assert score(trial, after).torque < 0.6 * score(trial, before).torque


def test_inverse_dynamics_of_the_truth_is_the_truth(clean):
    body, motion = DoublePendulum(STUDY, residual=False), clean.motion
    for t in (0, 40, 250):
        found = joint_torque(body, motion.q[t], motion.v[t], motion.a[t], motion.efforts[t, 1:])
        assert found == pytest.approx(motion.efforts[t, 0], abs=1e-9)


def test_readings_of_the_acceleration_filter_fall_as_their_jacobian_says():
    rng = np.random.default_rng(0)
    kalman = PendulumAccelerationFilter(STUDY, 0.01, AccelerationSettings())
    x0 = np.concatenate([rng.normal(size=8), 10.0 * rng.normal(size=4), np.zeros(12)])
    x0[12 + PLATE] = 300.0 * rng.normal(size=3)
    markers, plate = rng.normal(size=8), rng.normal(size=3)

    def read(x):
        return kalman._read(DynamicState(x[:4], x[4:8], x[8:12], x[12:], np.zeros(())), markers, plate)

    numeric = -slope(lambda x: read(x)[0], x0)
    np.testing.assert_allclose(read(x0)[1], numeric, atol=1e-6 * np.abs(numeric).max())


def test_newtons_law_holds_in_the_acceleration_filter(clean):
    found = AccelerationMethod(STUDY).run(clean)
    assert np.isfinite(found.q).all()
    np.testing.assert_allclose(found.efforts[50:, 2], clean.motion.efforts[50:, 2], atol=5.0)


def test_a_filter_that_breaks_down_stops_and_scores_infinity(clean):
    """Infinite readings leave nothing that can be computed."""
    markers = clean.read.markers_m.copy()
    markers[5:] = np.inf
    broken = replace(clean, read=PendulumReadings(markers, clean.read.efforts))
    for method in (FD, AccelerationMethod(STUDY)):
        with np.errstate(all="ignore"):
            found = method.run(broken)
        assert np.isfinite(found.q[:5]).all()
        assert np.isnan(found.q[-1]).all()
        assert np.isinf(score(broken, found).torque)


def test_matched_noise_gives_matched_errors(monkeypatch):
    """Twenty frames of a few trials: 12 and 11 are due, and the whole run is held to the bands."""
    exact, scheme = next(iter(SCHEMES_COMPARED.items()))
    monkeypatch.setattr(consistency, "SCHEMES_COMPARED", {exact: scheme})
    monkeypatch.setattr(consistency, "FRAMES", 20)
    trials = [consistency_of(seed)[exact] for seed in range(12)]
    assert np.mean([one.nees[:20] for one in trials]) == pytest.approx(12.0, abs=2.5)
    assert np.mean([one.nis[:20] for one in trials]) == pytest.approx(11.0, abs=1.5)
