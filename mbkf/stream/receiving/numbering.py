"""Frame numbers that never decrease; lost, late and unordered frames are recognised by the source's own count.

A source that restarts counts from zero again, and its count may jump; the number of missing frames then follows from
the time that passed on this computer. A count that no source can have reached is no count: that frame follows the one
before.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from mbkf.stream.source import LARGEST_COUNT

LATE_S = 0.5
"""A frame that is behind by less than this is late or out of order; more, and the source's count has been set back."""

BACK_FRAMES = 3
"""So many frames in a row that are behind, each after the other, are a count set back, however little."""

SLACK_S = 1.0
"""A count that runs ahead of the time that passed by more than this has jumped."""


@dataclass(frozen=True)
class Numbered:
    """A frame's place.

    Attributes:
        number: Its number here, None for one that comes too late.
        lost: How many frames are missing before it.
        reset: Whether the source's count jumped, so that the number follows from the time that passed.
        backwards: Whether it jumped back.
        uncounted: Whether the source's count was impossible.
    """

    number: int | None
    lost: int
    reset: bool = False
    backwards: bool = False
    uncounted: bool = False


class Numbering:
    """Numbers frames, from the number of the first one on."""

    def __init__(self, rate_hz: float) -> None:
        self._rate_hz = rate_hz
        self._shift = 0
        self._last: int | None = None
        self._last_s = 0.0
        self._behind: list[int] = []

    def place(self, number: int, arrival_s: float) -> Numbered:
        """Place of the next frame.

        Args:
            number: As the source counts.
            arrival_s: When it arrived.
        """
        if abs(number) > LARGEST_COUNT:
            return self._following(arrival_s)
        if self._last is None:
            self._last, self._last_s = number, arrival_s
            return Numbered(number, 0)
        here, backwards = number + self._shift, False
        passed = (arrival_s - self._last_s) * self._rate_hz
        reset = here - self._last > passed + SLACK_S * self._rate_hz
        if here <= self._last:
            self._behind.append(number)
            recent = self._behind[-BACK_FRAMES:]
            onward = len(recent) == BACK_FRAMES and all(b > a for a, b in pairwise(recent))
            if self._last - here < LATE_S * self._rate_hz and not onward:
                return Numbered(None, 0)
            reset = backwards = True
        if reset:
            here = self._last + max(1, round(passed))
            self._shift = here - number
        self._behind.clear()
        lost = here - self._last - 1
        self._last, self._last_s = here, arrival_s
        return Numbered(here, lost, reset, backwards)

    def _following(self, arrival_s: float) -> Numbered:
        """The place after the frame before, or after as many as the time that passed tells."""
        if self._last is None:
            self._last, self._last_s = 0, arrival_s
            return Numbered(0, 0, uncounted=True)
        passed = (arrival_s - self._last_s) * self._rate_hz
        lost = round(passed) - 1 if passed > SLACK_S * self._rate_hz else 0
        self._last, self._last_s = self._last + 1 + lost, arrival_s
        return Numbered(self._last, lost, uncounted=True)
