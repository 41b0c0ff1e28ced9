"""When a foot stands still."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.inertial.foot_walks import foot_walk
from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput
from mbkf.imu.zero_velocity import StillnessSettings, stance_statistic, still_samples
from mbkf.numerics.runs import runs
from tests.motions import assert_near

SETTINGS = StillnessSettings()


def readings_of(walk):
    one = walk.readings
    return one.specific_force_mps2, one.angular_velocity_rad_s, one.rate_hz


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 204.8])
def test_the_rests_of_a_walk_are_found_at_any_rate(rate_hz):
    walk = foot_walk(rate_hz=rate_hz, force_noise_m_s2=0.05, rate_noise_rad_s=0.01)
    found = still_samples(*readings_of(walk), SETTINGS)
    assert len(runs(found)) == len(runs(walk.still)) == 4
    assert (found == walk.still).mean() > 0.9


def test_rest_is_found_in_any_direction_of_the_sensor():
    walk, other = (foot_walk(mounting_rad=turn) for turn in ((0.3, -0.2, 0.1), (2.0, 1.0, -1.5)))
    assert np.allclose(
        stance_statistic(*readings_of(walk), SETTINGS), stance_statistic(*readings_of(other), SETTINGS)
    )


def test_the_statistic_of_white_noise_is_its_variance_over_the_assumed_one():
    rng = np.random.default_rng(1)
    f = [0.0, 0.0, GRAVITY_M_S2] + 0.3 * rng.normal(size=(4000, 3))
    w = 0.2 * rng.normal(size=(4000, 3))
    settings = StillnessSettings(acceleration_m_s2=0.3, angular_rate_rad_s=0.2)
    assert stance_statistic(f, w, 100.0, settings).mean() == pytest.approx(6.0, rel=0.1)


def test_short_rests_are_none_and_short_movements_are_bridged():
    f, w = np.tile([0.0, 0.0, GRAVITY_M_S2], (300, 1)), np.zeros((300, 3))
    w[50:58] = 3.0  # bridged
    w[120:200] = 3.0
    w[250:] = 3.0
    settings = StillnessSettings(window_s=0.02, bridge_s=0.15, shortest_s=0.1)
    assert runs(still_samples(f, w, 100.0, settings)) == [(0, 119), (201, 249)]
    longer = StillnessSettings(window_s=0.02, bridge_s=0.15, shortest_s=0.6)
    assert runs(still_samples(f, w, 100.0, longer)) == [(0, 119)]


@pytest.mark.parametrize(("samples", "rests"), [(8, 1), (9, 2)])
def test_a_movement_is_bridged_up_to_its_longest_duration(samples, rests):
    """The mean over three samples sees a movement one sample before it begins and after it ends."""
    f, w = np.tile([0.0, 0.0, GRAVITY_M_S2], (300, 1)), np.zeros((300, 3))
    w[100 : 100 + samples] = 3.0
    settings = StillnessSettings(window_s=0.03, bridge_s=0.1, shortest_s=0.1)
    assert len(runs(still_samples(f, w, 100.0, settings))) == rests


@pytest.mark.parametrize(("samples", "rests"), [(12, 1), (11, 0)])
def test_a_rest_lasts_its_shortest_duration_or_longer(samples, rests):
    f, w = np.tile([0.0, 0.0, GRAVITY_M_S2], (300, 1)), np.full((300, 3), 3.0)
    w[100 : 100 + samples] = 0.0
    settings = StillnessSettings(window_s=0.03, bridge_s=0.1, shortest_s=0.1)
    assert len(runs(still_samples(f, w, 100.0, settings))) == rests


@pytest.mark.parametrize(("window_s", "samples"), [(0.1, 11), (0.11, 11), (0.2, 21), (0.01, 3)])
def test_a_shock_is_seen_half_a_window_before_and_after(window_s, samples):
    """The window has an odd number of samples, and three at least."""
    f, w = np.tile([0.0, 0.0, GRAVITY_M_S2], (100, 1)), np.zeros((100, 3))
    w[50] = 1.0
    found = stance_statistic(f, w, 100.0, StillnessSettings(window_s=window_s, angular_rate_rad_s=0.5))
    assert_near(found, np.where(abs(np.arange(100) - 50) <= samples // 2, 12.0 / samples, 0.0), 1e-9)


@given(st.lists(st.booleans(), max_size=40))
def test_phases_are_the_runs_of_a_mask(bits):
    mask = np.array(bits, dtype=bool)
    again = np.zeros_like(mask)
    for start, stop in runs(mask):
        assert start < stop
        assert start == 0 or not mask[start - 1]
        assert stop == len(mask) or not mask[stop]
        again[start:stop] = True
    assert np.array_equal(again, mask)


@pytest.mark.parametrize("bad", [{"window_s": 0.0}, {"threshold": -1.0}, {"bridge_s": np.nan}])
def test_bad_settings_are_refused(bad):
    with pytest.raises(InvalidInput, match=next(iter(bad))):
        StillnessSettings(**bad)


def test_a_foot_that_never_rests_may_stand_where_it_is_stillest():
    from benchmarks.inertial.stride_feet import simulated_foot
    from mbkf.imu.zero_velocity import rolling_samples

    foot = simulated_foot("running", 0, strides=8)
    one = foot.readings
    f, w, settings = one.specific_force_mps2, one.angular_velocity_rad_s, StillnessSettings()
    still = still_samples(f, w, one.rate_hz, settings)
    rolling = rolling_samples(f, w, one.rate_hz, still, settings)
    assert not (rolling & still).any()
    speed = np.linalg.norm(np.gradient(foot.position_m, 1.0 / one.rate_hz, axis=0), axis=1)
    stances = runs(still | rolling)
    assert sum(speed[a:b].min() < 0.3 for a, b in stances) >= 8
    assert not rolling_samples(f, w, one.rate_hz, np.ones_like(still), settings).any()
