"""Variances of limbs' torques, which depend on few components each, by products of either kind."""

import numpy as np
import pytest

from mbkf.filters.state_variances import state_variances
from mbkf.kernel.loading import library
from tests.filters.test_state_variances import DOFS, NV, assert_diagonals, errors


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


@pytest.mark.skipif(library() is None, reason="the reference sums over whole matrices")
def test_torques_have_the_same_bits_with_other_quantities_before_them():
    """A live run states no moments of the trunk, a whole trial does; their torques' deviations are compared."""
    rng, stated = errors(3)
    T, U = rng.normal(size=(NV, 3 * NV + 12)), rng.normal(size=(2, NV))
    T[rng.random(T.shape) < 0.9] = 0.0
    before = rng.normal(size=(18, 3 * NV + 12))
    alone, after = (state_variances(stated, rows, U, DOFS).torque for rows in (T, np.vstack([before, T])))
    np.testing.assert_array_equal(after[18:], alone)
