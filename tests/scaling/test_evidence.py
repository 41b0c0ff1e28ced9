"""Spreads that the fit shows: those that unknowns were drawn with, and the prior's where nothing is determined."""

import numpy as np
import pytest

from mbkf.scaling.evidence import RANGE, variance_factors

N, NOISE = 400, 0.1


def squares_of(true, noise, seed=3):
    """s² of unknowns that are read once with white noise, the prior's spread 1, all of them one group."""
    read = true + noise * np.random.default_rng(seed).normal(size=len(true))
    information = (1.0 + noise**-2) * np.eye(len(true))
    return variance_factors(
        information, np.eye(len(true)), read / (1.0 + noise**2), [np.ones(len(true), dtype=bool)]
    )


@pytest.mark.parametrize("spread", [0.4, 1.0, 1.5])
def test_the_spread_of_determined_unknowns_is_found(spread):
    true = spread * np.random.default_rng(5).normal(size=N)
    assert squares_of(true, NOISE)[0] ** 0.5 == pytest.approx(np.sqrt(np.mean(true**2)), rel=0.03)


def test_groups_have_spreads_of_their_own():
    rng = np.random.default_rng(6)
    first = np.arange(2 * N) < N
    true = np.where(first, 0.5, 1.6) * rng.normal(size=2 * N)
    read = true + NOISE * rng.normal(size=2 * N)
    information = (1.0 + NOISE**-2) * np.eye(2 * N)
    found = variance_factors(information, np.eye(2 * N), read / (1.0 + NOISE**2), [first, ~first])
    for square, group in zip(found, (first, ~first), strict=True):
        assert square**0.5 == pytest.approx(np.sqrt(np.mean(true[group] ** 2)), rel=0.03)


def test_unknowns_that_nothing_determines_keep_their_prior():
    precision = np.diag(np.random.default_rng(4).uniform(0.1, 10.0, 7))
    found = variance_factors(precision.copy(), precision, np.zeros(7), [np.ones(7, dtype=bool)])
    assert found == [pytest.approx(1.0)]


def test_it_stays_in_its_range():
    assert squares_of(100.0 * np.ones(9), NOISE) == [RANGE[1] ** 2]
    assert squares_of(np.zeros(9), 1e-9)[0] >= RANGE[0] ** 2
