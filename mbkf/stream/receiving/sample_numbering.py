"""Numbers of plate samples that rise whatever their source counts: a count that jumps goes on where it ended.

Where a count jumped, samples are taken to follow the one before; where that contradicts the frames, which are numbered
by the time that passed, the newest sample is taken to belong to the end of its frame.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import BoolArray
from mbkf.stream.receiving.numbering import BACK_FRAMES, LATE_S, SLACK_S
from mbkf.stream.source import LARGEST_COUNT

ALIGNED_S = 0.25
"""Samples that would be farther than this from the end of their frame do not follow the one before."""

FIRST_S = 15.0
"""The first samples of all may be this far from their frame: a network buffer holds some seconds."""

NO_PLACE = -(2**62)
"""Number of a sample that comes late."""

Indices = NDArray[np.int64]


class SampleNumbering:
    """Numbers samples, chunk by chunk.

    Attributes:
        shift: What is added to the source's count.
        jumps: How often the count has jumped.
    """

    def __init__(self, rate_hz: float) -> None:
        """Args: the rate of the samples, Hz."""
        self._rate_hz = rate_hz
        self._slack, self._late = SLACK_S * rate_hz, LATE_S * rate_hz
        self._newest: int | None = None
        self._newest_s, self._lead = 0.0, 0
        self._behind, self._behind_from = 0, 0
        self.shift = self.jumps = 0

    def place(
        self, index: Indices, arrival_s: float, wanted: int, fitting: int | None = None
    ) -> tuple[Indices, BoolArray | None]:
        """Numbers (n,) of the samples that have one, and (S,) true for those; None where all have one.

        Args:
            index: (S,) the source's counts.
            arrival_s: Time of their arrival.
            wanted: Number of the last sample, if the newest belongs to the end of its frame.
            fitting: Shift that the frames' own count suggests, where that jumped; None where it did not.
        """
        counts = index.tolist()
        if not counts:
            return index, None
        passed = (arrival_s - self._newest_s) * self._rate_hz
        if self._follows(counts, passed, wanted):
            self._newest, self._newest_s = counts[-1] + self.shift, arrival_s
            self._behind = 0
            return (index + self.shift if self.shift else index), None
        readable = (index >= -LARGEST_COUNT) & (index <= LARGEST_COUNT)
        numbers = np.zeros(len(index), dtype=np.int64)
        steps = np.diff(index[readable])
        places = np.split(
            np.flatnonzero(readable), np.flatnonzero((steps > self._slack) | (steps <= -self._late)) + 1
        )
        for k, part in enumerate(places):
            if len(part):
                left = sum(len(later) for later in places[k:])
                numbers[part] = self._part(index[part], left, wanted, fitting, passed if k == 0 else 0.0)
                readable[part] = numbers[part] != NO_PLACE
        self._newest_s = arrival_s
        return numbers[readable], readable

    def _follows(self, counts: list[int], passed: float, wanted: int) -> bool:
        """True for samples that follow the newest one, each other, the time that passed, and the frames."""
        if self._newest is None:
            return False
        first, last = counts[0], counts[-1]
        gap = first + self.shift - self._newest - 1
        if not 0 <= gap <= passed + self._slack or self._ahead(last, wanted):
            return False
        if last - first == len(counts) - 1:  # with steps of at least 1 each, all are 1
            return counts == [*range(first, last + 1)]
        return all(1 <= after - before <= self._slack for before, after in pairwise(counts))

    def _ahead(self, last: int, wanted: int) -> bool:
        """True for a sample that is farther ahead of its frame than the first ones were."""
        return last + self.shift - wanted > self._lead + self._slack

    def _part(self, index: Indices, left: int, wanted: int, fitting: int | None, passed: float) -> Indices:
        """Numbers of samples (n,) without a jump between them; late ones get no number.

        ``left`` samples remain from here on, the last of which has the number ``wanted`` by its frame; ``fitting`` is
        the shift that the frames' own count suggests, ``passed`` the number of samples that fit into the time passed.
        """
        first, newest = int(index[0]) + self.shift, self._newest
        if newest is None:
            if abs(int(index[-1]) - wanted) > FIRST_S * self._rate_hz:
                self._jump(wanted - left + 1 - int(index[0]))
            self._lead = max(0, int(index[-1]) + self.shift - wanted)
        else:
            wholly = int(index.max()) + self.shift <= newest
            onward = self._behind > 0 and int(index[0]) > self._behind_from
            self._behind = (self._behind + 1 if onward else 1) if wholly else 0
            self._behind_from = int(index[0])
            far = first - newest - 1 > passed + self._slack or first - newest <= -self._late
            far = far or self._ahead(int(index.max()), wanted)
            if far or self._behind >= BACK_FRAMES or (wholly and fitting is not None):
                self._jump(self._onward(int(index[0]), left, wanted, fitting))
        numbers = index + self.shift
        if self._newest is not None and self._ahead(
            int(numbers.max()) - self.shift, wanted
        ):  # impossible steps
            numbers = self._newest + 1 + np.arange(len(index))
            self._jump(int(numbers[-1]) - int(index[-1]))
        before = np.concatenate([[numbers[0] - 1 if self._newest is None else self._newest], numbers[:-1]])
        late = numbers <= np.maximum.accumulate(before)
        if not late.all():
            self._newest = int(numbers[~late][-1])
        return np.where(late, NO_PLACE, numbers)

    def _onward(self, first: int, left: int, wanted: int, fitting: int | None) -> int:
        """The shift with which samples go on whose count, from the first on, has jumped."""
        assert self._newest is not None
        next_one, aligned = self._newest + 1, ALIGNED_S * self._rate_hz
        fits = fitting is not None and abs(first + fitting + left - 1 - wanted) <= aligned
        if fitting is not None and fits and first + fitting >= next_one:
            return fitting
        if abs(next_one + left - 1 - wanted) <= aligned:
            return next_one - first
        return max(next_one, wanted - left + 1) - first

    def _jump(self, shift: int) -> None:
        self.shift, self._behind = shift, 0
        self.jumps += 1
