"""The live benchmark's rows say what a run's report says."""

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks import live
from benchmarks.live.runs import Pauses, Run, Trial, largest_difference
from tests.io.reconstructions import made_up

TRIAL = Trial("walk", Path("walk.c3d"), None, Path("s.toml"), 1.0)


def run_of(lost=0, at_start=30, p99=2.5):
    report = {
        "frames_in": 1000,
        "frames_lost": lost,
        "frames_at_start": at_start,
        "latency_ms_median": 2.0,
        "latency_ms_p99": p99,
    }
    return Run(report, Path("run"), np.array([0.1, 0.2, 3.0]))


@pytest.mark.parametrize(
    ("lost", "p99", "passed"), [(0, 2.5, True), (1, 2.5, False), (0, 6.0, False), (0, None, False)]
)
def test_rows_fail_where_frames_are_lost_or_late(monkeypatch, lost, p99, passed):
    monkeypatch.setattr(live, "play", lambda *_, **__: run_of(lost, p99=p99))
    monkeypatch.setattr(live, "difference", lambda _: 1e-12)
    rows = list(live.rows(TRIAL, "lsl", Path(), False))
    assert all(row.passed for row in rows) == passed
    assert ("difference" in rows[-1].name) == (lost == 0)


def test_latency_is_only_bounded_through_lsl(monkeypatch):
    monkeypatch.setattr(live, "play", lambda *_, **__: run_of(p99=50.0))
    monkeypatch.setattr(live, "difference", lambda _: 0.0)
    assert all(row.passed for row in live.rows(TRIAL, "natnet", Path(), True))


def test_pauses_are_told_beside_latencies_and_bounded_by_nothing():
    (told,) = [row for row in live.latency("run", run_of(), live.LATENCY_MS) if "woke" in row.name]
    assert told.value == pytest.approx(np.percentile([0.1, 0.2, 3.0], 99.0)) and told.bound == math.inf


def test_nobody_wakes_before_his_time():
    pauses = Pauses()
    while len(pauses._late) < 3:
        time.sleep(0.01)
    late = pauses.end()
    assert len(late) >= 3 and (late > -0.1).all()


def test_the_highest_rate_is_the_last_that_keeps_up(monkeypatch):
    def play(trial, protocol, folder, *, speed):
        return run_of(at_start=900 if speed > 3.2 else 30)

    monkeypatch.setattr(live, "play", play)
    assert live.highest_rate(TRIAL, Path()) == 300.0


def test_differences_are_relative_and_nan_counts():
    one = made_up()
    assert largest_difference(one, one) == 0.0
    assert largest_difference(replace(one, tau=one.tau + 1e-3), one) == pytest.approx(1e-3, rel=1.0)
    missing = one.q.copy()
    missing[0] = math.nan
    assert math.isnan(largest_difference(replace(one, q=missing), one))
    assert math.isnan(largest_difference(replace(one, tau=one.tau * math.nan), one))
    assert largest_difference(replace(one, q=missing), one, part=slice(1, None)) == 0.0


def test_a_quaternion_and_its_negative_are_one_orientation():
    one = made_up()
    q = one.q.copy()
    q[::2, 3:7] *= -1.0
    assert largest_difference(replace(one, q=q), one) == 0.0
    q[1, 3:7] = [0.0, 0.0, 0.1, -np.sqrt(0.99)]
    other = one.q.copy()
    other[1, 3:7] = [0.0, 0.0, 0.0, 1.0]
    found = largest_difference(replace(one, q=q), replace(one, q=other))
    assert found == pytest.approx(0.1)
    q[0, 0] -= 3.0
    assert largest_difference(replace(one, q=q), one, ("q",)) > 0.5
