"""Errors fall apart into a turn about the vertical and a tilt."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import ShapeError
from mbkf.imu.orientation_error import error_angles, orientation_error


def test_heading_and_inclination_are_told_apart():
    truth = Rotation.random(50, rng=np.random.default_rng(0))
    turned = Rotation.from_rotvec([0, 0, 0.3]) * truth
    total, heading, inclination = error_angles(-turned.as_quat(), truth.as_quat())
    np.testing.assert_allclose(total, 0.3, atol=1e-9)
    np.testing.assert_allclose(heading, 0.3, atol=1e-9)
    np.testing.assert_allclose(inclination, 0.0, atol=1e-7)
    tilted = Rotation.from_rotvec([0.12, -0.16, 0.0]) * truth
    total, heading, inclination = error_angles(tilted.as_quat(), truth.as_quat())
    np.testing.assert_allclose(total, 0.2, atol=1e-9)
    np.testing.assert_allclose(heading, 0.0, atol=1e-9)
    np.testing.assert_allclose(inclination, 0.2, atol=1e-9)


def test_unknown_and_unjudged_samples_do_not_count():
    truth = Rotation.random(4, rng=np.random.default_rng(0)).as_quat()
    estimate = truth.copy()
    estimate[0] = np.nan
    estimate[1] = [0, 0, 0, 1]
    error = orientation_error(estimate, truth, np.array([True, False, True, True]))
    assert error.samples == 2
    assert error.total == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(ShapeError):
        error_angles(truth, truth[:2])
