"""Orientations over a recording: the kernel's are the reference's, whatever is missing."""

import numpy as np
import pytest

from mbkf.imu.orientation_course import orientation_course
from mbkf.imu.orientation_ekf import OrientationFilter, OrientationSettings
from mbkf.kernel.loading import SWITCH, library

SETTINGS = (OrientationSettings(), OrientationSettings(integrating=False, rest_bias=False))


def readings(seed=0, count=400, sensors=3):
    """Sensors that turn, rest and lose samples of every instrument."""
    rng = np.random.default_rng(seed)
    times = np.arange(count)[:, None, None] / 100.0
    phases = rng.uniform(0.0, 6.0, (2, 1, sensors, 3))
    gyro = 2.0 * np.sin(3.0 * times + phases[0]) + 0.01 * rng.normal(size=(count, sensors, 3))
    force = np.array([0.0, 0.0, 9.81]) + 3.0 * np.sin(5.0 * times + phases[1])
    field = np.array([20.0, 0.0, -40.0]) + rng.normal(size=(count, sensors, 3))
    gyro[200:, 0], force[200:, 0] = 0.004, [0.0, 0.0, 9.8]  # the first one rests
    for values, start in ((gyro, 50), (force, 90), (field, 120)):
        values[start : start + 7, 1, 2] = np.nan
    return gyro, force, field


def both_kernels(monkeypatch, *args, **kwargs):
    found = []
    for name in ("compiled", "reference"):
        monkeypatch.setenv(SWITCH, name)
        library.cache_clear()
        found.append(orientation_course(*args, **kwargs))
    library.cache_clear()
    return found


@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("settings", SETTINGS)
@pytest.mark.parametrize("magnetic", [True, False])
def test_the_kernel_repeats_the_reference(monkeypatch, smooth, settings, magnetic):
    if library() is None:
        pytest.skip("the kernel is not compiled here")
    gyro, force, field = readings()
    kalman = OrientationFilter(0.01, settings)
    start = kalman.begin(force[0], field[0] if magnetic else None, gyro[0])
    compiled, reference = both_kernels(
        monkeypatch, kalman, start, gyro, force, field if magnetic else None, smooth=smooth
    )
    for ours, theirs in zip(compiled, reference, strict=True):
        assert ours.shape == theirs.shape
        assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()
    np.testing.assert_allclose(compiled.variance, reference.variance, rtol=1e-6)


def test_every_sample_is_counted(either_kernel):
    gyro, force, field = readings(count=50)
    kalman, counted = OrientationFilter(0.01), []
    start = kalman.begin(force[0], field[0], gyro[0])
    course = orientation_course(
        kalman, start, gyro, force, field, smooth=True, count_one=lambda: counted.append(1)
    )
    assert len(counted) == 49
    assert course.quaternion.shape == (50, 3, 4)
    np.testing.assert_allclose(np.linalg.norm(course.quaternion, axis=2), 1.0)


def test_the_first_sample_alone_is_the_start(either_kernel):
    gyro, force, field = readings(count=1)
    kalman = OrientationFilter(0.01)
    start = kalman.begin(force[0], field[0], gyro[0])
    course = orientation_course(kalman, start, gyro, force, field, smooth=True)
    np.testing.assert_allclose(course.quaternion[0], start.quaternion, rtol=1e-12)
