"""Angular velocities from orientations: exact for a steady turn, second order else; own gyroscopes are kept."""

import numpy as np

from mbkf.imu.frames import exponential, multiply
from mbkf.imu.turning import turning, with_turning
from mbkf.io.imu.readings import ImuReadings

DT = 0.01


def course(rates):
    q = [np.array([0.1, -0.3, 0.2, 0.9])]
    q[0] /= np.linalg.norm(q[0])
    for rate in rates[:-1]:
        q.append(multiply(q[-1][None], exponential(DT * rate[None]))[0])
    return np.array(q)


def test_a_steady_turn_comes_back():
    rates = np.tile([1.0, -2.0, 3.0], (100, 1))
    found = turning(course(rates), DT * np.arange(100))
    np.testing.assert_allclose(found, rates, atol=1e-9)


def test_a_changing_turn_comes_back_in_the_middle_of_its_steps():
    t = DT * np.arange(300)
    rates = np.column_stack([np.sin(3 * t), np.cos(2 * t), 0.5 * np.sin(5 * t)])
    found = turning(course(rates), t)
    middle = 0.5 * (rates[:-1] + rates[1:])
    np.testing.assert_allclose(found[1:-1], middle[:-1], atol=0.03)


def test_a_gyroscope_of_its_own_is_kept_and_a_missing_one_replaced():
    q, zero = course(np.tile([0.0, 1.0, 0.0], (50, 1))), np.zeros((50, 3))
    times = DT * np.arange(50)
    own = ImuReadings("a", times, zero, zero, None, 100.0, orientation=q)
    assert with_turning(own) is own
    none = ImuReadings("a", times, zero, np.full((50, 3), np.nan), None, 100.0, orientation=q)
    np.testing.assert_allclose(with_turning(none).angular_velocity_rad_s[:, 1], 1.0, atol=1e-9)
