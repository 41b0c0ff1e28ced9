"""Rest told at once: by the same statistic as in a recording, later at its beginning, at once at its end."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2
from mbkf.imu.rest_watch import FeetAtRest, RestWatch
from mbkf.imu.zero_velocity import StillnessSettings, still_samples
from tests.worn import worn

SETTINGS = StillnessSettings()


def told(rates, forces, rate_hz=100.0):
    watch = RestWatch(rate_hz, SETTINGS)
    return np.array([watch.push(rate, force) for rate, force in zip(rates, forces, strict=True)])


@given(st.integers(0, 2**31), st.floats(20.0, 400.0), st.floats(0.97, 1.03))
def test_a_foot_that_does_not_move_rests_in_any_attitude(seed, rate_hz, scale):
    """Also with a scale factor of the accelerometer: only what differs from a constant of gravity's size counts."""
    up = Rotation.random(random_state=seed).apply([0.0, 0.0, GRAVITY_M_S2])
    forces = np.tile(scale * up, (200, 1))
    found = told(np.zeros((200, 3)), forces, rate_hz)
    size = max(3, round(SETTINGS.window_s * rate_hz)) | 1
    np.testing.assert_array_equal(found, np.arange(200) >= size - 1)


def test_it_is_the_rest_of_a_recording_later_at_its_beginning_and_hardly_longer():
    walk = worn("walk", 4.0)
    foot = next(one for one in walk.moving if one.name == "right_foot")
    rates, forces = foot.angular_velocity_rad_s, foot.specific_force_mps2
    live, recorded = told(rates, forces), still_samples(forces, rates, 100.0, SETTINGS)
    begins = np.flatnonzero(np.diff(recorded.astype(int)) == 1)
    ends = np.flatnonzero(np.diff(recorded.astype(int)) == -1)
    assert len(begins) >= 3
    assert live.mean() == pytest.approx(recorded.mean(), abs=0.08)
    for begin in begins[begins < 360]:
        assert live[begin : begin + 25].any()
    for end in ends[ends < 390]:
        assert not live[end + 6 : end + 12].any()


def test_a_foot_that_lifts_moves_at_once():
    rates, forces = np.zeros((60, 3)), np.tile([0.0, 0.0, GRAVITY_M_S2], (60, 1))
    rates[40:, 1] = 1.0
    assert told(rates, forces)[39] and not told(rates, forces)[40:].any()


def test_after_a_missing_sample_a_foot_has_to_rest_anew():
    rates, forces = np.zeros((60, 3)), np.tile([0.0, 0.0, GRAVITY_M_S2], (60, 1))
    forces[30, 2] = np.nan
    found = told(rates, forces)
    assert found[29] and not found[30:41].any() and found[41]


def test_feet_are_told_apart_and_lost_frames_are_movement():
    feet = FeetAtRest(("right_foot", "left_foot"), ("pelvis", "left_foot"), 100.0, SETTINGS)
    still = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, GRAVITY_M_S2], (2, 1))
    for _ in range(30):
        found = feet.push(still)
    np.testing.assert_array_equal(found, [0.0, 1.0])
    np.testing.assert_array_equal(feet.push(None), [0.0, 0.0])
