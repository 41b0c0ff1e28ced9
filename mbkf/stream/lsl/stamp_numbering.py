"""Numbers of frames that carry none: their order of arrival, with gaps where time stamps prove them.

Frames of one stream arrive in the order in which they were sent, so each follows the one before. A sender that stamps
frames when it sends them is late by a few frames now and then; its next stamps return to the line of those before. A
sender that left out frames does not return. So a frame whose stamp is later than stamps have varied so far waits for a
few that follow: all of them late by whole frames are a gap, any other stamps are jitter.

liblsl's own smoothing (``proc_dejitter``) assumes that no frame is missing: after a gap of 0.5 s its stamps are 0.5 s
early, and 0.12 s late five seconds after it. It is therefore not applied here.
"""

from __future__ import annotations

import math
from bisect import bisect_left, insort
from collections import deque
from typing import Generic, TypeVar

WINDOW_S = 2.0
"""Stamps are compared with those of the latest frames, over this time."""

SETTLED = 10
"""The first frames wait until so many are there, which show how much stamps vary."""

CONFIRMED = 5
"""So many frames have to follow a gap, all as late as it is."""

LATE, FITTING = 0.5, 0.3
"""A stamp later by more than LATE of a frame begins a gap; those that prove it fit whole frames within FITTING."""

WIDER = 1.5
"""Stamps after one gap may vary this many times as much as they usually do: few frames, and the gap is rounded."""

AHEAD_S, BACK_S = 1.0, 0.5
"""Stamps that run ahead of the time that passed here, or go back, by more than this are those of another clock."""

SILENT_S = 0.25
"""After a jump of the stamps, frames are missing for the time without frames, where that was longer than this."""

Item = TypeVar("Item")

OUTER = 0.05
"""Share of the latest stamps, at either end, that is not counted as their usual variation."""


