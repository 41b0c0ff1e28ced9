"""The kernel counts third differences as numpy does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.kernel.differences import third_differences
from mbkf.kernel.loading import library

needs_kernel = pytest.mark.skipif(library() is None, reason="the kernel is not compiled here")


@needs_kernel
@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 40), st.floats(0.0, 20.0))
def test_they_are_counted_as_numpy_does(seed, markers, level):
    rng = np.random.default_rng(seed)
    samples = rng.normal(size=(4, markers, 3))
    samples[rng.random(samples.shape) < 0.1] = np.nan
    third = np.abs(np.diff(samples, 3, axis=0))
    expected = np.count_nonzero(~np.isnan(third)), np.count_nonzero(third < level)
    assert third_differences(tuple(samples), level) == expected


@needs_kernel
def test_samples_of_other_sizes_are_refused():
    one = np.zeros(6)
    with pytest.raises(ValueError, match="type or size"):
        third_differences((one, one, one[:3], one), 1.0)
    with pytest.raises(TypeError):
        third_differences((one, one, one, one), "level")


@pytest.mark.usefixtures("reference_kernel")
def test_without_a_kernel_nothing_is_counted():
    assert third_differences((np.zeros(3),) * 4, 1.0) is None
