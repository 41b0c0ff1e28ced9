"""Steps of the filters, and all that a frame costs besides: standard deviations, NIS and its record."""

from __future__ import annotations

import numpy as np

from benchmarks.speed.products import Stopwatch, Times, joined
from benchmarks.speed.walks import Walk
from mbkf.errors import InvalidInput
from mbkf.filters.estimate import Posterior, Recording, TrackingFilter
from mbkf.filters.record import FrameRecorder, blank
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
    rounds, frames = [], 0
    with single_threaded():
        while frames < least:
            watch = Stopwatch()
            first, found = _started(tracking, recording)
            for t in range(first + 1, len(recording)):
                watch.frame()
                found = watch.part(STEP, tracking.step, found, recording, t)
                row = blank(recorder.dtype, 1)
                watch.part(RECORD, recorder.step, row, found, 0.0)
                watch.part(NIS, recorder.innovation, row, found)
                spread = watch.part(RECORD, recorder.motion, row, found)
                watch.part(SPREADS, recorder.spread, row, spread)
            rounds.append(watch.times())
            frames += len(rounds[-1].product)
    return joined(rounds)


def kinematic_times(walk: Walk, least: int = LEAST_STEPS) -> Times:
    """The kinematic filter with inverse dynamics behind it."""
    tracking, recording = walk.kinematic()
    balance, wrenches = NewtonEuler(tracking.model), np.zeros(12)
    rounds, frames = [], 0
    with single_threaded():
        while frames < least:
            watch = Stopwatch()
            first, found = _started(tracking, recording)
            for t in range(first + 1, len(recording)):
                watch.frame()
                found = watch.part(STEP, tracking.step, found, recording, t)
                watch.part(INVERSE_DYNAMICS, balance.tau, found.q, found.v, found.a, wrenches)
            rounds.append(watch.times())
            frames += len(rounds[-1].product)
    return joined(rounds)


def _started(tracking: TrackingFilter, recording: Recording) -> tuple[int, Posterior]:
    """The first estimate and its frame."""
    loop = TrackingLoop(tracking)
    for t in range(len(recording)):
        found = loop.advance(recording, t)
        if found is not None:
            return t, found
    raise InvalidInput("the walk does not start")
