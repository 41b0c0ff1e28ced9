"""A filter's way through a trial, frame by frame: start, steps, and a restart after a loss."""

from __future__ import annotations

import time
from collections.abc import Iterator

from mbkf.filters.estimate import Estimate, Follower, Recording


def followed(follower: Follower, recording: Recording) -> Iterator[tuple[int, Estimate, float]]:
    """The estimates with their frames and computing times, s; frames before the first start have none."""
    estimate: Estimate | None = None
    lost_for = 0
    for t in range(len(recording)):
        begin = time.perf_counter()
        lost = lost_for * recording.dt_s > follower.restart_after_s
        fresh = None
        if estimate is None or lost:
            fresh = follower.start(recording, t, None if estimate is None else estimate.q)
        if fresh is None and estimate is not None:
            fresh = follower.step(estimate, recording, t)
        if fresh is not None:
            estimate = fresh
            lost_for = 0 if fresh.tracked else lost_for + 1
            yield t, fresh, time.perf_counter() - begin