class StampNumbering:
    """Numbers frames from 0 on by order of arrival and time stamps.

    Attributes:
        jumps: Number of times that the stamps have jumped to another clock.
    """

    def __init__(self, rate_hz: float, group: int = 1, origin_s: float | None = None) -> None:
        """A numbering that has seen no frame.

        Args:
            rate_hz: Rate of the frames, or of samples of plates.
            group: Number of samples that are sent together; a gap is at least half as long.
            origin_s: Stamp of number 0; None for that of the first frame, which is corrected by those that follow.
        """
        self._rate_hz, self._group = rate_hz, float(group)
        self._origin_s, self._fixed = origin_s, origin_s is not None
        self._lateness = _Lateness(max(SETTLED, round(WINDOW_S * rate_hz)))
        self._held: list[float] = []
        self._last: int | None = None
        self._newest: tuple[float, float] | None = None
        self.jumps = 0

    @property
    def waiting(self) -> int:
        """Number of frames without a number yet."""
        return len(self._held)

    @property
    def late_s(self) -> float:
        """Median time by which stamps are behind the line of their numbers."""
        return self._lateness.middle / self._rate_hz

    @property
    def origin_s(self) -> float | None:
        """Stamp of number 0; None before the first frame."""
        return None if self._origin_s is None else self._origin_s + self.late_s

    def put(self, stamp_s: float, arrival_s: float) -> list[int]:
        """Takes the next frame; returns numbers of the oldest frames that wait, in order, as far as they are known.

        Args:
            stamp_s: Its time stamp; one that is not finite tells nothing.
            arrival_s: Time of its arrival here, s.
        """
        if not math.isfinite(stamp_s):
            return [*self.flush(), *self._numbered([(math.nan, self._next)])]
        if self._origin_s is None:
            self._origin_s = stamp_s
        place = (stamp_s - self._origin_s) * self._rate_hz
        before, self._newest = self._newest, (stamp_s, arrival_s)
        if before is not None and self._jumped(stamp_s - before[0], arrival_s - before[1]):
            return [*self.flush(), *self._anew(stamp_s, arrival_s - before[1])]
        self._held.append(place)
        if self._last is None:
            return self._settle() if len(self._held) >= SETTLED * self._group else []
        if not self._all_late():
            return self._in_order()
        return self._by_stamps() if len(self._held) > CONFIRMED * self._group else []

    def flush(self) -> list[int]:
        """Numbers of all frames that wait, since no more follow for now."""
        if not self._held:
            return []
        if self._last is None:
            return self._settle()
        return self._by_stamps()

    def shift(self, count: int) -> None:
        """Counts all frames from the next one on by so many higher."""
        if self._last is not None and self._origin_s is not None:
            self._last += count
            self._origin_s -= count / self._rate_hz
            self._held = [place + count for place in self._held]

    @property
    def _next(self) -> int:
        return 0 if self._last is None else self._last + 1

    def _jumped(self, step_s: float, passed_s: float) -> bool:
        return step_s > passed_s + AHEAD_S or step_s < -BACK_S

    def _anew(self, stamp_s: float, passed_s: float) -> list[int]:
        """The number of the first frame of another clock."""
        self.jumps += 1
        missing = max(0, round(passed_s * self._rate_hz) - 1) if passed_s > SILENT_S else 0
        number = self._next + missing
        self._origin_s = stamp_s - (number + self._lateness.middle) / self._rate_hz
        return self._numbered([(number + self._lateness.middle, number)])

    def _settle(self) -> list[int]:
        """Numbers of the first frames of all: by their stamps if these step by whole frames, else in order."""
        line = sorted(place - k for k, place in enumerate(self._held))
        self._last = round(line[len(line) // 2]) - 1 if self._fixed else -1
        found = self._by_stamps()
        if not self._fixed and self._origin_s is not None:
            self._origin_s += self._lateness.middle / self._rate_hz
            self._lateness.move(-self._lateness.middle)
        return found

    def _all_late(self) -> bool:
        """True where each waiting frame, if it followed the one before, would be later than stamps usually are."""
        high = self._lateness.high
        late = [place - self._next - k for k, place in enumerate(self._held)]
        return late[0] > high + LATE * self._group and min(late) > high + FITTING * self._group

    def _by_stamps(self) -> list[int]:
        """Numbers of the waiting frames with the gaps that their stamps show; in order where these show jitter."""
        numbers = self._single_gaps() or self._one_gap()
        if numbers is None:
            return self._in_order()
        return self._numbered(list(zip(self._held, numbers, strict=True)))

    def _single_gaps(self) -> list[int] | None:
        """A gap before any of the waiting frames; None where stamps vary too much to tell."""
        middle, spread = self._lateness.middle, self._lateness.high - self._lateness.low
        if self._group > 1.0 or spread >= 1.0:
            return None
        numbers, last = [], self._next - 1
        for place in self._held:
            last = max(last + 1, round(place - middle))
            if abs(place - middle - last) > 0.5 * spread + FITTING:
                return None
            numbers.append(last)
        return numbers

    def _one_gap(self) -> list[int] | None:
        """One gap before the first of the waiting frames; None where they do not vary about one line as before."""
        middle, spread = self._lateness.middle, self._lateness.high - self._lateness.low
        late = [place - middle - self._next - k for k, place in enumerate(self._held)]
        gap = max(0, round(sorted(late)[len(late) // 2]))
        if max(abs(one - gap) for one in late) > WIDER * spread + FITTING * self._group:
            return None
        return [self._next + gap + k for k in range(len(late))]

    def _in_order(self) -> list[int]:
        return self._numbered([(place, self._next + k) for k, place in enumerate(self._held)])

    def _numbered(self, found: list[tuple[float, int]]) -> list[int]:
        for place, number in found:
            if not math.isnan(place):
                self._lateness.put(place - number)
            self._last = number
        self._held = []
        return [number for _, number in found]


class StampedItems(Generic[Item]):
    """Frames or samples, each with its number as soon as that is known.

    Attributes:
        numbering: Gives the numbers.
    """

    def __init__(self, numbering: StampNumbering) -> None:
        self.numbering = numbering
        self._waiting: deque[Item] = deque()

    def put(self, item: Item, stamp_s: float, arrival_s: float) -> list[tuple[int, Item]]:
        """Takes the next item; returns the oldest ones, as far as their numbers are known.

        Args:
            item: The frame or sample.
            stamp_s: Its time stamp.
            arrival_s: Time of its arrival here, s.
        """
        self._waiting.append(item)
        return self._given(self.numbering.put(stamp_s, arrival_s))

    def flush(self) -> list[tuple[int, Item]]:
        """All items that wait, with numbers, since no more follow for now."""
        return self._given(self.numbering.flush())

    def _given(self, numbers: list[int]) -> list[tuple[int, Item]]:
        return [(number, self._waiting.popleft()) for number in numbers]


class _Lateness:
    """The latest differences between stamps and numbers, in frames: their usual range and median."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._latest: deque[float] = deque()
        self._sorted: list[float] = []

    def put(self, late: float) -> None:
        if len(self._latest) >= self._size:
            del self._sorted[bisect_left(self._sorted, self._latest.popleft())]
        self._latest.append(late)
        insort(self._sorted, late)

    def move(self, by: float) -> None:
        self._latest = deque(late + by for late in self._latest)
        self._sorted = sorted(self._latest)

    @property
    def low(self) -> float:
        return self._at(OUTER)

    @property
    def middle(self) -> float:
        return self._at(0.5)

    @property
    def high(self) -> float:
        """At least that of the latest frame: a sender that is slower than it states is ever later."""
        return max(self._at(1.0 - OUTER), self._latest[-1]) if self._latest else 0.0

    def _at(self, share: float) -> float:
        return self._sorted[round(share * (len(self._sorted) - 1))] if self._sorted else 0.0
