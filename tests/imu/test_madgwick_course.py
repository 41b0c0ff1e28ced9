"""Madgwick's filter over recordings: the kernel's course is the reference's, and both are the filter's own steps."""

import numpy as np
import pytest

from mbkf.imu.madgwick import MadgwickFilter, MadgwickSettings
from mbkf.imu.madgwick_course import SIDE_BY_SIDE, madgwick_course
from mbkf.kernel.loading import SWITCH, library
from tests.imu.test_orientation_course import readings

FILTER = MadgwickFilter(0.01, MadgwickSettings(0.3, 0.02))


def starts(force, field):
    return FILTER.begin(force[0], field[0])


@pytest.mark.parametrize(
    "gains", [MadgwickSettings(0.3, 0.02), MadgwickSettings(0.1), MadgwickSettings(0.0, 0.1)]
)
@pytest.mark.parametrize("magnetic", [True, False])
def test_the_kernel_repeats_the_reference(monkeypatch, gains, magnetic):
    if library() is None:
        pytest.skip("the kernel is not compiled here")
    gyro, force, field = readings()
    force[300, 0] = 0.0
    filter_, found = MadgwickFilter(0.01, gains), []
    for name in ("compiled", "reference"):
        monkeypatch.setenv(SWITCH, name)
        library.cache_clear()
        found.append(madgwick_course(filter_, starts(force, field), gyro, force, field if magnetic else None))
    library.cache_clear()
    for ours, theirs in zip(*found, strict=True):
        assert ours.shape == theirs.shape
        np.testing.assert_allclose(ours, theirs, atol=1e-11, rtol=0)
    assert (np.abs(found[0].gyro_bias).max() > 1e-3) == (gains.zeta * gains.beta > 0.0)


def test_a_course_is_the_steps_of_the_filter(either_kernel):
    gyro, force, field = readings(count=60)
    begin = starts(force, field)
    course = madgwick_course(FILTER, begin, gyro, force, field)
    state = begin
    for k in range(1, 60):
        state = FILTER.step(state, gyro[k], force[k], field[k])
        np.testing.assert_allclose(course.quaternion[k], state.quaternion, atol=1e-12)
        np.testing.assert_allclose(course.gyro_bias[k], state.gyro_bias, atol=1e-12)
    np.testing.assert_array_equal(course.quaternion[0], begin.quaternion)


def test_every_sample_is_counted(either_kernel):
    for sensors in (2, SIDE_BY_SIDE):
        gyro, force, field = readings(count=30, sensors=sensors)
        counted = []
        madgwick_course(FILTER, starts(force, field), gyro, force, None, count_one=lambda: counted.append(1))  # noqa: B023
        assert len(counted) == 29
