"""Contacts of other parts than the feet while a live run goes on: stretches in which a part bears load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.contacts import INSTANT_S, ContactInterval, Source, bearing
from mbkf.numerics.runs import runs

MOST = 100
"""Number of stretches that are kept; of further ones the largest load counts for the last."""


@dataclass
class _Stretch:
    """Frames in which a part bears load.

    Attributes:
        part: Its place among the parts.
        first, last: First and last frame.
        peak_n: Largest size of its force.
    """

    part: int
    first: int
    last: int
    peak_n: float


class RunningContacts:
    """Takes blocks of frames in order."""

    def __init__(self, parts: tuple[str, ...], rate_hz: float) -> None:
        """No contact yet.

        Args:
            parts: (B,) parts that may bear load besides the feet.
            rate_hz: Frame rate.
        """
        self._parts, self._rate_hz = parts, rate_hz
        self._instant = INSTANT_S * rate_hz
        self._stretches: list[_Stretch] = []

    def add(self, first: int, support: Array) -> None:
        """Adds a block of frames.

        Args:
            first: Number of its first frame.
            support: (n, B, 6) wrench on each part, NaN or zero where it bears nothing.
        """
        bears = bearing(support)
        if not bears.any():
            return
        size = np.nan_to_num(np.linalg.norm(support[..., :3], axis=2))
        for part in map(int, np.flatnonzero(bears.any(axis=0))):
            for begin, end in runs(bears[:, part]):
                self._extend(part, first + begin, first + end - 1, float(size[begin:end, part].max()))

    def intervals(self) -> tuple[ContactInterval, ...]:
        """The stretches so far that last longer than an instant, in order of time."""
        how = Source.ESTIMATED.name.lower()
        return tuple(
            ContactInterval(
                self._parts[one.part],
                one.first / self._rate_hz,
                one.last / self._rate_hz,
                one.peak_n,
                float("nan"),
                how,
            )
            for one in self._stretches
            if one.last - one.first + 1 >= self._instant
        )

    def _extend(self, part: int, first: int, last: int, peak_n: float) -> None:
        """Prolongs the part's last stretch over a short gap, or begins a new one."""
        before = next((one for one in reversed(self._stretches) if one.part == part), None)
        joins = before is not None and first - before.last - 1 < self._instant
        if before is not None and (joins or len(self._stretches) >= MOST):
            before.last, before.peak_n = last, max(before.peak_n, peak_n)
        elif len(self._stretches) < MOST:
            self._stretches.append(_Stretch(part, first, last, peak_n))
