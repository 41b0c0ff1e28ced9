"""The rows on the filter's own plant: one band per quantity, and that a filter which boasts fails them."""

from dataclasses import replace

import numpy as np

from benchmarks.dynamic import consistency as dynamic_consistency
from benchmarks.dynamic.consistency import Judged, Run, own_plant_rows, simulate
from benchmarks.dynamic.methods import in_turn


def run_with(ratio):
    rng = np.random.default_rng(0)
    judged = tuple(
        Judged(tuple(ratio * rng.normal(size=50) for _ in range(3)), (ratio**2,) * 3) for _ in range(40)
    )
    return Run(judged, judged, np.full(40, ratio**2 * 90.0), np.full(40, 102))


def test_what_is_as_large_as_stated_passes_and_what_is_not_fails(monkeypatch):
    for ratio, passes in ((1.0, True), (1.5, False), (0.5, False)):
        monkeypatch.setattr(
            dynamic_consistency, "simulate", lambda seed, smoothed=False, r=ratio: run_with(r)
        )
        rows = own_plant_rows(in_turn, quick=True)
        assert all(row.passed for row in rows) == passes


def test_a_run_is_the_same_every_time_and_filters_alike_with_and_without_smoother():
    one, again = (simulate(3, smoothed=smoothed) for smoothed in (True, False))
    np.testing.assert_array_equal(one.nis, again.nis)
    assert len(one.smoothed) == len(one.filtered) and again.smoothed == ()
    for first, second in zip(one.filtered, again.filtered, strict=True):
        assert first.nees == second.nees
    assert replace(one, smoothed=()).readings.tolist() == again.readings.tolist()
