"""The rules of contact: each holds up to its limit and not beyond, for numbers and for arrays."""

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.sensors.contact.rules import (
    BOTH,
    FALL_M_S2,
    KEEP_M,
    LEAVE_SLACK,
    LEFT,
    LEVEL_M,
    LOWER_M,
    NEITHER,
    PARTED_M_S,
    REACH_M,
    RIGHT,
    Touch,
    falls,
    least_load,
    lower_feet,
    nearer_foot,
    stand_together,
)

LIMITS = Touch(0.04, 0.8)


def test_a_plate_is_loaded_from_its_threshold_on_and_never_by_a_pull():
    assert least_load(20.0) == 20.0
    assert 0.0 < least_load(0.0) < 1e-300
    assert 0.0 < least_load(-5.0) < 1e-300


@pytest.mark.parametrize(
    ("away", "before", "foot"),
    [
        ((0.05, 0.10), NEITHER, RIGHT),
        ((0.10, 0.05), NEITHER, LEFT),
        ((0.05, 0.05), NEITHER, RIGHT),
        ((0.05, 0.05 + 0.9 * KEEP_M), LEFT, LEFT),
        ((0.05, 0.05 + 1.1 * KEEP_M), LEFT, RIGHT),
        ((1.1 * REACH_M, 2 * REACH_M), NEITHER, NEITHER),
        ((0.9 * REACH_M, 1.01 * REACH_M), LEFT, NEITHER),
        ((0.05, 0.10), BOTH, RIGHT),
    ],
)
def test_a_pressure_belongs_to_the_nearer_sole_within_reach(away, before, foot):
    assert nearer_foot(away, before) == foot


@pytest.mark.parametrize("slack", [1.0, LEAVE_SLACK])
@pytest.mark.parametrize(
    ("rise", "speed"), [(0.99, 0.99), (-0.99, 0.99), (1.01, 0.0), (-1.01, 0.0), (0.0, 1.01)]
)
def test_feet_stand_together_while_level_and_slow(rise, speed, slack):
    """Feet that stood together may move faster against each other, but not stand on more unequal levels."""
    together = stand_together(rise * LEVEL_M, speed * slack * PARTED_M_S, slack)
    assert together == (max(abs(rise), speed) < 1.0)


@pytest.mark.parametrize("floor_m", [-0.3, 0.0, 1.2])
def test_a_point_touches_while_low_and_slow(floor_m):
    height, speed = LIMITS
    heights = floor_m + height * np.array([-9.0, 0.99, 1.01, 0.99])
    speeds = speed * np.array([0.5, 0.99, 0.5, 1.01])
    np.testing.assert_array_equal(LIMITS.holds(heights, floor_m, speeds), [True, True, False, False])
    assert [LIMITS.holds(*one) for one in zip(heights, [floor_m] * 4, speeds, strict=True)] == [1, 1, 0, 0]


def test_a_floor_of_unknown_height_is_not_touched():
    assert not LIMITS.holds(-1.0, np.nan, 0.0)


def test_a_foot_that_stood_has_wider_limits():
    assert LIMITS.relaxed() == (LEAVE_SLACK * 0.04, LEAVE_SLACK * 0.8)
    assert LEAVE_SLACK > 1.0


def test_nearness_is_a_gaussian_of_the_limits():
    height, speed = LIMITS
    assert LIMITS.nearness(1.0, 1.0, 0.0) == LIMITS.nearness(0.5, 1.0, 0.0) == 1.0
    assert LIMITS.nearness(1.0 + height, 1.0, 0.0) == pytest.approx(np.exp(-0.5))
    assert LIMITS.nearness(1.0, 1.0, 2.0 * speed) == pytest.approx(np.exp(-2.0))
    assert LIMITS.nearness(1.0 + height, 1.0, speed) == pytest.approx(np.exp(-1.0))


def test_a_body_falls_between_support_and_free_flight():
    assert -GRAVITY_M_S2 < FALL_M_S2 < 0.0
    accelerations = [-GRAVITY_M_S2, 1.01 * FALL_M_S2, 0.99 * FALL_M_S2, 0.0, GRAVITY_M_S2, np.nan]
    expected = [True, True, False, False, False, False]
    np.testing.assert_array_equal(falls(np.array(accelerations)), expected)
    assert [bool(falls(one)) for one in accelerations] == expected


def test_the_lower_foot_carries_and_both_where_they_are_level():
    assert lower_feet([0.1, 0.1 + 0.99 * LOWER_M]) == [RIGHT, LEFT]
    assert lower_feet([0.1, 0.1 + 1.01 * LOWER_M]) == [RIGHT]
    assert lower_feet([0.1 + 1.01 * LOWER_M, 0.1]) == [LEFT]
