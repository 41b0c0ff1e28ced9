"""A filter's way through a trial, frame by frame: start, steps, and a restart after a loss."""

from __future__ import annotations

import time
from collections.abc import Iterator

from mbkf.filters.estimate import Estimate, Follower, Foresight, Recording


class Pursuit:
    """Drives a filter from frame to frame, through a whole trial or a live stream alike.

    Attributes:
        follower: The filter.
        estimate: The latest estimate, None before the first start.
    """

    def __init__(self, follower: Follower) -> None:
        self.follower = follower
        self.estimate: Estimate | None = None
        self._lost_for = 0
        self._foresight: Foresight | None = None

    @property
    def must_start(self) -> bool:
        """Whether the next frame tries a start, which looks at the frames after it, too."""
        lost = self._lost_for * self.follower.dt_s > self.follower.restart_after_s
        return self.estimate is None or lost

    def expect(self) -> Foresight | None:
        """What the next frame should show, None where it has to start; the step into that frame goes on from it."""
        if self.estimate is None or self.must_start:
            return None
        if self._foresight is None:
            self._foresight = self.follower.expect(self.estimate)
        return self._foresight

    def advance(self, recording: Recording, t: int) -> Estimate | None:
        """The estimate of frame t, the one after the latest; None as long as no start has succeeded."""
        before, fresh = self.estimate, None
        foresight, self._foresight = self._foresight, None
        if self.must_start:
            fresh = self.follower.start(recording, t, None if before is None else before.q)
        if fresh is None and before is not None:
            fresh = self.follower.step(before, recording, t, foresight)
        if fresh is not None:
            self.estimate = fresh
            self._lost_for = 0 if fresh.tracked else self._lost_for + 1
        return fresh

    def forget(self) -> None:
        """Nothing is known any more; the next frame has to start anew."""
        self.estimate, self._lost_for, self._foresight = None, 0, None


def followed(follower: Follower, recording: Recording) -> Iterator[tuple[int, Estimate, float]]:
    """The estimates with their frames and computing times, s; frames before the first start have none."""
    pursuit = Pursuit(follower)
    for t in range(len(recording)):
        begin = time.perf_counter()
        fresh = pursuit.advance(recording, t)
        if fresh is not None:
            yield t, fresh, time.perf_counter() - begin
