"""The pendulum's motions have the efforts of inverse dynamics, and its sensors the noise they claim."""

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.double_pendulum.motions import MOTIONS, PendulumNoise, pendulum_motion, readings
from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from mbkf.errors import UnknownName

STUDY = PendulumShape(mass_1_kg=50.0, mass_2_kg=25.0)


def test_efforts_of_the_motions_are_those_of_the_specification():
    sine = pendulum_motion("sin", STUDY)
    assert sine.q.shape == (301, 4)
    low, high = sine.efforts.min(axis=0), sine.efforts.max(axis=0)
    np.testing.assert_allclose(low, [-280.7, -222.8, 176.1, -467.4], atol=0.06)
    np.testing.assert_allclose(high, [280.7, 222.8, 1222.8, 467.4], atol=0.06)
    torque = pendulum_motion("squat", STUDY).efforts[:, 0]
    assert (torque.min(), torque.max()) == pytest.approx((23.7, 217.2), abs=0.06)


@pytest.mark.parametrize("name", MOTIONS)
def test_point_2_stays_at_the_origin_and_rates_are_rates(name):
    motion, body = pendulum_motion(name, STUDY), DoublePendulum(STUDY)
    ends = np.stack([body.points(q)[4:] for q in motion.q])
    np.testing.assert_allclose(ends, 0.0, atol=1e-12)
    dt = motion.times_s[1]
    for values, rates in ((motion.q, motion.v), (motion.v, motion.a)):
        np.testing.assert_allclose(np.gradient(values, dt, axis=0)[2:-2], rates[2:-2], atol=2e-2)


def test_unknown_motion_is_refused():
    with pytest.raises(UnknownName, match="squat"):
        pendulum_motion("squad", STUDY)


def test_noise_is_as_large_as_stated_and_the_seed_decides():
    motion = pendulum_motion("squat", STUDY, seconds=20.0)
    noise = PendulumNoise(camera_m=1e-3, artefact_m=0.0, force_n=0.4, moment_nm=0.2)
    silent = PendulumNoise(camera_m=0.0, artefact_m=0.0, force_n=0.0, moment_nm=0.0)
    clean = readings(motion, silent, np.random.default_rng(0))
    found = readings(motion, noise, np.random.default_rng(0))
    np.testing.assert_array_equal(clean.efforts, motion.efforts)
    for error, sd in (
        (found.markers_m - clean.markers_m, 1e-3),
        (found.efforts[:, 1:3] - motion.efforts[:, 1:3], 0.4),
        (found.efforts[:, [0, 3]] - motion.efforts[:, [0, 3]], 0.2),
    ):
        low, high = chi2.interval(0.999, error.size)
        assert low < (error**2).sum() / sd**2 < high
    again = readings(motion, noise, np.random.default_rng(0))
    np.testing.assert_array_equal(again.markers_m, found.markers_m)


@pytest.mark.slow
def test_artefacts_differ_between_coordinates_and_last():
    motion = pendulum_motion("squat", STUDY, seconds=400.0)
    found = readings(motion, PendulumNoise(camera_m=0.0), np.random.default_rng(1)).markers_m
    body = DoublePendulum(STUDY)
    clean = readings(motion, PendulumNoise(0.0, 0.0), np.random.default_rng(1)).markers_m
    slid = found - clean
    assert body.nv == 4
    assert slid.std() == pytest.approx(0.01, rel=0.06)
    assert np.abs(np.corrcoef(slid.T) - np.eye(8)).max() < 0.3
    assert np.corrcoef(slid[:-5].ravel(), slid[5:].ravel())[0, 1] > 0.9
