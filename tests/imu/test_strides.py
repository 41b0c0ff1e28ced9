"""Strides between rests."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.inertial.foot_walks import REST_S, SWING_S, foot_walk
from mbkf.errors import InvalidInput
from mbkf.imu.strides import find_strides


def strides_of(walk, **options):
    return find_strides(walk.readings.time_s, walk.position_m, walk.still, **options)


def test_strides_are_the_ways_between_rests():
    walk = foot_walk((1.2, 0.8, 1.1), heading_rad=0.7)
    found = strides_of(walk)
    assert [s.length_m for s in found] == pytest.approx([1.2, 0.8, 1.1])
    assert [s.rise_m for s in found] == pytest.approx([0.0] * 3)
    assert [s.lift_m for s in found] == pytest.approx([0.12] * 3, abs=1e-4)
    assert all(np.isnan(s.length_sd_m) and np.isnan(s.turn_rad) for s in found)


def test_pauses_do_not_make_strides_slow():
    """The first and the last stride touch rests of 1.5 s and take as much of them as of the short ones."""
    found = strides_of(foot_walk())
    assert [s.duration_s for s in found] == pytest.approx([REST_S + SWING_S] * 3, abs=0.03)
    assert [s.swing_s for s in found] == pytest.approx([SWING_S] * 3, abs=0.025)
    assert found[0].speed_m_s == pytest.approx(1.2 / (REST_S + SWING_S), rel=0.03)


def test_strides_follow_each_other():
    found = strides_of(foot_walk())
    assert [s.last for s in found[:-1]] == [s.first for s in found[1:]]
    assert all(s.start_s < s.end_s for s in found)


def test_shuffling_is_left_out():
    walk = foot_walk((1.2, 0.1, 1.1))
    assert [s.length_m for s in strides_of(walk)] == pytest.approx([1.2, 1.1])
    assert len(strides_of(walk, shortest_m=0.0)) == 3


def test_deviation_is_that_along_the_stride():
    walk = foot_walk((1.2, 1.0), heading_rad=np.pi / 2)
    covariances = np.tile(np.diag([9.0, 4.0, 1.0]), (2, 1, 1))
    found = strides_of(walk, displacement_covariances_m2=covariances)
    assert [s.length_sd_m for s in found] == pytest.approx([2.0, 2.0])


def test_turns_are_about_the_vertical_and_positive_to_the_left():
    walk = foot_walk((1.0,))
    heading = np.where(walk.readings.time_s > 2.0, 0.5, 0.0)
    turned = Rotation.from_rotvec(heading[:, None] * [0, 0, 1]) * walk.orientation
    (one,) = strides_of(walk, orientation=turned.as_quat())
    assert one.turn_rad == pytest.approx(0.5)


def test_a_foot_that_stands_makes_no_stride():
    walk = foot_walk(())
    assert strides_of(walk) == ()


def test_a_negative_bound_is_refused():
    with pytest.raises(InvalidInput, match="shortest"):
        strides_of(foot_walk((1.0,)), shortest_m=-0.1)
