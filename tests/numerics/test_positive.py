"""The nearest covariance to one that rounding has spoilt."""

import numpy as np
import pytest

from mbkf.numerics.positive import made_positive

SCALE = np.array([1e-3, 1.0, 1e3, 1e-2])


def spoilt(lowest):
    """A symmetric matrix in mixed units whose correlations have this smallest eigenvalue."""
    vectors = np.linalg.qr(np.random.default_rng(0).normal(size=(4, 4)))[0]
    return (vectors * [lowest, 0.5, 1.0, 2.0]) @ vectors.T * SCALE * SCALE[:, None]


def test_a_covariance_stays_what_it_is():
    P = spoilt(0.1)
    np.testing.assert_allclose(
        made_positive(P) / SCALE / SCALE[:, None], P / SCALE / SCALE[:, None], atol=1e-12
    )


@pytest.mark.parametrize("lowest", [-1e-9, -1e-3, 0.0])
def test_what_is_not_positive_is_made_so_by_no_more_than_it_lacks(lowest):
    P = spoilt(lowest)
    found = made_positive(P)
    np.testing.assert_array_equal(found, found.T)
    np.linalg.cholesky(found / SCALE / SCALE[:, None] + 1e-13 * np.eye(4))
    assert np.abs((found - P) / SCALE / SCALE[:, None]).max() < 10.0 * abs(lowest) + 1e-10


def test_what_holds_no_numbers_is_refused():
    with pytest.raises(np.linalg.LinAlgError):
        made_positive(np.full((3, 3), np.nan))
