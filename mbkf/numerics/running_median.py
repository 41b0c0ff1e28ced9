"""The median of the last numbers of a sequence, kept in order of rank, so that a new number needs no sorting."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Sequence
from math import isnan
from typing import NamedTuple


class RunningMedian(NamedTuple):
    """The last numbers of a sequence.

    Attributes:
        latest: They, the latest last; NaN where there was none.
        ranked: Those that are numbers, in ascending order; never written into.
    """

    latest: tuple[float, ...] = ()
    ranked: Sequence[float] = ()

    def followed(self, value: float, most: int) -> RunningMedian:
        """With the next number, NaN for none, and of at most so many."""
        outgoing, ranked = max(0, len(self.latest) + 1 - most), list(self.ranked)
        for old in self.latest[:outgoing]:
            if not isnan(old):
                del ranked[bisect_left(ranked, old)]
        if not isnan(value):
            insort(ranked, value)
        return RunningMedian((*self.latest[outgoing:], value), ranked)

    def median(self, zeros: int = 0) -> float:
        """Median of the numbers and of so many zeros besides.

        Raises:
            IndexError: There are neither.
        """
        ranked, count = self.ranked, len(self.ranked) + zeros
        negative = bisect_left(ranked, 0.0)

        def at(rank: int) -> float:
            if rank < negative:
                return ranked[rank]
            return 0.0 if rank < negative + zeros else ranked[rank - zeros]

        return 0.5 * (at((count - 1) // 2) + at(count // 2))
