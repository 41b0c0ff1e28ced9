"""The floor's velocity: that of a belt under a person who stays in place, zero for walkers, skaters, standing feet."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.sensors.contact.floor import NO_MOVEMENT
from mbkf.sensors.contact.thresholds import BELT_FROM_M_S, BELT_WINDOW_S, STILL_FLOOR_S

DT = 0.01


def moved(low_m_s, pelvis_m_s, seconds=1.5):
    """Movement after some time: the lowest sole point by time, and a pelvis of constant velocity."""
    found = NO_MOVEMENT
    for t in np.arange(0.0, seconds, DT):
        x, y = low_m_s(t)
        found = found.with_frame((x, y), (pelvis_m_s * t, 0.0, 1.0), DT)
    return found


def stride(t, floor_m_s, swing_m_s):
    """The lowest sole: for 0.3 of 0.4 s one that stands, else one that swings low."""
    return (floor_m_s if t % 0.4 < 0.3 else swing_m_s, 0.0)


@pytest.mark.parametrize("belt", [0.8, 1.5, 4.0])
def test_a_belt_moves_under_a_person_who_stays_in_place(belt):
    found = moved(lambda t: stride(t, -belt, belt), 0.0).floor_m_s(DT)
    np.testing.assert_allclose(found, (-belt, 0.0), atol=1e-9)


def test_the_floor_of_a_walk_stands_still():
    assert moved(lambda t: stride(t, 0.05, 3.0), 1.3).floor_m_s(DT) == (0.0, 0.0)


def test_who_glides_takes_the_feet_along():
    assert moved(lambda t: (2.0, 0.0), 2.0).floor_m_s(DT) == (0.0, 0.0)


def test_it_takes_evidence():
    assert moved(lambda t: (-4.0, 0.0), 0.0, seconds=0.05).floor_m_s(DT) == (0.0, 0.0)
    assert moved(lambda t: (np.nan, np.nan), 0.0).floor_m_s(DT) == (0.0, 0.0)
    assert NO_MOVEMENT.with_frame((np.nan, np.nan), (0.0, 0.0, 0.0), DT).floor_m_s(DT) == (0.0, 0.0)


def test_what_is_long_ago_is_forgotten():
    found = moved(lambda t: (-4.0 if t < 1.5 else 0.0, 0.0), 0.0, seconds=1.5 + BELT_WINDOW_S + 0.1)
    assert len(found.frames) == round(BELT_WINDOW_S / DT)
    assert found.floor_m_s(DT) == (0.0, 0.0)


@pytest.mark.parametrize(("rise_m_s2", "held"), [(-9.81, False), (-6.0, False), (-2.0, True), (0.0, True)])
def test_a_body_in_the_air_whose_height_does_not_curve_down_is_held_up(rise_m_s2, held):
    found = NO_MOVEMENT
    for t in np.arange(0.0, 0.2, DT):
        found = found.with_frame((np.nan, np.nan), (0.0, 0.0, 1.0 + 0.5 * rise_m_s2 * t**2), DT)
        assert not found.held_up(DT)
    assert found._replace(airborne=20).held_up(DT) == held


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.0, 3.0), st.integers(1, 220))
def test_the_floor_s_velocity_is_the_median_of_the_last_second_and_a_tenth_of_standing(seed, belt, frames):
    rng, found, low = np.random.default_rng(seed), NO_MOVEMENT, []
    for _ in range(frames):
        velocity = rng.normal([belt * rng.choice([-1.0, 1.0, 1.0]), 0.0], 0.3)
        low.append(velocity if rng.random() < 0.8 else np.full(2, np.nan))
        found = found.with_frame(tuple(low[-1]), (0.0, 0.0, 1.0), DT)
    window = np.array(low[-round(BELT_WINDOW_S / DT) :])
    assert found.slow == np.count_nonzero((np.abs(window) < BELT_FROM_M_S / np.sqrt(2.0)).all(axis=1))
    still = np.zeros((round(STILL_FLOOR_S / DT), 2))
    median = np.median(np.vstack([window[~np.isnan(window[:, 0])], still]), axis=0)
    expected = median if np.hypot(*median) >= BELT_FROM_M_S else np.zeros(2)
    np.testing.assert_allclose(found.floor_m_s(DT), expected, atol=1e-15)
