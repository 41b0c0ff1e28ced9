"""Means of cycles against the formulas of one sample, against balanced analysis of variance, and by their coverage."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from mbkf.study.session.means import Mean, difference_of, mean_of, paired_difference

P = 5


def plain(values, trials):
    nothing = np.zeros_like(values)
    return mean_of(values, trials, nothing, nothing)


def half_width_of(mean):
    """Half of the interval of a mean: that of its difference to an exact nought."""
    nothing = np.zeros_like(mean.mean)
    exact = Mean(nothing, nothing, nothing, nothing + np.inf, nothing, nothing, 1)
    return difference_of(mean, exact, same_body=False).half_width


def test_cycles_of_one_trial_are_one_sample():
    values = np.random.default_rng(0).normal(size=(7, P))
    found = plain(values, ["a"] * 7)
    low, high = stats.t.interval(0.95, 6, values.mean(axis=0), stats.sem(values, axis=0))
    np.testing.assert_allclose(found.mean - half_width_of(found), low, atol=1e-12)
    np.testing.assert_allclose(found.mean + half_width_of(found), high, atol=1e-12)
    np.testing.assert_allclose(found.sd, values.std(axis=0, ddof=1))


def test_trials_that_are_apart_count_by_their_means():
    """Balanced: the variance of the mean is that of the trials' means over their number."""
    rng = np.random.default_rng(1)
    shifts = 50.0 * np.arange(4)[:, None]
    values = (shifts[:, None] + rng.normal(size=(4, 3, P))).reshape(12, P)
    found = plain(values, [name for name in "abcd" for _ in range(3)])
    means = values.reshape(4, 3, P).mean(axis=1)
    np.testing.assert_allclose(found.variance, means.var(axis=0, ddof=1) / 4, rtol=1e-12)
    np.testing.assert_allclose(found.freedom, 3.0, rtol=1e-9)


def test_trials_that_are_alike_are_one_sample():
    values = np.tile(np.array([[-1.0], [1.0], [0.0]]), (2, P))
    found = plain(values, ["a"] * 3 + ["b"] * 3)
    np.testing.assert_allclose(found.variance, values.var(axis=0, ddof=1) / 6)
    np.testing.assert_allclose(found.freedom, 5.0)


def test_one_cycle_of_each_trial():
    values = np.random.default_rng(2).normal(size=(5, P))
    found, sample = plain(values, list("abcde")), plain(values, ["a"] * 5)
    np.testing.assert_allclose(found.variance, sample.variance)
    np.testing.assert_allclose(found.freedom, 4.0)


def test_a_single_cycle_stands_by_its_own_spread():
    shift, own = np.full((1, P), 3.0), np.full((1, P), 4.0)
    found = mean_of(np.zeros((1, P)), ["a"], shift, own)
    assert np.isnan(found.sd).all()
    np.testing.assert_allclose(half_width_of(found), stats.norm.ppf(0.975) * 5.0, rtol=1e-4)


def test_a_single_number_without_a_spread_has_no_interval():
    unknown = np.full((1, P), np.nan)
    alone = mean_of(np.ones((1, P)), ["a"], np.zeros((1, P)), unknown)
    assert np.isnan(half_width_of(alone)).all()
    assert np.isnan(difference_of(alone, alone, same_body=True).half_width).all()


def test_shifts_do_not_fall_with_the_number_of_cycles_and_cancel_for_the_same_body():
    rng = np.random.default_rng(3)
    shift = np.full((400, P), 2.0)
    one, other = (mean_of(rng.normal(size=(400, P)), ["a"] * 400, shift, shift) for _ in range(2))
    np.testing.assert_allclose(half_width_of(one), 1.96 * 2.0, rtol=0.01)
    own = difference_of(one, other, same_body=False)
    np.testing.assert_allclose(own.half_width, 1.96 * np.sqrt(8.0), rtol=0.01)
    np.testing.assert_allclose(own.difference, one.mean - other.mean)
    same = difference_of(one, other, same_body=True)
    np.testing.assert_allclose(same.half_width, 1.96 * np.sqrt(2.0 / 400.0), rtol=0.15)
    np.testing.assert_allclose(same.high - same.low, 2.0 * same.half_width)


