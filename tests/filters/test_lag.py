"""Fixed lag: which frames come back and when, and what they know."""

import numpy as np
import pytest

from mbkf.filters.dynamic.smoother import smooth
from mbkf.filters.lag import FixedLag, lag_frames
from mbkf.filters.tracking import track
from mbkf.numerics.later_frames import LinearStep
from mbkf.trial.preparation.filters import FILTERS
from tests.dynamics import DT
from tests.filters.test_fixed_lag import Told
from tests.followed import (
    FRAMES,
    SETTLED,
    WHOLE,
    errors,
    estimates,
    made_filter,
    recording,
    replayed,
    tracked,
    without,
)
from tests.motions import angle_errors, reference_model

LAG_S = 0.06

every_filter = pytest.mark.parametrize("name", FILTERS)


class Counter:
    """A filter whose estimates are frames and whose corrections remember how many frames told of them."""

    dt_s, model = DT, reference_model()

    def __init__(self):
        self.befores = {}

    def linear_step(self, before, estimate):
        assert estimate.t == before.t + 1 and not estimate.started and not estimate.rejoined
        return LinearStep(np.zeros((1, 1)), np.zeros((1, 1)), -np.ones(1), np.eye(1))

    def corrected(self, estimate, later, before):
        self.befores[estimate.t] = None if before is None else before.t
        estimate.heard = 0 if later is None else round(float(later.gradient[0]))
        return estimate


def returned(frames, lag_s, starts=(0,), rejoined=()):
    """The frames that come back, each with the one put in when it did, and the filter."""
    counter = Counter()
    lag, found = FixedLag(counter, lag_s), []
    for t in frames:
        found += [(t, k, e) for k, e in lag.push(t, Told(t, t in starts, t in rejoined))]
    return found + [(frames[-1], k, e) for k, e in lag.finish()], counter


@pytest.mark.parametrize("frames", [range(1), range(6), range(7), range(40), range(5, 30)])
@pytest.mark.parametrize("lag", [1, 2, 6])
def test_every_frame_comes_back_once_in_order_and_as_late_as_the_lag(frames, lag):
    found, counter = returned(frames, lag * DT, starts=(frames[0],))
    last = frames[-1]
    assert [k for _, k, _ in found] == list(frames)
    assert [t for t, _, _ in found] == [min(k + lag, last) for k in frames]
    assert [e.heard for _, _, e in found] == [min(lag, last - k) for k in frames]
    assert counter.befores == {k: None if k == frames[0] else k - 1 for k in frames}


@pytest.mark.parametrize("cut", [{"starts": (0, 17)}, {"rejoined": (17,)}])
def test_a_restart_or_a_contact_that_opens_tells_nothing_of_the_frames_before_it(cut):
    found, counter = returned(range(30), 4 * DT, **cut)
    heard = {k: e.heard for _, k, e in found}
    assert [heard[k] for k in range(11, 19)] == [4, 4, 3, 2, 1, 0, 4, 4]
    assert [t for t, k, _ in found if 13 <= k < 17] == [17] * 4
    assert counter.befores[17] is None


@pytest.mark.parametrize(
    ("lag_s", "dt_s", "frames"),
    [(0.06, 0.01, 6), (0.0, 0.01, 0), (0.009, 0.01, 0), (0.06, 1 / 120, 7), (0.3, 0.1, 3)],
)
def test_a_lag_holds_the_frames_within_it(lag_s, dt_s, frames):
    assert lag_frames(lag_s, dt_s) == frames


@every_filter
def test_no_lag_is_the_filter(name):
    plain = tracked(name)
    found = track(replayed(name), recording(), lag_s=0.0, keep_covariance=True)
    for one in ("q", "v", "a", "wrench", "sd_q", "torque_sd", "covariance"):
        np.testing.assert_array_equal(getattr(found, one), getattr(plain, one))


