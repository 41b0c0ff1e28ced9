"""The floor's velocity: that of a belt under a person who stays in place, zero for walkers, skaters, standing feet."""

import numpy as np
import pytest

from mbkf.sensors.contact.floor import NO_MOVEMENT
from mbkf.sensors.contact.rules import BELT_WINDOW_S

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
    assert len(found.low_m_s[0].latest) == round(BELT_WINDOW_S / DT)
    assert found.floor_m_s(DT) == (0.0, 0.0)


@pytest.mark.parametrize(("rise_m_s2", "held"), [(-9.81, False), (-6.0, False), (-2.0, True), (0.0, True)])
def test_a_body_in_the_air_whose_height_does_not_curve_down_is_held_up(rise_m_s2, held):
    found = NO_MOVEMENT
    for t in np.arange(0.0, 0.2, DT):
        found = found.with_frame((np.nan, np.nan), (0.0, 0.0, 1.0 + 0.5 * rise_m_s2 * t**2), DT)
        assert not found.held_up(DT)
    assert found._replace(airborne=20).held_up(DT) == held
