"""The kinematic filter on trials: its accelerations, and its smoother against a dense one."""

import numpy as np
import pytest

from mbkf.filters.kinematic.warm_start import SETTLING_S, WarmStart
from tests.dynamics import DT
from tests.followed import FRAMES, WHOLE, estimates, made, made_filter, recording, tracked
from tests.motions import worst

SETTLED = round(SETTLING_S / DT)


def test_accelerations_are_differences_once_it_has_settled():
    found = tracked("kinematic")
    expected = np.diff(found.v, axis=0) / DT
    np.testing.assert_allclose(found.a[SETTLED:], expected[SETTLED - 1 :], rtol=1e-12, atol=1e-10)


def test_while_it_settles_they_are_those_of_the_backward_run():
    ahead = WarmStart(made_filter("kinematic").kalman)(recording(), 0, None).accelerations
    np.testing.assert_array_equal(tracked("kinematic").a[:SETTLED], ahead)


def test_smoothed_accelerations_are_central_differences():
    found = tracked("kinematic", WHOLE)
    np.testing.assert_allclose(found.a[1:-1], (found.v[2:] - found.v[:-2]) / (2 * DT), rtol=1e-12, atol=1e-10)
    truth = made().motion.a[FRAMES.start : FRAMES.stop]
    gone = np.linalg.norm(found.a - truth) / np.linalg.norm(tracked("kinematic").a - truth)
    assert gone < 0.5


def dense_smoother(plant, found):
    """Corrections (T, 2 nv) and covariances by Rauch, Tung and Striebel, from the filter's own transitions."""
    step, P = np.zeros_like(found[-1].record.state.P[0]), found[-1].record.state.P
    steps, covariances = [step], [P]
    for k in range(len(found) - 2, -1, -1):
        done, here = found[k + 1].record.step, found[k].record.state
        prior = done.prior.state.P
        gain = np.linalg.solve(prior, plant.transition(here) @ here.P).T
        correction = found[k + 1].record.state.P @ done.readings.whole_vector
        step = gain @ (correction + step)
        P = here.P + gain @ (P - prior) @ gain.T
        steps.append(step)
        covariances.append(P)
    return np.array(steps[::-1]), np.array(covariances[::-1])


def test_the_smoother_is_the_dense_one():
    tracking, found = estimates("kinematic")
    found = found[:12]
    smoothed = tracking.smooth(found, len(found))
    steps, covariances = dense_smoother(tracking.kalman.plant, found)
    model, nv = made().model, made().model.nv
    for one, before, step, P in zip(smoothed, found, steps, covariances, strict=True):
        sd = np.sqrt(np.diag(P))
        moved = np.r_[model.difference(before.q, one.q), one.v - before.v]
        assert worst((moved - step) / sd) < 1e-6
        assert worst((tracking.covariance(one) - P) / np.outer(sd, sd)) < 1e-6
    assert worst(steps[0][nv:]) > 0.01


def test_torques_keep_the_filters_spread():
    """But for the mass matrix, which is that of the smoothed pose."""
    share = tracked("kinematic", WHOLE).torque_sd[1:] / tracked("kinematic").torque_sd[1:]
    assert np.median(share) == pytest.approx(1.0, abs=0.01)
    assert (np.abs(share - 1.0) < 0.25).all()
