"""Mounts without magnetometers: tilt by gravity is exact, heading is found from swinging, odd mounts are told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.placement import typical_mounts
from mbkf.imu.worn_mounts import MountSettings, upright, worn_mounts
from mbkf.io.imu.readings import ImuReadings
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import quaternion_matrices

MODEL = HumanModel.scaled()
UP = np.array([0.0, 0.0, 9.80665])
BIAS = np.array([0.01, -0.02, 0.005])


def readings(R, rates, name="right_thigh"):
    """A sensor (sensor → segment R) that stands, and one whose segment turns by rates about its axes."""
    still = ImuReadings(
        name, np.arange(200) / 100, np.tile(UP @ R, (200, 1)), np.tile(BIAS, (200, 1)), None, 100.0
    )
    moving = ImuReadings(
        name, np.arange(len(rates)) / 100, np.tile(UP @ R, (len(rates), 1)), rates @ R + BIAS, None, 100.0
    )
    return still, moving


def swinging(axis, seconds=4.0):
    t = np.arange(0.0, seconds, 0.01)
    return 3.0 * np.sin(6.0 * t)[:, None] * np.asarray(axis) + 0.01 * np.random.default_rng(0).normal(
        size=(len(t), 3)
    )


def found(R, rates, segment="right_thigh", **settings):
    still, moving = readings(R, rates, segment)
    return worn_mounts(
        MODEL, (segment,), (still,), (moving,), MODEL.neutral(), True, MountSettings(**settings)
    )


USUAL = quaternion_matrices(typical_mounts(MODEL, ("right_thigh",))[0].rotation)


@pytest.mark.parametrize("turn_deg", [-25.0, 10.0])
def test_tilt_and_heading_are_found_where_the_leg_swings(turn_deg):
    tilt = Rotation.from_rotvec([0.1, -0.15, 0.0]).as_matrix()
    R = Rotation.from_rotvec([0.0, 0.0, np.radians(turn_deg)]).as_matrix() @ tilt @ USUAL
    worn = found(R, swinging([0.0, 1.0, 0.0]), custom_sd_rad=10.0)
    off = Rotation.from_matrix(quaternion_matrices(worn.mounts[0].rotation) @ R.T).as_rotvec()
    np.testing.assert_allclose(np.degrees(off), 0.0, atol=1.0)
    assert not worn.remarks


@pytest.mark.parametrize("seconds", [0.5, 2.0, 10.0])
def test_a_bias_is_known_by_how_long_the_person_stood(seconds):
    """The mean reading is off by sway over time; it and what biases usually are count by their spreads."""
    s = MountSettings()
    still, moving = readings(USUAL, swinging([0.0, 1.0, 0.0]))
    count = round(100 * seconds)
    still = ImuReadings(
        still.name,
        np.arange(count) / 100,
        np.tile(UP @ USUAL, (count, 1)),
        np.tile(BIAS, (count, 1)),
        None,
        100.0,
    )
    worn = worn_mounts(MODEL, ("right_thigh",), (still,), (moving,), MODEL.neutral(), True, s)
    sway, usual = (s.sway_rad / seconds) ** 2, s.usual_bias_rad_s**2
    np.testing.assert_allclose(worn.bias_rad_s[0], BIAS * usual / (usual + sway), rtol=1e-9)
    assert worn.bias_sd_rad_s[0] ** -2 == pytest.approx(1.0 / sway + 1.0 / usual, rel=1e-9)


def test_an_angular_velocity_that_follows_from_orientations_has_no_bias():
    still, moving = readings(USUAL, swinging([0.0, 1.0, 0.0]))
    known = MODEL, ("right_thigh",), (still,), (moving,), MODEL.neutral(), True
    worn = worn_mounts(*known, derived=("right_thigh",))
    assert not worn.bias_rad_s.any() and worn.bias_sd_rad_s[0] < 1e-3


def test_custom_and_swinging_count_by_their_spreads():
    R = Rotation.from_rotvec([0.0, 0.0, 0.2]).as_matrix() @ USUAL
    even = found(R, swinging([0.0, 1.0, 0.0]), custom_sd_rad=0.1, swing_sd_rad=0.1)
    off = Rotation.from_matrix(quaternion_matrices(even.mounts[0].rotation) @ USUAL.T).as_rotvec()
    assert off[2] == pytest.approx(0.1, abs=0.01)
    assert even.turn_sd_rad[0, 2] == pytest.approx(0.1 / np.sqrt(2.0), rel=0.01)


def test_a_leg_that_does_not_swing_is_as_usual_and_less_sure():
    R = Rotation.from_rotvec([0.0, 0.0, 0.2]).as_matrix() @ USUAL
    worn = found(R, swinging([0.0, 0.0, 0.0]))
    off = Rotation.from_matrix(quaternion_matrices(worn.mounts[0].rotation) @ USUAL.T).as_rotvec()
    assert abs(off[2]) < 1e-6 and worn.turn_sd_rad[0, 2] == MountSettings().custom_sd_rad


def test_a_sensor_strapped_on_otherwise_is_told_and_put_right():
    R = Rotation.from_rotvec([0.0, 0.0, np.radians(70.0)]).as_matrix() @ USUAL
    worn = found(R, swinging([0.0, 1.0, 0.0]))
    assert len(worn.remarks) == 1 and "70 deg" in worn.remarks[0]
    off = Rotation.from_matrix(quaternion_matrices(worn.mounts[0].rotation) @ R.T).as_rotvec()
    assert np.degrees(np.linalg.norm(off)) < 1.0


directions = st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 0.1)


@given(directions, directions)
def test_what_is_felt_points_up_afterwards(felt, up):
    felt, up = np.array(felt), np.array(up) / np.linalg.norm(up)
    R = upright(np.eye(3), felt, up)
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(R @ felt / np.linalg.norm(felt), up, atol=1e-9)
    assert matrix_quaternion(R).shape == (4,)
