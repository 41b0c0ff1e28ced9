"""Counts of a run: the rate from first to latest frame, and latencies at a start apart from the others."""

import numpy as np
import pytest

from mbkf.stream.receiving.alignment import ReadyFrame
from mbkf.stream.run.statistics import RECENT_FRAMES, RunStatistics


def ready(number, arrival_s):
    return ReadyFrame(number, arrival_s, None, np.zeros((0, 3)), np.zeros((0, 6)))


def test_nothing_is_known_before_the_first_frame():
    found = RunStatistics()
    assert found.rates(100.0) == {"rate_hz": None, "nominal_rate_hz": 100.0, "starts": 0}
    assert found.latencies(recent=True)["latency_ms_median"] is None


def test_the_rate_is_that_of_processed_frames():
    found = RunStatistics()
    assert found.taken(ready(0, 10.0)) is None
    assert found.taken(ready(4, 12.0)).number == 0
    found.processed = 5
    assert found.rates(100.0)["rate_hz"] == pytest.approx(2.0)


def test_recent_latencies_while_it_runs_and_all_at_the_end():
    found = RunStatistics()
    for _ in range(RECENT_FRAMES):
        found.answered(0.001, at_start=False)
    for _ in range(RECENT_FRAMES):
        found.answered(0.003, at_start=False)
    found.answered(0.5, at_start=True)
    assert found.latencies(recent=True)["latency_ms_median"] == pytest.approx(3.0)
    assert found.latencies(recent=False)["latency_ms_median"] == pytest.approx(2.0)
    assert found.latencies(recent=False)["frames_at_start"] == 1
