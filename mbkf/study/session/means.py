"""Means of cycles with their uncertainty, and the difference of two means with its 95 % interval.

Cycles of one trial are more alike than those of different trials, so the variance of a mean is that of a one-way random
effects model (S. R. Searle, G. Casella and C. E. McCulloch, Variance Components, 1992, section 3.6): with n_i cycles in
trial i, N in all, k trials, mean squares between (MSB) and within trials (MSW),

    sigma_b^2 = max(0, (MSB - MSW) / n_0),   n_0 = (N - sum n_i^2 / N) / (k - 1),
    var(mean) = sigma_b^2 sum (n_i / N)^2 + MSW / N.

The shift that errors of the scaled body cause in every cycle alike does not fall with the number of cycles; its
variance is added. Between two means of the same scaled body it drops out as far as the postures are the same: what is
left is taken to change in proportion to the posture. With s² the mean variance of the shift's change within both
trials, and d² the squared distance of both postures at a point over the postures' mean squared distance from their
means, both added over the two, d² s² remains.

Degrees of freedom are Welch and Satterthwaite's (B. L. Welch, Biometrika 34, 1947, 28-35).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from mbkf.conventions import Array

CONFIDENCE = 0.95
"""Of intervals."""


@dataclass(frozen=True)
class Mean:
    """The mean of cycles at P points.

    Attributes:
        mean: (P,) mean.
        sd: (P,) standard deviation between cycles; NaN for a single one.
        variance: (P,) of the mean, by how cycles and trials differ.
        freedom: (P,) degrees of freedom of that variance.
        shift_variance: (P,) of the shift that all cycles share.
        change_variance: (P,) of the change of that shift with the posture, about its mean over the trial.
        count: How many cycles.
    """

    mean: Array
    sd: Array
    variance: Array
    freedom: Array
    shift_variance: Array
    change_variance: Array
    count: int


@dataclass(frozen=True)
class Difference:
    """One mean less another at P points.

    Attributes:
        difference: (P,) the difference.
        half_width: (P,) of its 95 % interval.
    """

    difference: Array
    half_width: Array

    @property
    def low(self) -> Array:
        """(P,) lower end of the interval."""
        return self.difference - self.half_width

    @property
    def high(self) -> Array:
        """(P,) upper end of the interval."""
        return self.difference + self.half_width


def mean_of(
    values: Array, trials: Sequence[str], shift_sd: Array, own_sd: Array, change_sd: Array | None = None
) -> Mean:
    """The mean of cycles.

    Args:
        values: (C, P) cycles, C at least 1.
        trials: (C,) the trial that each is from.
        shift_sd: (C, P) standard deviations of the shift that all cycles share; NaN counts as 0.
        own_sd: (C, P) stated standard deviations of a cycle by itself, which stand in for the spread between cycles
            where there is one only; NaN where that is not known, and then no interval is.
        change_sd: (C, P) standard deviations of the change of that shift with the posture; None and NaN count as 0.
    """
    count = len(values)
    mean = values.mean(axis=0)
    shift = np.nan_to_num(shift_sd).mean(axis=0) ** 2
    change = np.zeros_like(mean) if change_sd is None else np.nan_to_num(change_sd).mean(axis=0) ** 2
    if count == 1:
        unknown, infinite = np.full_like(mean, np.nan), np.full_like(mean, np.inf)
        return Mean(mean, unknown, own_sd[0] ** 2, infinite, shift, change, 1)
    variance, freedom = _variance_of_mean(values, trials)
    return Mean(mean, values.std(axis=0, ddof=1), variance, freedom, shift, change, count)


def half_width(mean: Mean) -> Array:
    """(P,) half of the 95 % interval of a mean: how cycles and trials differ, and the shift that they share.

    Args:
        mean: The mean.
    """
    parts = [(mean.variance, mean.freedom), (mean.shift_variance, np.full_like(mean.mean, np.inf))]
    variance = np.sum([part for part, _ in parts], axis=0)
    return np.asarray(_quantile(_freedom(parts)) * np.sqrt(variance))


def difference_of(after: Mean, before: Mean, same_body: bool, apart: Array | float = 0.0) -> Difference:
    """After less before, with its interval.

    Args:
        after: One mean.
        before: The other.
        same_body: Whether both were reconstructed with the same scaled person: shifts cancel in the same posture.
        apart: (P,) squared distance d² of both postures, as above; it counts for the same person.
    """
    parts = [(after.variance, after.freedom), (before.variance, before.freedom)]
    infinite = np.full_like(after.mean, np.inf)
    if same_body:
        parts += [
            (apart * one.change_variance.mean() * np.ones_like(one.mean), infinite) for one in (after, before)
        ]
    else:
        parts += [(after.shift_variance, infinite), (before.shift_variance, infinite)]
    variance = np.sum([part for part, _ in parts], axis=0)
    return Difference(after.mean - before.mean, _quantile(_freedom(parts)) * np.sqrt(variance))


def paired_difference(
    values: Array, trials: Sequence[str], other_values: Array, other_trials: Sequence[str]
) -> Difference | None:
    """The mean over trials of one quantity less another, with its interval: an error of a trial in both cancels.

    Args:
        values: (N,) of the first quantity, e.g. of right steps; NaN where not known.
        trials: (N,) the trial of each.
        other_values: (M,) of the second.
        other_trials: (M,) the trial of each.

    Returns:
        The difference; None: fewer than two trials know both.
    """
    first, second = _by_trial(values, trials), _by_trial(other_values, other_trials)
    apart = np.array([first[name] - second[name] for name in first if name in second])
    if len(apart) < 2:
        return None
    half = _quantile(np.array([len(apart) - 1.0])) * apart.std(ddof=1) / np.sqrt(len(apart))
    return Difference(apart.mean(keepdims=True), half)


def _by_trial(values: Array, trials: Sequence[str]) -> dict[str, float]:
    """The mean of each trial that has one."""
    names, known = np.asarray(trials), np.isfinite(values)
    return {str(name): float(values[known & (names == name)].mean()) for name in np.unique(names[known])}


def _variance_of_mean(values: Array, trials: Sequence[str]) -> tuple[Array, Array]:
    """(P,) variance of the mean of several cycles, and its degrees of freedom."""
    _, member, sizes = np.unique(trials, return_inverse=True, return_counts=True)
    N, k = len(values), len(sizes)
    if k == 1:
        return values.var(axis=0, ddof=1) / N, np.full(values.shape[1], float(N - 1))
    means = np.array([values[member == i].mean(axis=0) for i in range(k)])
    msb = (sizes[:, None] * (means - values.mean(axis=0)) ** 2).sum(axis=0) / (k - 1)
    if k == N:  # one cycle of each trial
        return msb / N, np.full(values.shape[1], float(k - 1))
    msw = ((values - means[member]) ** 2).sum(axis=0) / (N - k)
    n_0 = (N - (sizes**2).sum() / N) / (k - 1)
    weight = (sizes**2).sum() / N**2 / n_0
    apart = msb > msw
    between, within = weight * msb, (1.0 / N - weight) * msw
    pooled = ((k - 1) * msb + (N - k) * msw) / (N - 1)
    variance = np.where(apart, between + within, pooled / N)
    freedom = (between + within) ** 2 / np.maximum(between**2 / (k - 1) + within**2 / (N - k), 1e-300)
    return variance, np.where(apart, np.maximum(freedom, 1.0), float(N - 1))


def _freedom(parts: list[tuple[Array, Array]]) -> Array:
    """(P,) degrees of freedom of a sum of variances, each with its own."""
    total = np.sum([part for part, _ in parts], axis=0)
    uncertain = np.sum([part**2 / freedom for part, freedom in parts], axis=0)
    return total**2 / np.maximum(uncertain, 1e-300)


def _quantile(freedom: Array) -> Array:
    """(P,) how many standard deviations half an interval is wide (Student's t)."""
    bounded = np.clip(freedom, 1.0, 1e6)
    return np.asarray(stdtrit(bounded, 0.5 + 0.5 * CONFIDENCE))
