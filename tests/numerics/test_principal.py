"""Principal directions against the singular value decomposition."""

import numpy as np
import pytest

from mbkf.numerics.principal import of_unit_length, principal_directions


def root(rows, columns):
    """Rows whose variance falls tenfold from each direction to the next."""
    rng, size = np.random.default_rng(4), min(rows, columns)
    left, right = (np.linalg.qr(rng.normal(size=(n, size)))[0] for n in (rows, columns))
    return (left * 10.0 ** (-0.5 * np.arange(size))) @ right.T


@pytest.mark.parametrize("shape", [(5, 9), (9, 5), (6, 6)])
@pytest.mark.parametrize(("share", "count"), [(0.85, 1), (0.95, 2), (0.995, 3)])
def test_they_are_the_first_right_singular_vectors(shape, share, count):
    rows = root(*shape)
    found = principal_directions(rows, share)
    expected = np.linalg.svd(rows, full_matrices=False)[2][:count].T
    assert found.shape == expected.shape
    np.testing.assert_allclose(found @ found.T, expected @ expected.T, atol=1e-9)
    np.testing.assert_allclose(found.T @ found, np.eye(count), atol=1e-9)
    kept = ((rows @ found) ** 2).sum() / (rows**2).sum()
    assert share <= kept < 1.0


@pytest.mark.parametrize("shape", [(4, 9), (9, 4)])
def test_the_whole_variance_takes_no_direction_of_rounding(shape):
    rows = root(*shape)
    twice = np.vstack([rows, 0.5 * rows])
    assert principal_directions(twice, 1.0).shape == (shape[1], 4)


@pytest.mark.parametrize("shape", [(6, 3), (1, 3)])
def test_a_root_without_variance_has_one_direction(shape):
    found = principal_directions(np.zeros(shape), 0.99)
    assert found.shape == (3, 1) and np.isfinite(found).all()


def test_rows_count_alike():
    rows = np.array([[3.0, 4.0], [0.0, 0.0], [0.0, 2e-3], [1e-12, 0.0]])
    np.testing.assert_allclose(of_unit_length(rows), [[0.6, 0.8], [0.0, 1.0]], atol=1e-15)
