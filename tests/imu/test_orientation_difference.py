"""Differences of two orientations: the nearer sign, no whole turns, and the turn between in its parts."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import ShapeError
from mbkf.imu.orientation_difference import orientation_difference
from mbkf.imu.orientation_error import error_angles
from tests.imu.turning import turning


def test_a_turn_about_the_vertical_is_heading_and_yaw():
    yaw = np.radians([170.0, 175.0, 179.0, 179.5])
    first, second = (
        Rotation.from_euler("z", (yaw + more)[:, None]).as_quat() for more in (0.0, np.radians(2.0))
    )
    second[2:] *= -1.0
    found = orientation_difference(first, second)
    np.testing.assert_allclose(np.degrees(found.heading_rad), 2.0, atol=1e-9)
    np.testing.assert_allclose(np.degrees(found.euler_rad), np.tile([0.0, 0.0, 2.0], (4, 1)), atol=1e-9)
    np.testing.assert_allclose(found.inclination_rad, 0.0, atol=1e-9)
    np.testing.assert_allclose(found.angle_rad, np.radians(2.0), atol=1e-9)
    assert np.abs(found.components).max() < 0.02
    np.testing.assert_allclose(found.quaternion - found.components, first, atol=1e-12)


def test_the_turn_is_that_of_the_errors():
    truth = turning(3.0).truth
    other = (Rotation.from_rotvec([0.1, -0.05, 0.2]) * Rotation.from_quat(truth)).as_quat()
    found = orientation_difference(truth, other)
    for mine, theirs in zip(
        (found.angle_rad, found.heading_rad, found.inclination_rad), error_angles(other, truth), strict=True
    ):
        np.testing.assert_allclose(mine, theirs, atol=1e-12)
    assert np.linalg.norm(found.components, axis=1) == pytest.approx(2.0 * np.sin(found.angle_rad / 4.0))


def test_missing_samples_stay_missing_and_lengths_agree():
    truth = turning(1.0).truth.copy()
    truth[5] = np.nan
    found = orientation_difference(truth, truth)
    assert np.flatnonzero(np.isnan(found.angle_rad)).tolist() == [5]
    with pytest.raises(ShapeError):
        orientation_difference(truth, truth[1:])
