"""Regression with noise that stays: exact data, evidence against the whole density, stated against found errors."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mbkf.errors import NotObservable
from mbkf.numerics.correlated_regression import Belief, Series, regress

CHANNELS, PARAMETERS = 2, 3
PRIOR = Belief(np.array([0.5, 0.0, -1.0]), np.diag([1.0, 4.0, 2.0]))


def record(rng, samples, noise=1.0, theta=None, correlation=0.6):
    """A series by known parameters, in two stretches."""
    theta = np.zeros(PARAMETERS) if theta is None else theta
    design = rng.normal(size=(samples, CHANNELS, PARAMETERS))
    follows = np.ones(samples, dtype=bool)
    follows[[0, samples // 2]] = False
    errors = noise * rng.normal(size=(samples, CHANNELS))
    for t in np.flatnonzero(follows):
        errors[t] += correlation * errors[t - 1]
    return Series(design, design @ theta + errors, follows)


def test_exact_data_give_exact_parameters():
    theta = np.array([1.0, -2.0, 0.3])
    found = regress([record(np.random.default_rng(0), 40, 1e-9, theta)], PRIOR)
    np.testing.assert_allclose(found.posterior.mean, theta, atol=1e-8)


def test_the_evidence_is_the_density_of_the_data():
    """Of the samples given those that begin a stretch: as one normal distribution, parameters integrated out."""
    one = record(np.random.default_rng(1), 14)
    found = regress([one], PRIOR)
    noise, now = found.noise[0], np.flatnonzero(one.follows)
    design = one.design[now] - noise.correlation[:, None] * one.design[now - 1]
    values = one.values[now] - noise.correlation * one.values[now - 1]
    flat = design.reshape(-1, PARAMETERS)
    covariance = flat @ np.linalg.inv(PRIOR.precision) @ flat.T + np.kron(np.eye(len(now)), noise.covariance)
    expected = multivariate_normal(flat @ PRIOR.mean, covariance).logpdf(values.ravel())
    assert found.log_evidence == pytest.approx(expected, abs=1e-8)


def test_stated_errors_are_those_found():
    """Squared errors of 60 records over the stated covariance: 180 degrees of freedom, a band of 99 % (chi-square)."""
    rng, total = np.random.default_rng(2), 0.0
    for _ in range(60):
        theta = PRIOR.mean + rng.normal(size=PARAMETERS) / np.sqrt(np.diag(PRIOR.precision))
        found = regress([record(rng, 60, 1.0, theta), record(rng, 60, 3.0, theta, 0.2)], PRIOR)
        away = found.posterior.mean - theta
        total += away @ found.posterior.precision @ away
    assert 134.9 < total < 232.0


def test_noise_is_found():
    found = regress([record(np.random.default_rng(4), 4000, 2.0)], PRIOR)
    np.testing.assert_allclose(found.noise[0].correlation, 0.6, atol=0.03)
    np.testing.assert_allclose(found.noise[0].covariance, 4.0 * np.eye(CHANNELS), atol=0.2)
    np.testing.assert_allclose(
        found.posterior.covariance @ found.posterior.precision, np.eye(PARAMETERS), atol=1e-12
    )


def test_too_few_samples_are_refused():
    with pytest.raises(NotObservable, match="too few samples in a row"):
        regress([record(np.random.default_rng(5), 5)], PRIOR)
