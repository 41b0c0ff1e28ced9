"""Frame numbers that never decrease; lost, late and unordered frames are recognised by the source's own count.

A source that restarts counts from zero again, and its count may jump or be unreadable; the number of missing frames
then follows from the time that passed on this computer since the last frame whose count was as expected.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from mbkf.stream.source import LARGEST_COUNT

LATE_S = 0.5
"""A frame that is behind by less than this is late or out of order; more, and the source's count has been set back."""

BACK_FRAMES = 3
"""Length of a row of frames that are behind, each after the other, which shows a count set back, however little."""

SLACK_S = 1.0
"""A count that runs ahead of the time that passed by more than this has jumped."""


def readable(number: int) -> bool:
    """True for a possible count of a source."""
    return -LARGEST_COUNT <= number <= LARGEST_COUNT


@dataclass(frozen=True)
class Numbered:
    """A frame's place.

    Attributes:
        number: Its number here, None for one that comes too late.
        lost: Number of missing frames before it.
        reset: The source's count jumped, so that the number follows from the time that passed.
        backwards: It jumped back.
    """

    number: int | None
    lost: int
    reset: bool = False
    backwards: bool = False


class Numbering:
    """Numbers frames, from the number of the first one on; from 0 where that has none."""

    def __init__(self, rate_hz: float) -> None:
        self._rate_hz = rate_hz
        self._shift: int | None = None
        self._last: int | None = None
        self._last_s = 0.0
        self._trusted, self._trusted_s = 0, 0.0
        self._shift_before: int | None = None
        self._late = 0
        self._behind: list[int] = []

    def place(self, number: int, arrival_s: float) -> Numbered:
        """Place of the next frame, by the source's count and the time of its arrival.

        A count beyond :data:`mbkf.stream.source.LARGEST_COUNT` is not believed.
        """
        known = readable(number)
        if self._last is None:
            self._shift = 0 if known else None
            return self._taken(number if known else 0, arrival_s, 0, not known)
        if not known:
            return self._by_time(None, arrival_s)
        if self._shift is None:
            return self._by_time(number, arrival_s)
        passed = (arrival_s - self._last_s) * self._rate_hz
        if self._is_back(number, passed):
            self._shift, self._shift_before = self._shift_before, None
        assert self._shift is not None
        here = number + self._shift
        if here <= self._last:
            self._late += 1
            if self._late > LATE_S * self._rate_hz:  # it stands still
                return self._by_time(None, arrival_s)
            self._behind.append(number)
            recent = self._behind[-BACK_FRAMES:]
            onward = len(recent) == BACK_FRAMES and all(b > a for a, b in pairwise(recent))
            if self._last - here < LATE_S * self._rate_hz and not onward:
                return Numbered(None, 0)
            return self._by_time(number, arrival_s, backwards=True)
        if here - self._last > passed + SLACK_S * self._rate_hz:
            return self._by_time(number, arrival_s)
        return self._taken(here, arrival_s, here - self._last - 1)

    def _is_back(self, number: int, passed: float) -> bool:
        """True for a count that had jumped and goes on as if it had not: single counts are wrong at times."""
        if self._shift_before is None or self._shift is None or self._last is None:
            return False
        jumped, before = number + self._shift - self._last, number + self._shift_before - self._last
        return jumped != 1 and 1 <= before <= passed + BACK_FRAMES

    def _by_time(self, number: int | None, arrival_s: float, backwards: bool = False) -> Numbered:
        """Place of a frame whose count has jumped, or cannot be read; the count goes on from there."""
        assert self._last is not None
        since = self._trusted + round((arrival_s - self._trusted_s) * self._rate_hz)
        here = max(self._last + 1, since)
        if number is not None:
            self._shift_before, self._shift = self._shift, here - number
        return self._taken(here, arrival_s, here - self._last - 1, True, backwards)

    def _taken(
        self, here: int, arrival_s: float, lost: int, reset: bool = False, backwards: bool = False
    ) -> Numbered:
        if not reset or self._last is None:
            self._late = 0
            self._trusted, self._trusted_s = here, arrival_s
        self._last, self._last_s = here, arrival_s
        self._behind.clear()
        return Numbered(here, lost, reset, backwards)
