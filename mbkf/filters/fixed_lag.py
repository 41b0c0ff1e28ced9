"""Smoothing in windows: a window is smoothed when the frames just after it are in.

The information of later readings fades within a few tenths of a second, so a window that looks ``ahead_s`` beyond its
end is smoothed as well as by the whole trial, and memory does not grow with the trial. A window that smoothing makes
implausible keeps the filtered estimates.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbkf.filters.estimate import Posterior
from mbkf.filters.plausibility import smoothed_or_filtered
from mbkf.filters.tracking_filter import TrackingFilter


@dataclass(frozen=True)
class SmoothingSettings:
    """Lengths of a smoother's windows.

    Attributes:
        window_s: Length of a window that is smoothed at once, at least.
        ahead_s: Time beyond its end whose readings are used, too.
        frames: Frames of both together, at least: as many as at 200 Hz. Frames beyond a window's end are worked through
            again in the next one, 12 % of all at 100 Hz; with 1.5 s alone they were 27 %.
    """

    window_s: float = 1.5
    ahead_s: float = 0.4
    frames: int = 380


class FixedLagSmoother:
    """Takes estimates frame by frame and gives smoothed ones back as soon as they are due.

    A window begins with the last frame of the one before, so that differences over time have both their ends. It is the
    filter's own estimate, marked as ``uncorrected`` where its window failed.

    Attributes:
        filter: The filter.
    """

    def __init__(self, filter: TrackingFilter, settings: SmoothingSettings) -> None:
        """Makes a smoother of a filter's estimates."""
        self.filter = filter
        self._ahead = max(1, round(settings.ahead_s / filter.dt_s))
        self._window = max(1, round(settings.window_s / filter.dt_s), settings.frames - self._ahead)
        self._run: list[Posterior] = []
        self._first = 0
        self._given = 0

    @property
    def earliest(self) -> int:
        """The first frame whose estimate still waits; it may be given again, as a start."""
        return self._first + self._given

    def push(self, t: int, estimate: Posterior) -> list[tuple[int, Posterior]]:
        """Frame t's estimate in, smoothed earlier ones out; a restart ends the run before it.

        A start at a frame that is known takes the place of the frames from there on.
        """
        if estimate.started:
            del self._run[max(t - self._first, 0) :]
        done = self.finish() if estimate.started else []
        if not self._run:
            self._first = t
        self._run.append(estimate)
        if len(self._run) == self._given + self._window + self._ahead:
            done += self._smooth(self._window)
        return done

    def finish(self) -> list[tuple[int, Posterior]]:
        """The estimates that still wait, when no more frames follow."""
        left = len(self._run) - self._given
        done = self._smooth(left) if left else []
        self._run, self._given = [], 0
        return done

    def _smooth(self, wanted: int) -> list[tuple[int, Posterior]]:
        until = self._given + wanted
        smoothed = smoothed_or_filtered(
            self._run[:until], lambda: self.filter.smooth(self._run, until), self.filter.model
        )
        done = list(enumerate(smoothed, start=self._first))[self._given :]
        self._run, self._given = self._run[until - 1 :], 1
        if smoothed[-1].uncorrected:
            self._run[0] = smoothed[-1]
        self._first += until - 1
        return done
