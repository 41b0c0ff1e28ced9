"""The offline filter: later samples help, and it says so."""

import numpy as np
import pytest

from mbkf.imu.orientation_ekf import OrientationFilter
from mbkf.imu.orientation_smoothing import smoothed
from tests.imu.test_orientation_ekf import BIAS, DT, noisy
from tests.imu.turning import apart_deg, turning


@pytest.mark.slow
def test_later_samples_correct_earlier_ones():
    made = turning(20.0, shake_mps2=3.0)
    gyro, force, field = (part[:, None] for part in noisy(made))
    kalman = OrientationFilter(DT)
    start = kalman.begin(force[0], field[0])
    passages = list(kalman.run(gyro, force, field, start))
    course = smoothed(start, passages)
    forward = np.array([start.quaternion[0], *(p.state.quaternion[0] for p in passages)])
    error = np.sqrt((apart_deg(course.quaternion[:, 0], made.truth) ** 2).mean())
    assert error < 0.6 * np.sqrt((apart_deg(forward, made.truth) ** 2).mean())
    np.testing.assert_allclose(course.gyro_bias[5, 0], BIAS, atol=0.004)
    variance = np.array([start.P[0].diagonal(), *(p.state.P[0].diagonal() for p in passages)])
    assert (course.variance[:, 0] <= variance * (1 + 1e-6)).all()
    np.testing.assert_allclose(course.quaternion[-1], passages[-1].state.quaternion, atol=1e-12)
