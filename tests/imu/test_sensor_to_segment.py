"""Where forward is, how sensors are turned, and means of orientations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput
from mbkf.imu.frames import conjugate, exponential, multiply, rotate
from mbkf.imu.heading import turned
from mbkf.imu.sensor_to_segment import alignments, facing, mean_orientation

LEG = ("pelvis", "right_thigh", "right_shank", "right_foot")
KNEES = (("right_thigh", "right_shank"),)
DT = 0.01
UP = np.array([0.0, 0.0, 1.0])


def steps(heading, mounts, count=600):
    """Sensors (T, 4, 4) and rates of a leg that swings, the knee bending one way; the person faces ``heading``."""
    t = np.arange(count) * DT
    angles = [
        0.02 * np.sin(6 * t),
        -0.4 * np.sin(6 * t),
        -0.4 * np.sin(6 * t) + 0.5 * (1 - np.cos(6 * t)),
        0.3 * np.sin(6 * t),
    ]
    course = np.stack([exponential(np.column_stack([0 * t, a, 0 * t])) for a in angles], axis=1)
    course = turned(course, np.full((count, 4), heading))
    sensors = multiply(course, mounts)
    between = Rotation.from_quat(sensors[:-1].reshape(-1, 4)).inv() * Rotation.from_quat(
        sensors[1:].reshape(-1, 4)
    )
    gyro = between.as_rotvec().reshape(count - 1, 4, 3) / DT
    return sensors[1:], gyro, course[1:]


@pytest.mark.parametrize("heading", [0.0, 1.0, 2.5, -2.0])
def test_swinging_legs_show_where_forward_is(heading):
    mounts = Rotation.random(4, rng=np.random.default_rng(0)).as_quat()
    sensors, gyro, _ = steps(heading, mounts)
    standing = multiply(turned(np.tile([0.0, 0, 0, 1], (1, 4, 1)), np.full((1, 4), heading))[0], mounts)
    found = facing(LEG, sensors, gyro, standing, KNEES)
    assert np.cos(found - heading) > np.cos(0.03)


def test_still_legs_do_not():
    mounts = Rotation.random(4, rng=np.random.default_rng(0)).as_quat()
    sensors, gyro, _ = steps(0.0, mounts)
    assert facing(LEG, sensors, 0.05 * gyro, sensors[0], KNEES) is None
    assert facing(("pelvis",), sensors[:, :1], gyro[:, :1], sensors[0, :1], KNEES) is None


def test_alignment_takes_sensors_to_segments():
    mounts = Rotation.random(4, rng=np.random.default_rng(1)).as_quat()
    posture = exponential(np.random.default_rng(2).normal(0.0, 0.1, (4, 3)))
    standing = multiply(turned(posture[None], np.full((1, 4), 0.7))[0], mounts)
    found = alignments(standing, posture, 0.7)
    np.testing.assert_allclose(np.abs((found * mounts).sum(axis=1)), 1.0, atol=1e-12)
    back = multiply(standing, conjugate(found))
    np.testing.assert_allclose(rotate(back, UP), rotate(posture_at(posture, 0.7), UP), atol=1e-12)


def posture_at(posture, heading):
    return turned(posture[None], np.full((1, 4), heading))[0]


def test_the_mean_ignores_signs_and_missing_samples():
    rng = np.random.default_rng(3)
    centre = Rotation.random(2, rng=rng)
    course = np.stack([(Rotation.from_rotvec(rng.normal(0, 0.1, 3)) * centre).as_quat() for _ in range(400)])
    course[::2] *= -1.0
    course[5, 0] = np.nan
    mean = mean_orientation(course)
    apart = (Rotation.from_quat(mean) * centre.inv()).magnitude()
    assert apart.max() < 0.02
    course[:, 1] = np.nan
    with pytest.raises(InvalidInput, match="standing"):
        mean_orientation(course)