@pytest.mark.parametrize("name", ["kinematic", "torque"])
def test_a_lag_of_the_whole_run_is_the_linear_smoother(name):
    """These filters smooth by the same linear pass; the first frame then knows all."""
    one, found = estimates(name)
    smoothed = one.smooth(found, len(found))
    lag = FixedLag(one, DT * len(FRAMES))
    assert [lag.push(t, e) for t, e in enumerate(found)] == [[]] * len(found)
    for (_, mine), theirs in zip(lag.finish(), smoothed, strict=True):
        np.testing.assert_allclose(mine.q, theirs.q, atol=1e-9)
        np.testing.assert_allclose(mine.v, theirs.v, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(one.covariance(mine), one.covariance(theirs), rtol=1e-6, atol=1e-12)


def test_a_lag_of_the_whole_run_is_nearly_a_round_of_the_dynamic_smoother():
    """That linearises at the filter's answers, the lag at its predictions: a share of the standard deviations apart."""
    one, found = estimates("dynamic")
    expected = list(smooth(one.kalman, [e.record.step for e in found], 1))
    lag = FixedLag(one, DT * len(FRAMES))
    mine = [e for k, fresh in enumerate(found) for _, e in lag.push(k, fresh)] + [e for _, e in lag.finish()]
    sd = np.array([np.sqrt(np.diag(state.P)[: one.model.nv]) for state in expected])
    apart = angle_errors(one.model, np.array([e.q for e in mine]), np.array([s.q for s in expected])) / sd
    assert np.abs(apart[SETTLED]).max() < 0.4 and np.median(np.abs(apart)) < 0.05


@pytest.mark.slow
@every_filter
def test_errors_shrink_with_the_lag_towards_the_smoothers(name):
    plain, smoothed = errors(tracked(name)), errors(tracked(name, WHOLE))
    short, long = (errors(track(replayed(name), recording(), lag_s=s)) for s in (0.02, LAG_S))
    known = slice(
        2 if name == "kinematic" else 3
    )  # differences of neighbours' velocities, each with its own lag
    assert (short < plain).all() and (long[known] < short[known]).all()
    assert (long[known] < 1.35 * smoothed[known]).all()


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_stated_spreads_shrink_with_the_lag_and_never_below_the_smoothers(name):
    plain, whole = tracked(name), track(replayed(name), recording(), lag_s=1.0)
    some = track(replayed(name), recording(), lag_s=LAG_S)
    inside = slice(5, -10)
    for spread in ("sd_q", "sd_v"):
        causal, mine, all_ = (getattr(one, spread)[inside] for one in (plain, some, whole))
        assert (mine <= causal * (1 + 1e-9)).all() and (all_ <= mine * (1 + 1e-9)).all()
        assert np.median(mine / causal) < 0.99


@every_filter
def test_without_covariances_the_same_is_found_with_the_filters_own(name):
    one, found = estimates(name)
    both = []
    for lag in (FixedLag(one, LAG_S), FixedLag(one, LAG_S, covariances=False)):
        both.append(
            [e for t, fresh in enumerate(found) for _, e in lag.push(t, fresh)] + [e for _, e in lag.finish()]
        )
    for plain, cheap, own in zip(*both, found, strict=True):
        np.testing.assert_array_equal(cheap.q, plain.q)
        np.testing.assert_array_equal(cheap.v, plain.v)
        np.testing.assert_allclose(one.covariance(cheap), one.covariance(own), rtol=1e-9, atol=1e-15)


def test_frames_before_a_restart_know_nothing_of_those_after():
    read = without(recording(range(20, 130)), slice(30, 80))
    found = track(made_filter("dynamic"), read, lag_s=LAG_S)
    plain = track(made_filter("dynamic"), read)
    assert found.starts == plain.starts == (0, 80)
    np.testing.assert_array_equal(found.q[79], plain.q[79])
    assert not np.array_equal(found.q[80], plain.q[80])
    np.testing.assert_array_equal(found.nis, plain.nis)
    assert not found.smoothed
