"""Watch over the rate of frames, which gives the stream's numbers their meaning in time."""

from __future__ import annotations

WINDOW_S, LEAST_FRAMES = 0.75, 10
"""The rate is measured over this time at least, and so many frames."""

TOLERANCE = 0.1
"""A rate that is off by this share in two windows in a row, the same way and alike, is another rate."""


class RateWatch:
    """Measures the rate of frames until it is found to be another one."""

    def __init__(self, nominal_hz: float) -> None:
        """Args: the rate that the stream states, Hz."""
        self._nominal_hz = nominal_hz
        self._begin: tuple[float, int] | None = None
        self._arrived, self._least_step = 0, 0
        self._latest: int | None = None
        self._before: float | None = None

    def arrived(self, arrival_s: float, number: int | None) -> float | None:
        """The measured rate, Hz, once it differs from the stated one; otherwise None.

        ``number`` is the number of the frame that arrived, None for a frame without one (late, or twice).
        """
        if number is not None:
            if self._latest is not None and number - self._latest > 0:
                step = number - self._latest
                self._least_step = min(self._least_step or step, step)
            self._latest = number
        if self._latest is None:
            return None
        if self._begin is None:
            self._begin = (arrival_s, self._latest)
            return None
        self._arrived += 1
        passed = arrival_s - self._begin[0]
        if passed < WINDOW_S or self._arrived < LEAST_FRAMES:
            return None
        measured = self._rate(self._arrived / passed, (self._latest - self._begin[1]) / passed)
        self._begin, self._arrived, self._least_step = (arrival_s, self._latest), 0, 0
        before, self._before = self._before, measured
        if before is None or measured is None or abs(measured / before - 1.0) > TOLERANCE:
            return None
        return 0.5 * (before + measured)

    def _rate(self, arrival_hz: float, count_hz: float) -> float | None:
        """The rate in a window where it is another one than stated, None where it is that.

        Frames that are missing irregularly were lost. Where time stamps number the frames, these keep the stated rate:
        frames that come too often share their numbers, and those that come too seldom leave out some every time.
        """
        if count_hz == 0.0:  # all frames came late, or twice
            return None
        if abs(count_hz / self._nominal_hz - 1.0) > TOLERANCE:
            return count_hz
        too_often = arrival_hz > (1.0 + TOLERANCE) * self._nominal_hz
        return arrival_hz if too_often or self._least_step >= 2 else None
