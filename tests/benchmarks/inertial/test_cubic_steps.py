"""The study's simulated walk."""

import numpy as np
import pytest

from benchmarks.inertial.cubic_steps import CASES, RATE_HZ, SHAPES, cubic_steps
from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput, UnknownName


def test_positions_are_those_the_study_describes():
    walk = cubic_steps()
    at = {t: walk.position_m[round(t * RATE_HZ)] for t in (0.0, 1.0, 1.5, 2.0, 3.0, 3.5, 4.0, 4.9)}
    assert at[0.0] == pytest.approx([0.0, 0.0, 0.0])
    assert at[1.5] == pytest.approx([0.5, 0.0, 0.5])
    assert at[2.0] == pytest.approx([1.0, 0.0, 1.0])
    assert at[3.0] == pytest.approx([1.0, 0.0, 1.0])
    assert at[3.5] == pytest.approx([1.5, 0.0, 0.5])
    assert at[4.9] == pytest.approx([2.0, 0.0, 0.0])
    assert np.diff(walk.position_m[:, 0]).min() >= 0.0


def test_readings_integrate_twice_to_the_position():
    walk = cubic_steps()
    a = walk.specific_force_mps2 - [0.0, 0.0, GRAVITY_M_S2]
    velocity = np.cumsum(a, axis=0) / RATE_HZ
    position = np.cumsum(velocity, axis=0) / RATE_HZ
    assert np.allclose(position[:-1], walk.position_m[1:], atol=1e-9)
    assert np.abs(walk.angular_velocity_rad_s).max() == 0.0


def test_within_a_step_the_acceleration_is_that_of_the_cubic():
    walk = cubic_steps()
    u = walk.time_s[55:95] - 1.0
    assert np.allclose(walk.specific_force_mps2[55:95, 0], 6.0 - 12.0 * u, atol=1e-9)


def test_cases_add_their_errors():
    clean, noise, drift = (cubic_steps(case) for case in ("clean", "noise", "drift"))
    added = noise.specific_force_mps2 - clean.specific_force_mps2
    assert added.std() == pytest.approx(0.06, rel=0.1)
    assert np.allclose(drift.angular_velocity_rad_s, 0.1)
    assert np.array_equal(drift.specific_force_mps2, clean.specific_force_mps2)
    assert len(CASES) == 4


def test_seeds_differ_and_repeat():
    one, same, other = (cubic_steps("noise", seed).specific_force_mps2 for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_a_delay_moves_the_motion_and_not_the_samples():
    late = cubic_steps(delay_s=0.1)
    assert np.allclose(late.position_m[5:], cubic_steps().position_m[:-5])
    assert np.array_equal(late.time_s, cubic_steps().time_s)


@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_is_a_cubic_step_of_one_metre(shape):
    walk = cubic_steps(shape=shape)
    assert np.allclose(walk.position_m[[50, 100, 150, 200, 249], 0], [0.0, 1.0, 1.0, 2.0, 2.0])
    assert np.allclose(np.diff(walk.position_m[51:100, 0], 4), 0.0, atol=1e-12)


def test_the_gyroscopes_constant_has_a_direction():
    walk = cubic_steps("drift", direction=(0.0, -1.0, 0.5))
    assert np.allclose(walk.angular_velocity_rad_s, [0.0, -0.1, 0.05])


def test_bad_requests_are_refused():
    with pytest.raises(UnknownName, match="nois"):
        cubic_steps("nois")
    with pytest.raises(UnknownName, match="round"):
        cubic_steps(shape="round")
    with pytest.raises(InvalidInput, match="delay"):
        cubic_steps(delay_s=1.0)