def test_what_postures_apart_leave_of_the_same_bodys_shift_counts():
    """In proportion to the squared distance, by the mean over the curve of both trials' changes."""
    nothing, change = np.zeros((1, P)), np.array([[1.0, 2.0, 3.0, 4.0, 5.0]])
    one, other = (mean_of(nothing, ["a"], nothing, nothing, share * change) for share in (1.0, 2.0))
    apart = np.array([0.0, 0.5, 1.0, 2.0, 4.0])
    found = difference_of(one, other, True, apart)
    np.testing.assert_allclose((found.half_width / 1.96) ** 2, apart * 11.0 * 5.0, rtol=1e-4)
    np.testing.assert_array_equal(difference_of(one, other, False, apart).half_width, np.zeros(P))


def test_welch_of_two_samples():
    rng = np.random.default_rng(4)
    a, b = rng.normal(size=(6, 1)), 3.0 * rng.normal(size=(4, 1))
    found = difference_of(plain(a, ["a"] * 6), plain(b, ["b"] * 4), same_body=True)
    interval = stats.ttest_ind(a, b, equal_var=False).confidence_interval(0.95)
    np.testing.assert_allclose([found.low, found.high], interval, rtol=1e-9)


@pytest.mark.parametrize("between", [0.0, 0.5, 2.0])
def test_intervals_hold_the_truth(between):
    """Four trials of four cycles each, 4000 times: 95 % hold it, whatever the trials do."""
    rng = np.random.default_rng(5)
    trials = [name for name in "abcd" for _ in range(4)]
    values = np.repeat(between * rng.normal(size=(4, 4000)), 4, axis=0) + rng.normal(size=(16, 4000))
    found = plain(values, trials)
    held = float(np.mean(np.abs(found.mean) <= half_width_of(found)))
    assert 0.90 <= held <= 0.98


@given(st.lists(st.sampled_from("abc"), min_size=2, max_size=9), st.floats(-100.0, 100.0))
def test_a_shift_of_all_moves_the_mean_alone(trials, shift):
    values = np.random.default_rng(len(trials)).normal(size=(len(trials), 2))
    here, there = plain(values, trials), plain(values + shift, trials)
    np.testing.assert_allclose(there.mean, here.mean + shift, atol=1e-9)
    np.testing.assert_allclose(there.variance, here.variance, atol=1e-7)
    assert (here.variance >= 0.0).all() and (here.freedom >= 1.0 - 1e-9).all()


def test_what_a_trial_does_to_both_cancels():
    trials = ["a", "a", "b", "b", "c"]
    right, left = np.array([1.0, 3.0, 11.0, 13.0, 22.0]), np.array([1.0, 1.0, 10.5, 11.5, 21.0])
    found = paired_difference(right, trials, left, trials)
    apart = np.array([1.0, 1.0, 1.0])
    np.testing.assert_allclose([found.difference[0], found.half_width[0]], [apart.mean(), 0.0], atol=1e-12)
    assert paired_difference(right[:2], trials[:2], left[:2], trials[:2]) is None
    far = np.array([3.0, 2.0, 8.0, 1.0, 20.0])
    interval = stats.ttest_1samp([-0.5, 7.5, 2.0], 0.0).confidence_interval(0.95)
    by_trial = paired_difference(right, trials, far, trials)
    np.testing.assert_allclose(by_trial.difference - by_trial.half_width, interval.low)
    np.testing.assert_allclose(by_trial.difference + by_trial.half_width, interval.high)
    with_gap = paired_difference(np.array([np.nan, 3.0, 11.0, 13.0, 22.0]), trials, left, trials)
    np.testing.assert_allclose(with_gap.difference, [(2.0 + 1.0 + 1.0) / 3])
