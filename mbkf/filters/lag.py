"""Fixed lag: the estimate of every frame waits for the readings of the next few, and then uses them.

One linear backward pass about the filter's own course corrects it (Anderson 1979, chapter 7), with the covariance that
belongs to it, or in a live filter, which has no time for matrix products, without. Unlike windows
(:mod:`mbkf.filters.fixed_lag`), every frame is given equally late and linearised once.
"""

from __future__ import annotations

from collections import deque

from mbkf.filters.estimate import Posterior
from mbkf.filters.plausibility import smoothed_or_filtered
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.numerics.later_frames import LaterFrames


def lag_frames(lag_s: float, dt_s: float) -> int:
    """Number of later frames that lie within a lag."""
    return int(lag_s / dt_s + 1e-6)


class FixedLag:
    """Takes estimates frame by frame and gives each one back when the frames of the lag have followed it.

    Attributes:
        filter: The filter.
        frames: The lag; 0 gives every estimate back at once and unchanged.
    """

    def __init__(self, filter: TrackingFilter, lag_s: float, covariances: bool = True) -> None:
        """Gives nothing back yet.

        Args:
            filter: The filter.
            lag_s: The lag; a remainder of less than a frame does not count.
            covariances: True for covariances of the lagged estimates; else they stay the filter's own, which are
                larger, and a frame costs a fifth.
        """
        self.filter, self.frames = filter, lag_frames(lag_s, filter.dt_s)
        self._waiting: deque[tuple[int, Posterior]] = deque()
        self._later = LaterFrames(covariances)
        self._given: Posterior | None = None

    def push(self, t: int, estimate: Posterior) -> list[tuple[int, Posterior]]:
        """Frame t's estimate in, an earlier one out; a restart, or a contact that opens, gives back all before it."""
        done = self.finish() if estimate.started or estimate.rejoined else []
        if self.frames == 0:
            return [*done, (t, estimate)]
        if self._waiting:
            self._later.append(self.filter.linear_step(self._waiting[-1][1], estimate))
        self._waiting.append((t, estimate))
        if len(self._waiting) > self.frames:
            done.append(self._first())
        return done

    def finish(self) -> list[tuple[int, Posterior]]:
        """The estimates that still wait, when no more frames follow."""
        done = [self._first() for _ in range(len(self._waiting))]
        self._given = None
        return done

    def _first(self) -> tuple[int, Posterior]:
        t, estimate = self._waiting.popleft()
        before = self._given
        (self._given,) = smoothed_or_filtered(
            [estimate],
            lambda: [self.filter.corrected(estimate, self._later.backward(), before)],
            self.filter.model,
        )
        if self._waiting:
            self._later.drop()
        return t, self._given
