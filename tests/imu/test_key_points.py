"""The study's key-point algorithm."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from benchmarks.inertial.cubic_steps import RATE_HZ, cubic_steps
from benchmarks.inertial.foot_walks import foot_walk
from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.key_points import (
    NOISY_WEIGHTS,
    KeyPointSettings,
    _between_key_points,
    as_printed,
    blend_weight,
    follow_key_points,
    stability,
)


def path_of(walk, **changes):
    settings = KeyPointSettings(**changes)
    return follow_key_points(walk.specific_force_mps2, walk.angular_velocity_rad_s, RATE_HZ, settings)


def test_stability_is_the_studys_sum():
    f = np.zeros((2, 10, 3))
    f[0, :, 0] = [1.0, -1.0] * 5  # spread 1
    f[1, :, 1] = 2.0  # no spread, mean changes by 2
    w = np.zeros((2, 10, 3))
    w[1, :, 2] = 3.0
    assert stability(f, w, (0.1, 0.45, 0.4)) == pytest.approx([0.1, 0.45 * 2.0 + 0.4 * 3.0])


def test_steady_windows_are_key_points_and_moving_ones_are_not():
    """The study's pseudocode: S below the threshold is rest. Its prose says the reverse."""
    found = path_of(cubic_steps())
    moving = np.abs((found.time_s % 2.0) - 1.5) < 0.5
    assert not found.still[moving & (found.time_s < 4.0)].any()
    assert found.still[found.time_s < 1.0].all()
    assert (found.stability[found.still] < 1.0).all()


@given(st.floats(0.0, 1.0))
def test_the_blend_is_symmetric_and_goes_from_one_side_to_the_other(x):
    assert blend_weight(np.array(x)) + blend_weight(np.array(1.0 - x)) == pytest.approx(1.0)
    assert 0.0 <= blend_weight(np.array(x)) <= 1.0


def test_the_blend_rises_without_a_jump():
    weights = blend_weight(np.linspace(0.0, 1.0, 1001))
    assert weights[0] == 0.0
    assert weights[-1] == 1.0
    assert 0.0 < np.diff(weights).min() < np.diff(weights).max() < 3e-3


def test_half_of_the_gap_is_the_only_constant_without_a_jump():
    x = np.linspace(0.0, 1.0, 1001)
    # At 0.25 from 2·0.25² down to 1 − 2·0.75², at 0.75 from 2·0.75² down to 1 − 2·0.25².
    assert np.diff(blend_weight(x, 0.25)).min() == pytest.approx(-0.25, abs=0.01)
    assert np.diff(blend_weight(x, 0.75)).min() == pytest.approx(-0.25, abs=0.01)
    assert np.diff(blend_weight(x)).min() > 0.0


@pytest.mark.parametrize("seed", range(3))
def test_gravity_is_carried_exactly_by_a_gyroscope_that_reads_exactly(seed):
    """Steady rotation: wherever the key points are, gravity between them is the true one."""
    rng = np.random.default_rng(seed)
    angle = np.tile(0.1 * rng.normal(size=3), (30, 1))
    turned = Rotation.from_rotvec(np.arange(30)[:, None] * angle)
    true = turned.inv().apply([0.0, 0.0, GRAVITY_M_S2])
    key = np.zeros(30, dtype=bool)
    key[[3, 4, 12, 25]] = True
    found = _between_key_points(np.where(key[:, None], true, np.nan), key, angle, KeyPointSettings())
    assert np.allclose(found, true)


def test_a_biased_gyroscope_does_least_harm_near_the_key_points():
    angle = np.tile([0.02, 0.0, 0.0], (21, 1))
    true = np.tile([0.0, 0.0, GRAVITY_M_S2], (21, 1))
    key = np.zeros(21, dtype=bool)
    key[[0, 20]] = True
    off = np.linalg.norm(_between_key_points(true, key, angle, KeyPointSettings()) - true, axis=1)
    assert off[0] == off[20] == 0.0
    # Forwards and backwards drift in opposite directions and cancel in the middle.
    assert off[10] < off[5] < 0.6
    assert off == pytest.approx(off[::-1], abs=1e-9)


def test_forwards_alone_drift_grows_up_to_the_key_point_after():
    angle = np.tile([0.02, 0.0, 0.0], (21, 1))
    true = np.tile([0.0, 0.0, GRAVITY_M_S2], (21, 1))
    key = np.zeros(21, dtype=bool)
    key[[0, 20]] = True
    off = np.linalg.norm(
        _between_key_points(true, key, angle, KeyPointSettings(backwards=False)) - true, axis=1
    )
    assert off[:20] == pytest.approx(2.0 * GRAVITY_M_S2 * np.sin(0.01 * np.arange(20)))
    assert off[20] == 0.0


def test_loss_shortens_gravity_away_from_key_points():
    angle, key = np.zeros((9, 3)), np.zeros(9, dtype=bool)
    key[[0, 8]] = True
    full = np.tile([0.0, 0.0, GRAVITY_M_S2], (9, 1))
    found = np.linalg.norm(_between_key_points(full, key, angle, KeyPointSettings(loss=0.1)), axis=1)
    assert found[4] == pytest.approx(GRAVITY_M_S2 * 0.9**4)
    assert found[0] == found[8] == GRAVITY_M_S2


