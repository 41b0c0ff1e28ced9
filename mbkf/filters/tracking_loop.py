"""A filter's way through a trial, frame by frame: start, steps, and a restart after a loss.

Where a frame shows the body elsewhere than it was predicted (it was moved while it was hidden, or the capture has a
cut), or the estimate is implausible (:mod:`mbkf.filters.plausibility`), the same frame starts anew: a filter would take
a jump for a movement, and its readings would correct the frames before. Where the start is implausible, too, the frame
has no estimate, and the next one starts anew.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.plausibility import plausible
from mbkf.filters.tracking_filter import TrackingFilter


class TrackingLoop:
    """Drives a filter from frame to frame, through a whole trial or a live stream alike.

    Attributes:
        filter: The filter.
        estimate: The latest estimate, None before the first start and after an implausible one.
        again: The latest frame has no answer yet and is to be given again, with those after it.
        implausible: The latest frame has no estimate, since its start was implausible.
    """

    def __init__(self, filter: TrackingFilter) -> None:
        self.filter = filter
        self.estimate: Posterior | None = None
        self.again = self.implausible = False
        self._lost_for = 0
        self._prediction: Prediction | None = None

    @property
    def must_start(self) -> bool:
        """True where the next frame tries a start, which needs the frames after it, too."""
        lost = self._lost_for * self.filter.dt_s > self.filter.restart_after_s
        return self.estimate is None or lost or self.again

    def predict(self) -> Prediction | None:
        """Prediction of the next frame, None where it has to start; the step into that frame goes on from it."""
        if self.estimate is None or self.must_start:
            return None
        if self._prediction is None:
            self._prediction = self.filter.predict(self.estimate)
        return self._prediction

    def advance(self, recording: Recording, t: int) -> Posterior | None:
        """The estimate of frame t, the one after the latest; None as long as no start has succeeded, and ``again``."""
        before, fresh = self.estimate, None
        prediction, self._prediction = self._prediction, None
        starting, self.again = self.must_start, False
        with np.errstate(all="ignore"):  # the result is checked
            if starting:
                fresh = self.filter.start(recording, t, None if before is None else before.q)
            if fresh is None and before is not None:
                fresh = self.filter.step(before, recording, t, prediction)
        astray = fresh is not None and not plausible(fresh, self.filter.model)
        self.implausible = astray and starting
        if self.implausible:
            self.forget()
            return None
        if fresh is not None and not starting and (astray or fresh.lost):
            self.again = True
            return None
        if fresh is not None:
            self.estimate = fresh
            self._lost_for = 0 if fresh.tracked else self._lost_for + 1
        return fresh

    def forget(self) -> None:
        """Drops the estimate; the next frame has to start anew."""
        self.estimate, self._lost_for, self._prediction, self.again = None, 0, None, False


def followed(filter: TrackingFilter, recording: Recording) -> Iterator[tuple[int, Posterior, float]]:
    """The estimates with their frames and computing times, s; frames before the first start have none."""
    loop = TrackingLoop(filter)
    for t in range(len(recording)):
        begin = time.perf_counter()
        fresh = loop.advance(recording, t)
        if loop.again:
            fresh = loop.advance(recording, t)
        if fresh is not None:
            yield t, fresh, time.perf_counter() - begin
