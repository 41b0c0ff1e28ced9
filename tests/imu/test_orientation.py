"""Orientations over recordings: frames, groups, gaps, starts, angles; and the public benchmark with its truth."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.frames import change_frame, exponential
from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import METHODS, OrientSettings, euler_angles, first_readings, orientations
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.cardan import quaternion_matrices
from tests.imu.turning import apart_deg, turning

MADE = turning(6.0)
ONE = MADE.readings()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("frame", ["ENU", "NED", "NWU"])
def test_every_filter_speaks_the_frame_it_is_asked_for(method, frame):
    (course,) = orientations([ONE], frame=frame, settings=OrientSettings(method))
    assert course.frame == frame
    truth = change_frame(MADE.truth, "NWU", frame)
    assert apart_deg(course.quaternion, truth).max() < 6.0
    assert (course.sd_rad is None) == (method == "madgwick")


def test_the_frame_has_to_be_said():
    with pytest.raises(TypeError):
        orientations([ONE])
    with pytest.raises(UnknownName, match="ENU"):
        orientations([ONE], frame="XYZ")
    with pytest.raises(UnknownName, match="ekf"):
        OrientSettings("kalman")


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_sensors_of_different_kinds_run_in_one_call_and_in_order(method):
    plain = replace(ONE, name="b", magnetic_field=None)
    short = turning(3.0, 4).readings("c")
    many = orientations(
        [ONE, plain, short, replace(ONE, name="d")], frame="NWU", settings=OrientSettings(method)
    )
    assert [one.name for one in many] == ["a", "b", "c", "d"]
    np.testing.assert_allclose(many[0].quaternion, many[3].quaternion, atol=1e-12)
    (alone,) = orientations([plain], frame="NWU", settings=OrientSettings(method))
    np.testing.assert_allclose(many[1].quaternion, alone.quaternion, atol=1e-9)


def test_many_sensors_side_by_side_are_as_few():
    crowd = [replace(ONE, name=str(k)) for k in range(22)]
    settings = OrientSettings("madgwick", madgwick=MadgwickSettings(0.2, 0.01))
    many, (one,) = (
        orientations(crowd, frame="NWU", settings=settings),
        orientations([ONE], frame="NWU", settings=settings),
    )
    np.testing.assert_allclose(many[21].quaternion, one.quaternion, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_a_given_start_is_taken(method):
    start = change_frame(MADE.truth[:1], "NWU", "ENU")
    (course,) = orientations([ONE], frame="ENU", settings=OrientSettings(method), start=start)
    if method != "smooth":
        assert apart_deg(course.quaternion[:1], start)[0] < 1e-6


def test_where_the_gyroscope_is_missing_nothing_is_claimed():
    gyro = ONE.angular_velocity_rad_s.copy()
    gyro[100:110] = np.nan
    (course,) = orientations([replace(ONE, angular_velocity_rad_s=gyro)], frame="NWU")
    missing = np.isnan(course.quaternion).any(axis=1)
    np.testing.assert_array_equal(np.flatnonzero(missing), np.arange(100, 110))
    assert apart_deg(course.quaternion[300:], MADE.truth[300:]).max() < 6.0


def test_what_cannot_be_followed_is_refused():
    nothing = np.full_like(ONE.angular_velocity_rad_s, np.nan)
    with pytest.raises(InvalidInput, match="no gyroscope"):
        orientations([replace(ONE, angular_velocity_rad_s=nothing)], frame="NWU")
    force = ONE.specific_force_mps2.copy()
    force[:50] = np.nan
    with pytest.raises(InvalidInput, match="at the start"):
        orientations([replace(ONE, specific_force_mps2=force)], frame="NWU")


def test_euler_angles_are_unwrapped():
    turn = np.linspace(0.0, 12.0, 200)
    made = Rotation.from_euler("ZYX", np.column_stack([turn, 0.3 * np.sin(turn), 0.2 * np.cos(turn)]))
    roll, pitch, yaw = euler_angles(made.as_quat()).T
    np.testing.assert_allclose(yaw, turn, atol=1e-9)
    np.testing.assert_allclose(pitch, 0.3 * np.sin(turn), atol=1e-9)
    np.testing.assert_allclose(roll, 0.2 * np.cos(turn), atol=1e-9)
    some = made.as_quat()
    some[50] = np.nan
    angles = euler_angles(some)
    assert np.isnan(angles[50]).all()
    np.testing.assert_allclose(angles[199, 2], 12.0)


def test_progress_is_told():
    calls = []
    orientations([ONE], frame="NWU", settings=OrientSettings("madgwick"), progress=lambda *x: calls.append(x))
    assert [stage for stage, _, _ in calls] == ["Orientation"]
    assert calls[-1][2] == ONE.samples


@pytest.mark.slow
def test_madgwick_on_the_public_benchmark(real_data):
    """Trial 16 of BROAD: 4.8° in all and 2.7° of inclination, as published for beta 0.1."""
    import scipy.io

    from mbkf.imu.orientation_error import orientation_error
    from mbkf.io.imu.files import read_imu

    path = real_data / "imu_broad" / "16_undisturbed_fast_translation_B.mat"
    (one,) = read_imu(path)
    (course,) = orientations([one], frame="ENU", settings=OrientSettings("madgwick"))
    judged = scipy.io.loadmat(path)["movement"].ravel().astype(bool)
    error = orientation_error(course.quaternion, one.orientation, judged)
    assert np.degrees(error.total) == pytest.approx(4.8, rel=0.1)
    assert np.degrees(error.inclination) == pytest.approx(2.7, rel=0.1)


def test_the_first_readings_of_a_sensor_in_motion_show_the_vertical():
    """A board swung to and fro by hand: turned back by the gyroscope, accelerations cancel."""
    rate, t = 100.0, np.arange(300) / 100.0
    turn = np.column_stack([0.0 * t, 0.8 * np.sin(5.0 * t), 0.0 * t])
    rates = np.column_stack([0.0 * t, 4.0 * np.cos(5.0 * t), 0.0 * t])
    R = quaternion_matrices(exponential(turn))
    shaken = np.column_stack([15.0 * np.sin(2.0 * np.pi * t), 10.0 * np.cos(2.0 * np.pi * t), 0.0 * t])
    world = shaken + np.array([0.0, 0.0, 9.80665])
    local = np.einsum("tji,tj->ti", R, world)
    force, field = first_readings(ImuReadings("board", t, local, rates, None, rate))
    assert field is None
    tilt = np.degrees(np.arccos(force[2] / np.linalg.norm(force)))
    plain = local[:25].mean(axis=0)
    assert tilt < 3.0 < np.degrees(np.arccos(plain[2] / np.linalg.norm(plain)))


def test_a_lost_packet_is_bridged_where_later_ones_are_known():
    """One lost sample in motion leaves no more doubt about the heading than a whole recording; ten do."""
    spreads, apart = [], []
    for lost in (0, 1, 10):
        parts = [x.copy() for x in (MADE.gyro, MADE.force, MADE.field)]
        for values in parts:
            values[400 : 400 + lost] = np.nan
        one = replace(
            MADE.readings(),
            angular_velocity_rad_s=parts[0],
            specific_force_mps2=parts[1],
            magnetic_field=parts[2],
        )
        (course,) = orientations([one], frame="NWU", settings=OrientSettings("smooth"))
        assert np.isnan(course.quaternion).any(axis=1).sum() == lost
        spreads.append(course.sd_rad[420, 2])
        apart.append(apart_deg(course.quaternion[420:], MADE.truth[420:]).max())
    assert spreads[1] < 1.02 * spreads[0] < 1.1 * spreads[0] < spreads[2]
    assert abs(apart[1] - apart[0]) < 0.1
