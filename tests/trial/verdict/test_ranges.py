"""Joints beyond their ranges: which, by how much, and not for an instant only."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.trial.verdict.ranges import MOST_FRAMES, joints_beyond

RATE_HZ = 100.0
MODEL = HumanModel.scaled()


def bent(degrees, frames=slice(None), count=100, dof="left_shank_y"):
    """Configurations with one joint bent about an axis in some frames."""
    joint, axis = dof.rsplit("_", 1)
    turn = np.zeros(MODEL.nv)
    turn[MODEL.joints[joint].v.start + "xyz".index(axis)] = np.deg2rad(degrees)
    q = np.tile(MODEL.neutral(), (count, 1))
    q[frames] = MODEL.integrate(MODEL.neutral(), turn)
    return q


def found_in(q, tracked=None):
    known = np.ones(len(q), bool) if tracked is None else tracked
    return joints_beyond(MODEL, q, known, RATE_HZ)


def test_joints_within_their_ranges_are_not_listed():
    assert found_in(bent(60.0)) == ()
    assert found_in(np.zeros((0, MODEL.nq))) == ()


def test_a_knee_bent_the_wrong_way_is_beyond_its_range():
    (knee,) = found_in(bent(-67.0))
    assert (knee.part, knee.joint) == ("left_leg", "left_shank")
    assert knee.excess_deg == pytest.approx(57.0, abs=0.1), "its range ends at -10°"
    assert knee.seconds == pytest.approx(1.0)


@pytest.mark.parametrize(("frames", "listed"), [(9, False), (11, True)])
def test_an_instant_does_not_count(frames, listed):
    assert bool(found_in(bent(-67.0, slice(40, 40 + frames)))) is listed


def test_frames_in_which_the_body_is_not_followed_do_not_count():
    tracked = np.ones(100, bool)
    tracked[40:60] = False
    assert found_in(bent(-67.0, slice(40, 60)), tracked) == ()


def test_long_trials_are_sampled():
    (knee,) = found_in(bent(-30.0, slice(0, 200), 3 * MOST_FRAMES))
    assert knee.seconds == pytest.approx(2.0, abs=0.05)
