"""Variances of limbs' torques, which depend on few components each, by products of either kind."""

import pytest

from tests.filters.test_state_variances import NV, assert_diagonals, errors


@pytest.mark.usefixtures("products")
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("rows", [1, 8, 23, NV])
def test_quantities_that_depend_on_few_components_each_have_the_whole_covariances_variance(seed, rows):
    """Eight rows together lack components at the ends, within, or all of them."""
    rng, stated = errors(seed, 0.3)
    T = rng.normal(size=(rows, 3 * NV + 12))
    T[rng.random((rows, T.shape[1])) < 0.9] = 0.0
    T[8:16] = 0.0
    assert_diagonals(stated, T, T[:2, :NV])
