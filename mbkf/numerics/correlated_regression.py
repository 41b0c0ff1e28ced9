"""Bayesian linear regression of time series whose noise is correlated in time and of unknown size.

Series k has samples y_t = D_t θ + n_t of C channels, n_t = ρ ∘ n_{t−1} + e_t with e_t ~ N(0, Σ), and
θ ~ N(θ₀, Λ₀⁻¹). ρ (per channel) and Σ of each series are those of greatest likelihood, by expectation and maximisation
(A. P. Dempster, N. M. Laird, D. B. Rubin, J. R. Stat. Soc. B 39 (1977) 1-38); the evidence is ∫ p(y | θ) p(θ) dθ at
them (D. J. C. MacKay, Neural Computation 4 (1992) 415-447). What begins a stretch has no noise before it and serves
only the sample after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotObservable

ROUNDS, SETTLED = 100, 1e-2
"""Rounds at most, and change of the log evidence that ends them."""

MOST_CORRELATED = 0.98
"""Correlation of the noise from one sample to the next, at most."""


@dataclass(frozen=True)
class Series:
    """Samples of one record.

    Attributes:
        design: (N, C, P) derivatives by the parameters.
        values: (N, C) what is to be explained.
        follows: (N,) whether a sample is one step after the one before it.
    """

    design: Array
    values: Array
    follows: BoolArray


@dataclass(frozen=True)
class Belief:
    """A normal distribution of the parameters: mean (P,) and precision (P, P)."""

    mean: Array
    precision: Array

    @property
    def covariance(self) -> Array:
        """(P, P) inverse of the precision, by components of like size: masses and metres stand side by side."""
        size = np.sqrt(np.diag(self.precision))
        return np.asarray(np.linalg.inv(self.precision / np.outer(size, size)) / np.outer(size, size))


@dataclass(frozen=True)
class Noise:
    """Noise of a series: correlation (C,) from one sample to the next, covariance (C, C) of what is new in each."""

    correlation: Array
    covariance: Array


@dataclass(frozen=True)
class Regression:
    """Posterior of the parameters by series.

    Attributes:
        posterior: The parameters.
        noise: By series.
        log_evidence: ln p(y), nats.
    """

    posterior: Belief
    noise: tuple[Noise, ...]
    log_evidence: float


def regress(series: Sequence[Series], prior: Belief) -> Regression:
    """Parameters, noise and evidence of some series.

    Args:
        series: The records; their noise is independent of each other.
        prior: What is known before.

    Raises:
        NotObservable: A series has too few samples for its noise.
    """
    for one in series:
        if int(one.follows.sum()) < 2 * one.values.shape[1]:
            raise NotObservable("too few samples in a row to tell their noise")
    noise = [_noise(one, prior.mean, None) for one in series]
    before = -np.inf
    for _ in range(ROUNDS):
        white = [_differenced(one, own.correlation) for one, own in zip(series, noise, strict=True)]
        posterior = _posterior(white, noise, prior)
        evidence = _log_evidence(white, noise, prior, posterior)
        if abs(evidence - before) < SETTLED:
            break
        before, covariance = evidence, posterior.covariance
        noise = [_noise(one, posterior.mean, covariance) for one in series]
    return Regression(posterior, tuple(noise), evidence)


def _differenced(one: Series, correlation: Array) -> tuple[Array, Array]:
    """(n, C, P), (n, C) samples less what their noise has from the one before."""
    now = np.flatnonzero(one.follows)
    design = one.design[now] - correlation[:, None] * one.design[now - 1]
    return design, one.values[now] - correlation * one.values[now - 1]


def _noise(one: Series, mean: Array, covariance: Array | None) -> Noise:
    """Noise of greatest expected likelihood for parameters of a mean (P,) and covariance (P, P), 0 for None."""
    now = np.flatnonzero(one.follows)
    rest = one.values - one.design @ mean
    products, squares = (rest[now] * rest[now - 1]).sum(axis=0), (rest[now - 1] ** 2).sum(axis=0)
    if covariance is not None:
        spread = one.design @ covariance
        products += np.einsum("tcp,tcp->c", spread[now], one.design[now - 1])
        squares += np.einsum("tcp,tcp->c", spread[now - 1], one.design[now - 1])
    correlation = np.clip(products / squares, 0.0, MOST_CORRELATED)
    design, values = _differenced(one, correlation)
    fresh = values - design @ mean
    second = fresh.T @ fresh
    if covariance is not None:
        second += np.einsum("tcp,pr,tdr->cd", design, covariance, design, optimize=True)
    return Noise(correlation, second / len(now))


def _posterior(white: Sequence[tuple[Array, Array]], noise: Sequence[Noise], prior: Belief) -> Belief:
    precision, vector = prior.precision.copy(), prior.precision @ prior.mean
    for (design, values), own in zip(white, noise, strict=True):
        weighted = np.einsum("cd,tdp->tcp", np.linalg.inv(own.covariance), design)
        flat = weighted.reshape(-1, design.shape[2])
        precision += flat.T @ design.reshape(flat.shape)
        vector += flat.T @ values.ravel()
    return Belief(np.asarray(np.linalg.solve(precision, vector)), precision)


def _log_evidence(
    white: Sequence[tuple[Array, Array]], noise: Sequence[Noise], prior: Belief, posterior: Belief
) -> float:
    away = posterior.mean - prior.mean
    found = _half_log(prior.precision) - _half_log(posterior.precision)
    found -= 0.5 * float(away @ prior.precision @ away)
    for (design, values), own in zip(white, noise, strict=True):
        rest = values - design @ posterior.mean
        found -= 0.5 * float(np.einsum("tc,cd,td->", rest, np.linalg.inv(own.covariance), rest))
        found -= len(rest) * (_half_log(own.covariance) + 0.5 * rest.shape[1] * np.log(2.0 * np.pi))
    return found


def _half_log(matrix: Array) -> float:
    """Half the logarithm of a determinant."""
    return 0.5 * float(np.linalg.slogdet(matrix)[1])
