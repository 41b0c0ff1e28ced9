"""Implausible estimates are recognised by their numbers, and never given as smoothed ones."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.plausibility import DOUBT, MOST_RAD_S, moved_away, plausible, smoothed_or_filtered
from mbkf.filters.tracking import track
from mbkf.sensors.contact.possible import MOST_WEIGHTS
from mbkf.trial.preparation.filters import FILTERS
from tests.followed import estimates, made_filter, recording, replayed

every_filter = pytest.mark.parametrize("name", FILTERS)
WINDOWS = SmoothingSettings(window_s=0.2, ahead_s=0.1, frames=0)


def one(name="dynamic"):
    """An estimate in the middle of a squat, and the body."""
    return estimates(name)[1][20], made_filter(name).model


@every_filter
def test_a_squat_is_plausible(name):
    _, model = one(name)
    assert all(plausible(estimate, model) for estimate in estimates(name)[1])


@pytest.mark.usefixtures("either_kernel")
@pytest.mark.parametrize("field", ["q", "v", "a"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_implausible(field, value):
    estimate, model = one()
    wrong = getattr(estimate, field).copy()
    wrong[7] = value
    assert not plausible(estimate._replace(**{field: wrong}), model)


@pytest.mark.usefixtures("either_kernel")
def test_no_joint_is_too_fast_and_no_force_too_large():
    estimate, model = one()
    for share, possible in ((0.99, True), (1.01, False)):
        v, wrench = np.zeros_like(estimate.v), np.zeros((2, 6))
        v[9] = -share * MOST_RAD_S
        assert plausible(estimate._replace(v=v), model) is possible
        wrench[1, 2] = share * DOUBT * MOST_WEIGHTS * 9.80665 * model.mass_kg
        assert plausible(estimate._replace(wrench=wrench), model) is possible
    assert plausible(estimate._replace(wrench=np.full((2, 6), np.nan)), model)


def test_a_body_is_elsewhere_when_most_joints_are_though_markers_showed_it():
    estimate, model = one()
    away, arm = estimate.q.copy(), estimate.q.copy()
    away[1] += 0.11
    arm[model.joint("left_upper_arm").q] = [1.0, 0.0, 0.0, 0.0]

    def astray(q, **known):
        """In the second of three frames."""
        own, later = estimate._replace(**known), estimate._replace(q=q)
        return moved_away([estimate, own, estimate], [estimate, later, estimate], model)

    assert astray(away)
    assert not astray(arm)
    for known in ({"tracked": False}, {"placed": False}, {"started": True}):
        assert not astray(away, **known)
        assert not moved_away([estimate._replace(**known)], [estimate._replace(q=away)], model)
    away[1] -= 0.02
    assert not astray(away)


def test_all_of_a_window_is_the_filter_s_own_where_one_frame_is_implausible():
    estimate, model = one()
    own = [estimate] * 4
    fast = estimate._replace(v=estimate.v + 1e9)
    assert smoothed_or_filtered(own, lambda: own, model) == own
    for found in ([estimate, fast, estimate, estimate], [fast] * 4):
        kept = smoothed_or_filtered(own, lambda found=found: found, model)
        assert [each.uncorrected for each in kept] == [True] * 4
        assert all(np.array_equal(each.v, estimate.v) for each in kept)


def test_a_failed_smoother_leaves_the_filtered_estimate():
    estimate, model = one()

    def singular():
        raise np.linalg.LinAlgError("singular")

    (kept,) = smoothed_or_filtered([estimate], singular, model)
    assert kept.uncorrected


@every_filter
@pytest.mark.parametrize("lag_s", [0.0, 0.05])
def test_implausible_smoothing_leaves_the_filtered_estimates_and_is_marked(name, lag_s, monkeypatch):
    """The smoother overflows in the frames from 0.2 s on; those before are smoothed as they were."""
    filter, plain = replayed(name), track(replayed(name), recording())
    asked = {"lag_s": lag_s} if lag_s else {"smoothing": WINDOWS}
    right = track(replayed(name), recording(), **asked)
    smooth, corrected, count = filter.smooth, filter.corrected, iter(range(1000))

    def wrong(estimate):
        return estimate._replace(q=estimate.q * np.float64(1e200) ** 2)

    def smoothed(run, wanted):
        found = smooth(run, wanted)
        return found if run[0].started else [wrong(each) for each in found]

    def lagged(estimate, later, before):
        found = corrected(estimate, later, before)
        return wrong(found) if next(count) >= 20 else found

    monkeypatch.setattr(filter, "smooth", smoothed)
    monkeypatch.setattr(filter, "corrected", lagged)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = track(filter, recording(), **asked)
    begin = 20
    assert np.flatnonzero(found.uncorrected).tolist() == list(range(begin, len(recording())))
    np.testing.assert_array_equal(found.q[begin:], plain.q[begin:])
    np.testing.assert_array_equal(found.sd_q[begin:], plain.sd_q[begin:])
    np.testing.assert_array_equal(found.q[: begin - 1], right.q[: begin - 1])
    assert found.smoothed == right.smoothed


def test_a_trial_without_a_plausible_window_is_not_smoothed(monkeypatch):
    filter = replayed("kinematic")
    monkeypatch.setattr(filter, "smooth", lambda run, *_: [e._replace(v=e.v + 1e9) for e in run])
    found = track(filter, recording(), smoothing=replace(WINDOWS, window_s=10.0))
    assert found.uncorrected.all() and not found.smoothed


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_windows_go_on_after_an_implausible_one(name, monkeypatch):
    """From the filter's own estimate, not from the smoother's."""
    filter, anew = made_filter(name), []
    smooth = filter.smooth

    def thrown(run, wanted):
        found = smooth(run, wanted)
        if run[0].started:
            return [each._replace(v=each.v + 1e9) for each in found]
        anew.append(anew or made_filter(name).smooth(run, wanted))
        return found

    monkeypatch.setattr(filter, "smooth", thrown)
    smoother, given = FixedLagSmoother(filter, WINDOWS), []
    for t, estimate in enumerate(estimates(name)[1]):
        given += smoother.push(t, estimate)
    given += smoother.finish()
    assert [t for t, _ in given] == list(range(len(recording())))
    assert [each.uncorrected for _, each in given] == [True] * 20 + [False] * (len(recording()) - 20)
    np.testing.assert_array_equal([each.q for _, each in given[20:40]], [each.q for each in anew[0][1:]])
