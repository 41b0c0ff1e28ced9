"""Fixed-lag smoothing: a window is smoothed when the frames just after it are in.

The information of later readings fades within a few tenths of a second, so a window that looks ``ahead_s`` beyond its
end is smoothed as well as by the whole trial, and memory does not grow with the trial. Live, the result of a frame is
known at most ``lag_s`` later. A window of which smoothing makes no person keeps the filter's own estimates.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.filters.estimate import Posterior, Recording, TrackingFilter
from mbkf.filters.person import corrected_or_own


@dataclass(frozen=True)
class SmoothingSettings:
    """How far a smoother looks.

    Attributes:
        window_s: Length of a window that is smoothed at once.
        ahead_s: How far beyond its end it looks.
    """

    window_s: float = 1.5
    ahead_s: float = 0.4

    @property
    def lag_s(self) -> float:
        """Longest time after a frame until its smoothed estimate is known (computing time not counted)."""
        return self.window_s + self.ahead_s


class FixedLagSmoother:
    """Takes estimates frame by frame and gives smoothed ones back as soon as they are due.

    A window begins with the last frame of the one before, so that differences over time have both their ends.

    Attributes:
        filter: The filter.
        recording: The readings the estimates came from.
    """

    def __init__(self, filter: TrackingFilter, recording: Recording, settings: SmoothingSettings) -> None:
        """Makes a smoother.

        Args:
            filter: The filter.
            recording: The readings the estimates come from.
            settings: How far the smoother looks.
        """
        self.filter, self.recording = filter, recording
        self._window = max(1, round(settings.window_s / filter.dt_s))
        self._ahead = max(1, round(settings.ahead_s / filter.dt_s))
        self._run: list[Posterior] = []
        self._first = 0
        self._given = 0

    def push(self, t: int, estimate: Posterior) -> list[tuple[int, Posterior]]:
        """Frame t's estimate in, smoothed earlier ones out; a restart ends the run before it."""
        done = self.finish() if estimate.started else []
        if not self._run:
            self._first = t
        self._run.append(estimate)
        if len(self._run) == self._given + self._window + self._ahead:
            done += self._smooth(self._window)
        return done

    def finish(self) -> list[tuple[int, Posterior]]:
        """What is left, when no more frames follow."""
        left = len(self._run) - self._given
        done = self._smooth(left) if left else []
        self._run, self._given = [], 0
        return done

    def _smooth(self, wanted: int) -> list[tuple[int, Posterior]]:
        until = self._given + wanted
        smoothed = corrected_or_own(
            self._run[:until],
            lambda: self.filter.smooth(self._run, self.recording, self._first, until),
            self.filter.model,
        )
        done = list(enumerate(smoothed, start=self._first))[self._given :]
        self._run, self._given = self._run[until - 1 :], 1
        self._first += until - 1
        return done
