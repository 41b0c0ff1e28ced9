"""Joints beyond their ranges: which, by how much, and not for an instant only."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.trial.verdict.ranges import SAMPLED_HZ, RangeSums

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


def found_in(q, rate_hz=RATE_HZ, block=None):
    sums = RangeSums(MODEL, rate_hz)
    for first in range(0, len(q), block or max(len(q), 1)):
        sums.add(q[first : first + (block or len(q))])
    return sums.joints()


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


def test_frames_without_a_posture_do_not_count():
    q = bent(-67.0, slice(40, 60))
    q[40:60] = np.nan
    assert found_in(q) == ()


def test_trials_of_a_high_rate_are_sampled():
    q, rate_hz = bent(-30.0, slice(0, 200), 1200), 4.0 * SAMPLED_HZ
    (knee,) = found_in(q, rate_hz)
    assert knee.seconds == pytest.approx(0.5)
    assert found_in(bent(-30.0, slice(0, 36), 1200), rate_hz) == ()


@pytest.mark.parametrize("rate_hz", [RATE_HZ, 3.0 * RATE_HZ])
def test_blocks_of_frames_give_what_the_whole_trial_gives(rate_hz):
    q = np.array([bent(-10.0 - 0.3 * k, count=1)[0] for k in range(97)])
    q[50] = np.nan
    whole = found_in(q, rate_hz)
    assert found_in(q, rate_hz, block=7) == whole and whole[0].joint == "left_shank"
