"""The kernel counts third differences as numpy does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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
    assert library().third_differences(*samples, level) == expected
