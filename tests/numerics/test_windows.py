"""Sliding windows against SciPy's filters and against curves whose derivative is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import binary_closing, binary_dilation, median_filter
from scipy.signal import savgol_filter

from mbkf.numerics.windows import bridged, dilated, local_lines, majority, second_derivative, slopes

masks = st.lists(st.booleans(), min_size=1, max_size=60).map(lambda values: np.array(values, dtype=bool))


@given(
    st.integers(1, 12), st.integers(0, 60), st.floats(1e-3, 1.0), st.floats(0.0, 2.0), st.integers(0, 10_000)
)
def test_the_second_derivative_is_savgols(half, more, dt, height, seed):
    window = 2 * half + 1
    samples = height + np.random.default_rng(seed).normal(scale=0.1, size=window + more)
    expected = savgol_filter(samples, window, 2, deriv=2, delta=dt, mode="interp")
    found = second_derivative(samples, window, dt)
    assert found.shape == samples.shape
    np.testing.assert_allclose(found * dt**2, expected * dt**2, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("window", [3, 7, 15])
def test_a_parabola_has_its_own_second_derivative_up_to_the_ends(window):
    t = np.arange(40) * 0.01
    np.testing.assert_allclose(
        second_derivative(1.0 + 2.0 * t - 4.905 * t**2, window, 0.01), -9.81, rtol=1e-9
    )


@given(st.integers(1, 12), st.integers(0, 60), st.floats(1e-3, 1.0), st.integers(0, 10_000))
def test_slopes_are_savgols(half, more, dt, seed):
    """Up to half a window from either end, and from there on the last one."""
    window = 2 * half + 1
    samples = np.random.default_rng(seed).normal(size=(window + more, 3))
    expected = savgol_filter(samples, window, 2, deriv=1, delta=dt, axis=0)
    found, inside = slopes(samples, window, dt), slice(half, half + more + 1)
    assert found.shape == samples.shape
    np.testing.assert_allclose(found[inside] * dt, expected[inside] * dt, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(found[:half], np.tile(found[half], (half, 1)))
    np.testing.assert_array_equal(found[half + more :], np.tile(found[half + more], (half + 1, 1)))


@pytest.mark.parametrize("window", [3, 7, 15])
def test_a_parabola_has_its_own_slopes(window):
    t = np.arange(40) * 0.01
    found = slopes(np.column_stack([1.0 + 2.0 * t - 4.905 * t**2, 3.0 - t]), window, 0.01)
    inside = slice(window // 2, -(window // 2))
    np.testing.assert_allclose(found[inside, 0], (2.0 - 9.81 * t)[inside], rtol=1e-9)
    np.testing.assert_allclose(found[:, 1], -1.0, rtol=1e-9)


@given(masks, st.integers(0, 20))
def test_majority_is_the_running_median(votes, half):
    expected = median_filter(votes.astype(int), size=2 * half + 1, mode="nearest")
    np.testing.assert_array_equal(majority(votes, 2 * half + 1), expected.astype(bool))


@given(masks, st.integers(1, 20))
def test_dilation_is_scipys(mask, samples):
    np.testing.assert_array_equal(dilated(mask, samples), binary_dilation(mask, iterations=samples))


def test_nothing_is_dilated_to_nothing():
    assert dilated(np.zeros(0, dtype=bool), 3).shape == (0,)


@given(st.integers(3, 60), st.floats(0.05, 2.0), st.integers(0, 10_000))
def test_a_line_with_gaps_is_its_own_local_line(frames, width, seed):
    rng = np.random.default_rng(seed)
    t, known = 0.05 * np.arange(frames), rng.random(frames) < 0.7
    level, slope = rng.normal(size=2), rng.normal(size=2)
    line = level + slope * t[:, None]
    value, found = local_lines(np.where(known[:, None], line, np.nan), known, 0.05, width)
    steady = np.isfinite(found).all(axis=1) & (found != 0.0).all(axis=1)
    np.testing.assert_allclose(found[steady], np.tile(slope, (steady.sum(), 1)), rtol=0, atol=1e-9)
    np.testing.assert_allclose(value[steady], line[steady], rtol=0, atol=1e-9)


def test_the_local_line_is_the_weighted_fit():
    """Against NumPy's polynomial fit, whose weights are the roots of ours."""
    rng = np.random.default_rng(0)
    t, samples, known = 0.01 * np.arange(80), rng.normal(size=(80, 1)), rng.random(80) < 0.6
    value, slope = local_lines(samples, known, 0.01, 0.1)
    for k in (0, 17, 40, 79):
        near = known & (np.abs(t - t[k]) < 0.305)
        weights = np.exp(-0.25 * ((t[near] - t[k]) / 0.1) ** 2)
        fit = np.polyfit(t[near] - t[k], samples[near, 0], 1, w=weights)
        np.testing.assert_allclose([slope[k, 0], value[k, 0]], fit, rtol=1e-8)


def test_what_swings_faster_than_the_window_goes_out():
    t = 0.01 * np.arange(600)
    value, slope = local_lines((t + 0.05 * np.sin(2 * np.pi * t))[:, None], np.ones(600, bool), 0.01, 0.5)
    inside = slice(150, -150)
    np.testing.assert_allclose(slope[inside], 1.0, atol=0.01)
    np.testing.assert_allclose(value[inside, 0], t[inside], atol=0.002)


def test_a_lonely_sample_has_no_slope_and_far_from_any_there_is_nothing():
    samples, known = np.full((100, 1), 3.0), np.arange(100) == 10
    value, slope = local_lines(samples, known, 0.1, 0.5)
    assert (value[10, 0], slope[10, 0]) == (3.0, 0.0)
    assert np.isnan(value[60]).all() and np.isnan(slope[60]).all()


@given(st.lists(st.booleans(), min_size=1, max_size=40), st.integers(1, 5))
def test_bridged_is_binary_closing(values, samples):
    mask = np.array(values)
    padded = np.pad(mask, 2 * samples)
    closed = binary_closing(padded, np.ones(2 * samples + 1))[2 * samples : -2 * samples]
    found = bridged(mask, samples)
    inner = slice(samples, max(len(mask) - samples, samples))
    np.testing.assert_array_equal(found[inner], closed[inner])
    assert found[mask].all()


def test_lines_do_not_depend_on_the_blocks_that_they_are_fitted_in(monkeypatch):
    """Samples of neighbouring blocks count at a border, with gaps on either side of it, too."""
    rng = np.random.default_rng(5)
    samples, known = rng.normal(size=(300, 2)).cumsum(axis=0), rng.random(300) > 0.2
    known[[*range(36, 39), *range(140, 190)]] = False
    whole = local_lines(samples, known, 0.01, 0.05)
    monkeypatch.setattr("mbkf.numerics.windows._BLOCK", 37)
    np.testing.assert_allclose(local_lines(samples, known, 0.01, 0.05), whole, rtol=1e-9, atol=1e-11)
