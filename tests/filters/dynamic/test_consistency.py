"""Does the dynamic filter err as much as it says? The benchmark's simulation, judged more sharply than there."""

from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.dynamic.consistency import (
    FRAMES,
    QUANTITIES,
    RUNS,
    SMOOTHED_RUNS,
    nees_of,
    ratios_of,
    simulate,
)

pytestmark = pytest.mark.slow


@cache
def simulated():
    return [simulate(seed, smoothed=seed < SMOOTHED_RUNS) for seed in range(RUNS)]


def estimates(smoothed):
    return (
        [run.smoothed for run in simulated()[:SMOOTHED_RUNS]]
        if smoothed
        else [run.filtered for run in simulated()]
    )


both = pytest.mark.parametrize("smoothed", [False, True], ids=["filter", "smoother"])
each = pytest.mark.parametrize("quantity", range(3), ids=QUANTITIES)


@both
@each
def test_errors_are_as_large_as_stated(quantity, smoothed):
    """Mean squared error over variance, over all dofs, frames and runs."""
    assert np.mean(ratios_of(estimates(smoothed), quantity) ** 2) == pytest.approx(1.0, abs=0.08)


@both
@each
def test_intervals_of_95_percent_cover_as_much(quantity, smoothed):
    inside = np.abs(ratios_of(estimates(smoothed), quantity)) < 1.959964
    assert 0.93 < inside.mean() < 0.97


@both
@each
def test_every_dof_errs_as_much_as_stated(quantity, smoothed):
    """At the middle and the last frame: over independent runs, each sum of squares lies in its χ² band."""
    for t in (FRAMES // 2, FRAMES - 1):
        errors_there = ratios_of(estimates(smoothed), quantity)[:, t]
        runs, dofs = errors_there.shape
        low, high = chi2(runs).ppf([0.001 / dofs, 1.0 - 0.001 / dofs])
        total = (errors_there**2).sum(axis=0)
        assert (total > low).all() and (total < high).all()


@both
@pytest.mark.parametrize(("quantity", "most"), [(0, 1.08), (1, 1.08), (2, 1.25)], ids=QUANTITIES)
def test_whole_covariances_are_as_large_as_errors(quantity, most, smoothed):
    """NEES per dof. Torques have directions known to 0.01 N m, where the second order of T's other terms shows."""
    assert 0.93 < nees_of(estimates(smoothed), quantity).mean() < most


def test_innovations_are_as_large_as_stated():
    """NIS over all readings but the 12 that a wide random walk takes up: a χ² of 110 000 degrees of freedom."""
    runs = simulated()
    freedom = sum((run.readings - 12).sum() for run in runs)
    assert freedom > 100_000
    low, high = chi2(freedom).ppf([1e-5, 1.0 - 1e-5]) / freedom
    ratio = sum(run.nis.sum() for run in runs) / freedom
    assert low - 0.005 < ratio < high + 0.005
