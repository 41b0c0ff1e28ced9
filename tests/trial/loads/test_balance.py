"""Newton's law over windows: weights, both sides, and the frames that count."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.loads.balance import LoadBalance, Window
from tests.bodies_in_balance import MASS_KG, RATE_HZ, UP, WEIGHT_N, moving, unloaded
from tests.motions import assert_near, random_model, smooth_motion

rng = np.random.default_rng(3)


@pytest.mark.parametrize("rate_hz", [30.0, 60.0, 100.0, 300.0])
@pytest.mark.parametrize("duration_s", [0.1, 0.5, 1.0])
def test_positions_weigh_as_a_mean_acceleration(duration_s, rate_hz):
    window = Window.of(duration_s, rate_hz)
    t = np.arange(len(window)) / rate_hz
    assert_near(window.by_position @ np.ones_like(t), 0.0, 1e-9)
    assert_near(window.by_position @ t, 0.0, 1e-9)
    assert_near(window.by_position @ (0.5 * t**2), 1.0, 1e-9)


@pytest.mark.parametrize("rate_hz", [30.0, 100.0])
def test_forces_weigh_as_the_second_differences_of_positions(rate_hz):
    """Whatever moves exactly as the forces say leaves nothing."""
    window = Window.of(0.5, rate_hz)
    x = rng.normal(size=len(window) + 2)
    fast = np.diff(x, 2) * rate_hz**2
    assert_near(window.by_force @ fast, window.by_position @ x[1:-1], 1e-9)
    assert_near(window.by_force.sum(), 1.0, 1e-12)


def missing(balance, duration_s=0.5):
    return balance.means(duration_s).missing(balance.mass_kg)


def test_a_motion_under_its_own_forces_misses_nothing():
    assert_near(missing(moving()), 0.0, 1e-3 * WEIGHT_N)


def test_what_the_feet_lack_is_missing_and_points_the_way_it_acts():
    push = np.array([12.0, -7.0, 90.0])
    found = missing(unloaded(moving(), push))
    assert_near(found, np.broadcast_to(push, found.shape), 1e-3 * WEIGHT_N)


def test_forces_on_other_parts_count():
    held = unloaded(moving(), 200.0 * UP)
    held = replace(held, others_n=np.tile(200.0 * UP, (len(held.judged), 1)))
    assert_near(missing(held), 0.0, 1e-3 * WEIGHT_N)


def test_another_mass_requires_another_force():
    balance = moving(height_m=0.0)
    found = balance.means(1.0).missing(1.1 * MASS_KG)
    assert_near(found[:, 2], 0.1 * WEIGHT_N, 1e-6)


def test_windows_lie_in_judged_frames():
    balance = moving(4.0)
    judged = balance.judged.copy()
    judged[150] = judged[380:] = False
    balance = replace(balance, judged=judged)
    means = balance.means(0.5)
    begins = np.flatnonzero(means.judged)
    assert means.frames == 61
    assert begins.min() == 0 and begins.max() == 380 - 61
    assert not ((begins > 150 - 61) & (begins <= 150)).any()
    assert np.isnan(means.missing(MASS_KG)[~means.judged]).all()


def test_a_trial_shorter_than_a_window_has_none():
    balance = moving(0.4)
    means = balance.means(0.5)
    assert not means.judged.any() and means.missing(MASS_KG).shape == (0, 3)
    assert np.isnan(balance.course(means, means.missing(MASS_KG))).all()


def test_the_course_stands_at_the_middle_and_reaches_to_the_ends():
    balance = moving(2.0)
    means = balance.means(0.5)
    values = np.arange(len(means.judged))[:, None] * np.ones(3)
    course = balance.course(means, values)[:, 0]
    assert course[100] == 100 - 30
    assert (course[:30] == 0.0).all() and (course[-30:] == len(values) - 1).all()


def test_frames_of_windows():
    balance = moving(2.0)
    windows = np.zeros(len(balance.means(0.5).judged), dtype=bool)
    windows[[10, 11]] = True
    covered = balance.covered(windows, 61)
    assert np.flatnonzero(covered).tolist() == list(range(10, 11 + 61))


def test_of_a_motion():
    model = random_model(rng)
    q, _, _ = smooth_motion(model, rng).frames(30, RATE_HZ)
    q[20] = np.nan
    feet = rng.normal(size=(30, 2, 3))
    feet[25] = np.nan
    judged = np.ones(30, dtype=bool)
    judged[[5, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19]] = False
    found = LoadBalance.of(model, q, RATE_HZ, feet, np.zeros((30, 3)), judged)
    assert not found.judged[10:21].any() and not found.judged[25]
    assert found.judged[5]  # a short gap is bridged
    assert_near(found.centre_m[3], model.centre_of_mass(q[3]), 1e-12)
    assert_near(found.feet_n[3], feet[3], 0.0)
    assert found.mass_kg == model.mass_kg and found.weight_n == pytest.approx(9.80665 * model.mass_kg)
