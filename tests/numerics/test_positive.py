"""The inverse and solutions are the general ones; the nearest covariance has no negative eigenvalues."""

import numpy as np
import pytest

from mbkf.numerics.positive import (
    eliminated,
    inverse,
    made_positive,
    regular_inverse,
    solved_with_spreads,
    whitened,
)

SCALES = np.array([1e-4, 1.0, 1e3, 30.0])


def test_a_spoilt_covariance_becomes_positive_and_stays_near():
    rng = np.random.default_rng(0)
    A = rng.normal(size=(4, 3))
    P = SCALES[:, None] * (A @ A.T) * SCALES
    spoilt = P - 1e-9 * np.diag(SCALES**2)
    assert np.linalg.eigvalsh(spoilt / SCALES / SCALES[:, None]).min() < 0.0
    found = made_positive(spoilt)
    np.testing.assert_array_equal(found, found.T)
    assert np.linalg.eigvalsh(found / SCALES / SCALES[:, None]).min() >= 0.0
    np.testing.assert_allclose(found / SCALES / SCALES[:, None], P / SCALES / SCALES[:, None], atol=1e-8)


def test_a_covariance_stays_what_it_is():
    A = np.random.default_rng(1).normal(size=(4, 6))
    P = SCALES[:, None] * (A @ A.T) * SCALES
    np.testing.assert_allclose(made_positive(P), P, rtol=1e-12)


def test_what_is_no_number_is_refused():
    with pytest.raises(np.linalg.LinAlgError):
        made_positive(np.full((3, 3), np.nan))


@pytest.mark.parametrize("columns, shift", [(9, 0.0), (6, 0.0), (9, -6.0)])
def test_the_inverse_is_the_general_one_of_indefinite_matrices_too(columns, shift):
    A = np.random.default_rng(2).normal(size=(6, columns))
    P = A @ A.T + shift * np.eye(6)
    found = inverse(P)
    np.testing.assert_allclose(found, np.linalg.inv(P), rtol=1e-8, atol=1e-10 * np.abs(found).max())
    np.testing.assert_allclose(P @ found, np.eye(6), atol=1e-8)


def test_a_regular_inverse_is_exact():
    rng = np.random.default_rng(3)
    root = rng.normal(size=(9, 12)) * 10.0 ** rng.integers(-3, 4, 9)[:, None]
    P = root @ root.T
    found, sd = regular_inverse(P, 1e-9), np.sqrt(np.diag(P))
    np.testing.assert_array_equal(found, found.T)
    assert np.abs((found @ P - np.eye(9)) * sd[:, None] / sd).max() < 1e-9


@pytest.mark.parametrize("correlation", [1.0 - 1e-11, 1.5, np.nan])
def test_a_matrix_that_rounding_would_decide_has_no_regular_inverse(correlation):
    """Components that depend on others, an indefinite matrix, missing numbers; and a negative or missing variance."""
    P = np.diag(SCALES**2)
    P[2, 3] = P[3, 2] = correlation * SCALES[2] * SCALES[3]
    assert regular_inverse(P, 1e-9) is None
    assert regular_inverse(np.diag([1.0, 1.0 - correlation - 1e-6]), 1e-9) is None
    P[2, 3] = P[3, 2] = (1.0 - 1e-7) * SCALES[2] * SCALES[3]
    assert regular_inverse(P, 1e-9) is not None


def test_a_singular_matrix_has_no_inverse():
    with pytest.raises(np.linalg.LinAlgError):
        inverse(np.zeros((3, 3)))


def test_elimination_keeps_the_covariance_of_the_others():
    A = np.random.default_rng(1).normal(size=(6, 6))
    information, unknowns = A @ A.T + np.eye(6), np.array([1, 4])
    others = np.array([0, 2, 3, 5])
    expected = np.linalg.inv(np.linalg.inv(information)[np.ix_(others, others)])
    np.testing.assert_allclose(eliminated(information, unknowns), expected, rtol=1e-10)
    assert eliminated(information, unknowns[:0]) is information


@pytest.mark.parametrize("columns, shift", [(9, 0.0), (9, -6.0)])
def test_solution_and_spreads_are_those_of_the_general_inverse(columns, shift):
    """Of indefinite matrices, too; the upper triangle is not read."""
    rng = np.random.default_rng(2)
    A, right = rng.normal(size=(6, columns)), rng.normal(size=6)
    P = A @ A.T + shift * np.eye(6)
    expected = np.linalg.inv(P)
    found, spreads = solved_with_spreads(np.tril(P), right)
    np.testing.assert_allclose(found, expected @ right, rtol=1e-8)
    np.testing.assert_allclose(spreads, np.diag(expected), rtol=1e-8)


def test_a_whitened_prior_is_the_identity_and_others_keep_their_ratio_to_it():
    rng = np.random.default_rng(3)
    A, B = rng.normal(size=(2, 5, 9))
    prior, other = A @ A.T, B @ B.T
    root = np.linalg.cholesky(prior)
    np.testing.assert_allclose(np.tril(whitened(prior, root)), np.eye(5), atol=1e-12)
    inverse_root = np.linalg.inv(root)
    np.testing.assert_allclose(
        np.tril(whitened(other, root)), np.tril(inverse_root @ other @ inverse_root.T), rtol=1e-9
    )
