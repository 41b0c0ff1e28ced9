"""Sliding windows against SciPy's filters and against curves whose derivative is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import binary_dilation, median_filter
from scipy.signal import savgol_filter

from mbkf.numerics.windows import dilated, majority, second_derivative

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


@given(masks, st.integers(0, 20))
def test_majority_is_the_running_median(votes, half):
    expected = median_filter(votes.astype(int), size=2 * half + 1, mode="nearest")
    np.testing.assert_array_equal(majority(votes, 2 * half + 1), expected.astype(bool))


@given(masks, st.integers(1, 20))
def test_dilation_is_scipys(mask, samples):
    np.testing.assert_array_equal(dilated(mask, samples), binary_dilation(mask, iterations=samples))


def test_nothing_is_dilated_to_nothing():
    assert dilated(np.zeros(0, dtype=bool), 3).shape == (0,)
