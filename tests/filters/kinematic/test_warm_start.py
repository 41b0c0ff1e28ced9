"""The warm start: velocities and accelerations from a backward run, wherever in the trial it begins."""

import numpy as np
import pytest

from mbkf.filters.kinematic.warm_start import SETTLING_S, WARM_UP_S, WarmStart
from tests.dynamics import DT
from tests.followed import FRAMES, made, made_filter, recording, without
from tests.motions import worst

SETTLED = round(SETTLING_S / DT)


def test_a_warm_start_knows_velocities_and_a_few_accelerations():
    kalman = made_filter("kinematic").kalman
    found = WarmStart(kalman)(recording(), 0, None)
    cold = kalman.start(recording().markers_m[0])
    truth, nv = made().motion.v[FRAMES.start], made().model.nv
    assert found.accelerations.shape == (SETTLED, nv)
    np.testing.assert_array_equal(cold.v, 0.0)
    assert truth[2] < -0.6
    assert abs(found.state.v[2] - truth[2]) < 0.1
    assert worst((found.state.v - truth) / np.sqrt(np.diag(found.state.P)[nv:])) < 4.0
    assert (np.diag(found.state.P)[nv:] < np.diag(cold.P)[nv:]).all()


@pytest.mark.parametrize("left", [1, 2, round(WARM_UP_S / DT) - 1])
def test_a_warm_start_near_the_end_makes_do_with_what_is_left(left):
    tracking, t = made_filter("kinematic"), len(FRAMES) - left
    found = tracking.start(recording(), t, None)
    assert found.started
    assert np.isfinite(np.r_[found.q, found.v, found.a]).all()
    if left == 1:
        np.testing.assert_array_equal(found.v, 0.0)
        np.testing.assert_array_equal(found.a, 0.0)


def test_a_warm_start_without_markers_ahead_starts_at_rest():
    last = round(WARM_UP_S / DT)
    found = made_filter("kinematic").start(without(recording(), slice(last, None)), 0, None)
    np.testing.assert_array_equal(found.v, 0.0)
