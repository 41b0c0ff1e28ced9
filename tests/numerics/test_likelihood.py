"""The likelihood from information form is the density of the stacked innovations."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from mbkf.numerics.kalman import information
from mbkf.numerics.likelihood import log_likelihood

SIZE, SEEN = 9, 5


def problem(seed, first=14, second=4):
    """Prior, readings of the first components, and readings of all of them."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(SIZE, SIZE)) * 10 ** rng.uniform(-2, 1, (SIZE, 1))
    H = np.zeros((first + second, SIZE))
    H[:first, :SEEN] = rng.normal(size=(first, SEEN))
    H[first:] = rng.normal(size=(second, SIZE))
    sd = 10 ** rng.uniform(-3, 1, first + second)
    S = H @ A @ A.T @ H.T + np.diag(sd**2)
    return A @ A.T, H, sd, np.linalg.cholesky(S) @ rng.normal(size=first + second), S


def log_density(y, S):
    """Of N(0, S) as it is defined; scipy's sets small directions of S aside."""
    return -0.5 * (y @ np.linalg.solve(S, y) + np.linalg.slogdet(2.0 * np.pi * S).logabsdet)


@given(st.integers(0, 10**6), st.integers(1, 20), st.integers(0, 6))
@example(2627, 15, 5)
@settings(max_examples=60, deadline=None)
def test_it_is_the_normal_density(seed, first, second):
    P, H, sd, y, S = problem(seed, first, second)
    readings = information(y[:first], H[:first, :SEEN], sd[:first])
    rows, values = H[first:] / sd[first:, None], y[first:] / sd[first:]
    logs = 2.0 * np.log(sd)
    found = log_likelihood(P, readings, logs[:first].sum(), rows, values, logs[first:].sum())
    dense = log_density(y, S)
    assert sum(found) == pytest.approx(dense, rel=1e-6, abs=1e-4)
    alone = log_density(y[:first], S[:first, :first])
    assert found.readings == pytest.approx(alone, rel=1e-6, abs=1e-4)


def test_without_rows_there_is_nothing_more():
    P, H, sd, y, _ = problem(1, 6, 0)
    readings = information(y, H[:, :SEEN], sd)
    assert log_likelihood(P, readings, 0.0).rows == 0.0
    assert log_likelihood(P, readings, 0.0, np.zeros((0, SIZE)), np.zeros(0)).rows == 0.0


def test_it_is_largest_at_the_true_noise():
    """Mean over many draws, as the factor on all standard deviations varies."""
    P, H, sd, _, S = problem(3, 14, 0)
    draws = np.linalg.cholesky(S) @ np.random.default_rng(0).normal(size=(14, 400))
    means = []
    for factor in (0.7, 1.0, 1.4):
        found = [
            log_likelihood(P, information(y, H[:, :SEEN], factor * sd), 2 * np.log(factor * sd).sum())
            for y in draws.T
        ]
        means.append(np.mean([one.readings for one in found]))
    assert means[1] > max(means[0], means[2])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_covariance_that_is_none_is_refused(bad):
    P, H, sd, y, _ = problem(2, 6, 0)
    P[0, 0] = bad
    with pytest.raises(np.linalg.LinAlgError), np.errstate(invalid="ignore"):
        log_likelihood(P, information(y, H[:, :SEEN], sd), 0.0)
