"""Steps of the filters, and all that a frame costs besides: standard deviations, NIS and its record."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.speed.products import Stopwatch, Times, joined
from benchmarks.speed.walks import Walk
from mbkf.errors import InvalidInput
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.record import FrameRecorder, blank
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop
from mbkf.model.newton_euler import NewtonEuler
from mbkf.numerics.threads import single_threaded

LEAST_STEPS = 1200
"""A 99th percentile needs as many; the walk is followed again until there are. Garbage is collected as it falls."""

STEP, NIS, SPREADS, RECORD = "step", "NIS", "standard deviations", "record"
INVERSE_DYNAMICS = "inverse dynamics"


def dynamic_times(walk: Walk, least: int = LEAST_STEPS) -> Times:
    """The dynamic filter frame by frame, as `mbkf reconstruct --causal` runs it."""
    tracking, recording, body = walk.dynamic()
    recorder = FrameRecorder(tracking, recording.markers_m.shape[1], body)

    def record(watch: Stopwatch, found: Posterior) -> None:
        row = blank(recorder.dtype, 1)
        watch.part(RECORD, recorder.step, row, found, 0.0)
        watch.part(NIS, recorder.innovation, row, found)
        spread = watch.part(RECORD, recorder.motion, row, found)
        watch.part(SPREADS, recorder.spread, row, spread)

    return _timed(tracking, recording, record, least)


def kinematic_times(walk: Walk, least: int = LEAST_STEPS) -> Times:
    """The kinematic filter with inverse dynamics behind it."""
    tracking, recording = walk.kinematic()
    balance, wrenches = NewtonEuler(tracking.model), np.zeros(12)

    def solve(watch: Stopwatch, found: Posterior) -> None:
        watch.part(INVERSE_DYNAMICS, balance.tau, found.q, found.v, found.a, wrenches)

    return _timed(tracking, recording, solve, least)


def _timed(
    tracking: TrackingFilter,
    recording: Recording,
    after: Callable[[Stopwatch, Posterior], None],
    least: int,
) -> Times:
    """Follows a walk from its beginning until so many steps are timed.

    Args:
        tracking: The filter.
        recording: What it reads.
        after: What is done with each estimate.
        least: Steps to time.
    """
    rounds: list[Times] = []
    with single_threaded():
        while sum(len(one.product) for one in rounds) < least:
            watch = Stopwatch()
            first, found = _started(tracking, recording)
            for t in range(first + 1, len(recording)):
                watch.frame()
                found = watch.part(STEP, tracking.step, found, recording, t)
                after(watch, found)
            rounds.append(watch.times())
    return joined(rounds)


def _started(tracking: TrackingFilter, recording: Recording) -> tuple[int, Posterior]:
    """The first estimate and its frame."""
    loop = TrackingLoop(tracking)
    for t in range(len(recording)):
        found = loop.advance(recording, t)
        if found is not None:
            return t, found
    raise InvalidInput("the walk does not start")