@pytest.mark.parametrize("case", ["clean", "noise", "drift", "noise and drift"])
def test_the_studys_walk_is_followed_with_aligned_windows(case):
    walk = cubic_steps(case, seed=1)
    found = path_of(walk, weights=NOISY_WEIGHTS if case == "noise and drift" else (0.1, 0.45, 0.45))
    true = walk.position_m[:250].reshape(25, 10, 3).mean(axis=1)
    off = np.abs(found.position_m - true)
    assert off[-1, 0] < 0.15
    assert off[:, 0].mean() < 0.08
    assert off[-1, 2] < 0.15  # up with the first step and down with the second


def test_the_first_rest_takes_a_constant_bias_away():
    clean, drift = (path_of(cubic_steps(case)) for case in ("clean", "drift"))
    kept = path_of(cubic_steps("drift"), still_s=0.0)
    assert np.allclose(clean.position_m, drift.position_m)
    assert not np.allclose(clean.position_m, kept.position_m, atol=1e-3)


def test_as_printed_velocity_runs_on_through_rests_and_drift_grows_with_it():
    """The constant that drift adds to a gap's acceleration stays in the velocity: its way grows with the rest."""
    walk = cubic_steps("drift")
    kept, printed = (path_of(walk, still_s=0.0, zero_velocity=zero) for zero in (True, False))
    assert np.array_equal(kept.still, printed.still)
    assert np.abs(kept.velocity_m_s[kept.still]).max() == 0.0
    assert np.abs(printed.velocity_m_s[-1]).max() > 0.01
    assert np.allclose(kept.position_m[-4:], kept.position_m[-1], atol=1e-12)
    steps = np.diff(printed.position_m[-4:], axis=0)
    assert np.allclose(steps, steps[0], atol=1e-3)
    assert np.abs(steps[0]).max() > 2e-3


def test_as_printed_bias_is_that_of_the_first_second_even_if_the_foot_moves():
    walk = cubic_steps("drift")
    rates = walk.angular_velocity_rad_s.copy()
    rates[25:50, 1] += 3.0  # within the first second
    found = {
        source: follow_key_points(
            walk.specific_force_mps2, rates, RATE_HZ, KeyPointSettings(bias_from=source)
        ).position_m
        for source in ("rest", "start")
    }
    assert np.abs(found["rest"] - found["start"]).max() > 0.1
    still = as_printed()
    assert (still.bias_from, still.zero_velocity, still.weights) == ("start", False, NOISY_WEIGHTS)
    assert np.allclose(path_of(walk, bias_from="start").position_m, path_of(walk).position_m)


def test_another_measure_of_stability_chooses_the_key_points():
    walk = cubic_steps()
    found = follow_key_points(
        walk.specific_force_mps2,
        walk.angular_velocity_rad_s,
        RATE_HZ,
        KeyPointSettings(),
        measure=lambda force, rates, weights: np.where(np.arange(len(force)) == 3, 0.0, 2.0),
    )
    assert np.flatnonzero(found.still).tolist() == [3]


def test_sample_by_sample_beats_windows_on_the_clean_walk():
    walk = cubic_steps()
    found = path_of(walk, by_sample=True, low_pass_hz=None)
    assert len(found.time_s) == 250
    assert np.abs(found.position_m[:, 0] - walk.position_m[:, 0]).max() < 0.02


def test_a_walking_foot_at_another_rate_is_followed_roughly():
    walk = foot_walk((1.2,), rate_hz=200.0, mounting_rad=(0.0, 0.0, 0.0))
    one = walk.readings
    settings = KeyPointSettings(by_sample=True, window=5)
    found = follow_key_points(one.specific_force_mps2, one.angular_velocity_rad_s, 200.0, settings)
    assert found.time_s[1] - found.time_s[0] == pytest.approx(0.02)
    assert np.linalg.norm(found.position_m[-1, :2]) == pytest.approx(1.2, abs=0.25)


def test_windows_begin_where_they_are_told():
    found = path_of(cubic_steps(), first=7)
    assert found.time_s[0] == pytest.approx((7 + 4.5) / RATE_HZ)
    assert len(found.time_s) == 24


def test_without_a_stable_window_there_is_no_answer():
    walk = cubic_steps("drift")
    with pytest.raises(InvalidInput, match="no window is stable"):
        path_of(walk, threshold=0.01)
    with pytest.raises(InvalidInput, match="less than two windows"):
        path_of(walk, first=245)


@pytest.mark.parametrize(
    "bad",
    [
        {"window": 1},
        {"first": -1},
        {"threshold": 0.0},
        {"loss": 1.0},
        {"low_pass_hz": 30.0},
        {"middle": 1.0},
    ],
)
def test_bad_settings_are_refused(bad):
    with pytest.raises(InvalidInput):
        KeyPointSettings(**bad)


def test_an_unknown_source_of_the_bias_is_refused():
    with pytest.raises(UnknownName, match="known are rest, start"):
        KeyPointSettings(bias_from="end")


def test_readings_too_slow_for_the_low_pass_are_refused():
    with pytest.raises(InvalidInput, match="more than 30 Hz"):
        follow_key_points(np.ones((100, 3)), np.zeros((100, 3)), 25.0, KeyPointSettings())
