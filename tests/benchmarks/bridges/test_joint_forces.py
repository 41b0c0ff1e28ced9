"""The force in a joint by Newton's law."""

import numpy as np

from benchmarks.bridges.joint_forces import missing_force

GRAVITY = np.array([0.0, -9.81, 0.0])


def test_a_swung_body_is_held_by_the_force_towards_the_joint_less_what_others_give():
    """A body of 2 kg circles a joint at 0.4 m, 3 rad/s; a muscle and the ground push it with known forces."""
    times_s, rows = np.linspace(0.0, 1.0, 101), np.array([20, 50, 80])
    ray = np.column_stack([np.cos(3.0 * times_s), np.sin(3.0 * times_s), np.zeros(101)])
    pushed = np.array([[5.0, 1.0, 0.0], [0.0, 0.0, 7.0], [-3.0, 2.0, 1.0]])
    found = missing_force(times_s, 2.0 * 0.4 * ray, rows, pushed + 2.0 * GRAVITY)
    towards = -2.0 * 0.4 * 3.0**2 * ray[rows]
    np.testing.assert_allclose(found, towards - 2.0 * GRAVITY - pushed, atol=1e-6)
