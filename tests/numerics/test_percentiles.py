"""Percentiles of columns with gaps are those of NumPy."""

import warnings

import numpy as np
import pytest

from mbkf.numerics.percentiles import known_percentiles

PERCENTS = (0.0, 10.0, 37.5, 50.0, 90.0, 100.0)


@pytest.mark.parametrize("missing", [0.0, 0.3, 0.9, 1.0])
@pytest.mark.parametrize("shape", [(1, 3), (2, 3), (41, 3, 4), (40, 7)])
def test_they_are_those_of_numpy(shape, missing):
    rng = np.random.default_rng(3)
    values = np.where(rng.random(shape) < missing, np.nan, rng.normal(size=shape))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "All-NaN slice", RuntimeWarning)
        expected = np.nanpercentile(values, PERCENTS, axis=0)
    np.testing.assert_allclose(known_percentiles(values, PERCENTS), expected, rtol=0, atol=1e-15)


def test_one_column_without_further_axes():
    np.testing.assert_allclose(known_percentiles(np.array([4.0, np.nan, 0.0, 2.0]), (25.0, 50.0)), [1.0, 2.0])


def test_without_samples_there_are_none():
    assert np.isnan(known_percentiles(np.zeros((0, 2)), PERCENTS)).all()
