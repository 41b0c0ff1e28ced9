"""Trunks and arms are no feet; feet that rest, run, roll or shuffle are not refused."""

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from benchmarks.inertial.stride_feet import simulated_foot
from mbkf.errors import InvalidInput
from mbkf.imu.worn_on_foot import elsewhere
from mbkf.imu.zero_velocity import StillnessSettings, still_samples
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.readings import ImuReadings
from mbkf.trial.inertial.stride import measure_strides


def reason(one):
    force, rates = one.specific_force_mps2, one.angular_velocity_rad_s
    return elsewhere(force, one.rate_hz, still_samples(force, rates, one.rate_hz, StillnessSettings()))


def trunk(strike_mps2, walking_s=20.0, rate_hz=100.0):
    """A trunk that stands, and sways and bounces as the person walks."""
    time = np.arange(round((walking_s + 4.0) * rate_hz)) / rate_hz
    walking = ((time > 2.0) & (time < 2.0 + walking_s)).astype(float)
    sway = np.stack([np.sin(6.0 * time), np.cos(6.0 * time), np.sin(12.0 * time)], axis=1) * walking[:, None]
    force = np.array([0.0, 0.0, 9.80665]) + np.array([1.0, 1.0, strike_mps2]) * sway
    return ImuReadings("back", time, force, 1.2 * sway, None, rate_hz)


def test_a_trunk_is_refused_with_how_long_it_moves():
    assert "without a rest" in reason(trunk(3.0))
    with pytest.raises(InvalidInput, match=r"sensor back: it moves for up to 20\.\d s .* worn elsewhere"):
        measure_strides([trunk(3.0)])


def test_strikes_and_a_short_movement_prove_nothing():
    assert reason(trunk(15.0)) == ""
    assert reason(trunk(3.0, walking_s=4.0)) == ""


@pytest.mark.parametrize("kind", ["running", "never flat", "sand", "mounted softly"])
def test_feet_that_hardly_rest_are_feet(kind):
    assert reason(simulated_foot(kind, 0).readings) == ""


def test_a_foot_that_shuffles_is_one():
    slow = foot_walk((0.3,) * 8, swing_s=1.0, pitch_rad=0.3, force_noise_m_s2=0.05, rate_noise_rad_s=0.01)
    assert reason(slow.readings) == ""


def test_public_recordings(real_data):
    path = real_data / "strangers3" / "lower_back_sensor_60s.csv"
    (back,) = read_imu(path, units={"acc": "g", "gyr": "deg/s"}, rate_hz=100.0)
    with pytest.raises(InvalidInput, match="worn elsewhere"):
        measure_strides([back])
    body = read_imu(real_data / "imu_qmt_fullbody" / "full_body_example_data.mat")
    accused = {one.name for one in body if reason(one)}
    assert not accused & {"foot_left", "foot_right"}
    assert accused >= {"hip", "lower_back", "upper_back", "head", "hand_left", "forearm_right", "hand_right"}
