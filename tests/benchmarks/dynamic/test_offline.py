"""Zero-phase inverse dynamics on motions that are known: gaps, low-pass on the manifold, derivatives, torques."""

import numpy as np
import pytest

from benchmarks.dynamic.methods import tared
from benchmarks.dynamic.offline import (
    filled,
    fitted_poses,
    generalised_forces,
    offline_motion,
    rates,
    smoothed_poses,
)
from benchmarks.references import rms
from mbkf.errors import NotObservable
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.synthesis.capture import CaptureSettings
from mbkf.synthesis.person import body_of
from mbkf.trial.synth import synthesise

RATE_HZ = 100.0
INSIDE = slice(30, -30)


@pytest.fixture(scope="module")
def squat():
    """A squat seen by almost perfect cameras: subject, body, capture, truth."""
    clean = CaptureSettings(markers_sd_m=1e-5, skin_sd_m=0.0, occlusion=0.01)
    subject, made = synthesise("squat", seconds=2.0, seed=3, settings=clean)
    return subject, body_of(subject), tared(made.trial), made.truth


def test_a_gap_in_a_cubic_is_filled_exactly_and_ends_stay_open():
    t = np.arange(40) / 40.0
    track = np.column_stack([t**3, 2 * t, 1 - t**2])
    seen = track.copy()
    seen[:3], seen[10:25] = np.nan, np.nan
    found = filled(np.stack([seen, track], axis=1))
    np.testing.assert_allclose(found[3:, 0], track[3:], atol=1e-12)
    assert np.isnan(found[:3, 0]).all()
    np.testing.assert_array_equal(found[:, 1], track)


def test_the_low_pass_keeps_a_slow_motion_and_removes_a_fast_one(squat):
    _, model, _, truth = squat
    slow = smoothed_poses(model, truth.q, RATE_HZ, 6.0)
    away = np.array([model.difference(a, b) for a, b in zip(truth.q, slow, strict=True)])
    assert rms(away[INSIDE]) < 2e-3
    np.testing.assert_allclose(np.linalg.norm(slow[:, 3:7], axis=1), 1.0)
    shake = 0.05 * np.sin(2 * np.pi * 25.0 * truth.times_s)[:, None] * np.ones(model.nv)
    shaken = np.array([model.integrate(q, step) for q, step in zip(truth.q, shake, strict=True)])
    calm = smoothed_poses(model, shaken, RATE_HZ, 6.0)
    left = np.array([model.difference(a, b) for a, b in zip(slow, calm, strict=True)])
    assert rms(left[INSIDE]) < 0.05 * rms(shake)


def test_rates_and_torques_of_the_true_motion_are_the_true_ones(squat):
    _, model, _, truth = squat
    v, a = rates(model, truth.q, RATE_HZ)
    assert rms((v - truth.v)[1:-1]) < 2e-3
    assert rms((a - truth.a)[1:-1]) < 0.01 * rms(truth.a)
    exact = generalised_forces(model, truth.q, truth.v, truth.a, truth.foot_wrench)
    np.testing.assert_allclose(exact, truth.tau, atol=1e-6)


def test_offline_practice_finds_the_torques_of_a_slow_motion(squat):
    subject, _, capture, truth = squat
    found = offline_motion(capture, subject)
    assert rms((found.tau - truth.tau)[INSIDE, 6:]) < 0.5
    assert rms((found.v - truth.v)[INSIDE, 6:]) < 0.03


def test_a_frame_without_markers_is_refused(squat):
    subject, model, capture, _ = squat
    own = {marker.name: marker for marker in subject.markers}
    followed = [own[name] for name in capture.markers.names]
    sensor = MarkerSensor(model, [m.segment for m in followed], np.array([m.position_m for m in followed]))
    frames = capture.markers.positions_m[:2].copy()
    frames[1] = np.nan
    with pytest.raises(NotObservable, match="frame 1 "):
        fitted_poses(sensor, np.full(len(followed), 0.005), frames)
