"""Samples of several streams, each with stamps of its own, as frames at regular times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array

LATE_S = 0.06
"""A stream whose samples come later than this after a frame's time is left out of the frame: radios repeat lost
samples within some 30 ms."""

BEGIN_S = 1.0
"""A stream that has not begun so long after the first one is not waited for."""

LONGEST_GAP = 3.0
"""Samples that are interpolated across at most, in steps of their stream."""


@dataclass
class _Samples:
    """Samples of a stream that frames still need."""

    sensors: int
    rate_hz: float
    stamps: Array
    values: Array


class SensorGrid:
    """Brings streams together: samples joined by straight lines, those of a faster stream averaged over a frame."""

    def __init__(self, sensors: Sequence[int], rates_hz: Sequence[float], rate_hz: float) -> None:
        """Prepares it.

        Args:
            sensors: Number of sensors of each stream.
            rates_hz: Its rate.
            rate_hz: Rate of the frames.
        """
        self._streams = [
            _Samples(count, rate, np.zeros(0), np.zeros((0, count, 6)))
            for count, rate in zip(sensors, rates_hz, strict=True)
        ]
        self._step, self._next = 1.0 / rate_hz, 0
        self._begin: float | None = None

    def put(self, stream: int, stamps: Array, values: Array) -> None:
        """New samples of a stream; those that are not after its latest one are left out.

        Args:
            stream: Its number.
            stamps: (T,) when they were taken, s.
            values: (T, S, 6) readings.
        """
        own = self._streams[stream]
        latest = own.stamps[-1] if len(own.stamps) else -np.inf
        kept = np.isfinite(stamps) & (stamps > np.fmax.accumulate(np.append(latest, stamps[:-1])))
        own.stamps = np.append(own.stamps, stamps[kept])
        own.values = np.concatenate([own.values, values[kept]])

    def next(self, now: float) -> tuple[int, Array] | None:
        """Number and readings (S, 6) of the next frame; None while its samples are due by the stamps' clock."""
        if self._begin is None and not self._begun(now):
            return None
        assert self._begin is not None
        at = self._begin + self._next * self._step
        latest = [one.stamps[-1] if len(one.stamps) else -np.inf for one in self._streams]
        reach = [at + self._half(one) for one in self._streams]
        if now <= at + 0.5 * self._step + LATE_S and any(a < b for a, b in zip(latest, reach, strict=True)):
            return None
        if max(latest) < at:  # all are silent: their next samples show which frames were lost
            return None
        at = self._after_silence(at)
        number, found = self._next, np.concatenate([self._at(one, at) for one in self._streams])
        self._next += 1
        for one in self._streams:
            old = int(np.searchsorted(one.stamps, at - 1.0))
            one.stamps, one.values = one.stamps[old:], one.values[old:]
        return number, found

    def _after_silence(self, at: float) -> float:
        """Time of the next frame, where one or more follow in which no stream has sent anything."""
        firsts = [one.stamps[one.stamps >= at - 0.5 * self._step][:1] for one in self._streams]
        first = min((float(one[0]) for one in firsts if len(one)), default=at)
        skipped = int((first - at) / self._step)
        self._next += max(0, skipped)
        return at + max(0, skipped) * self._step

    def _begun(self, now: float) -> bool:
        """True once all streams have begun, or the others have waited long enough."""
        firsts = [one.stamps[0] for one in self._streams if len(one.stamps)]
        if not firsts or (len(firsts) < len(self._streams) and now - min(firsts) < BEGIN_S):
            return False
        self._begin = float(max(firsts))
        return True

    def _half(self, one: _Samples) -> float:
        """Time beyond a frame's for which its samples are needed."""
        return 0.5 * self._step if one.rate_hz * self._step > 1.5 else 0.0

    def _at(self, one: _Samples, at: float) -> Array:
        """(S, 6) a stream's readings at a time, NaN in a gap."""
        missing = np.full((one.sensors, 6), np.nan)
        if not len(one.stamps):
            return missing
        half = self._half(one)
        first, last = max(at - half, one.stamps[0]), min(at + half, one.stamps[-1])
        if last - first < half or not one.stamps[0] <= at <= one.stamps[-1]:
            return missing
        inside = slice(*np.searchsorted(one.stamps, [first, last], side="right"))
        neighbours = one.stamps[max(0, inside.start - 1) : inside.stop + 1]
        if len(neighbours) > 1 and np.diff(neighbours).max() > LONGEST_GAP / one.rate_hz:
            return missing
        times = np.concatenate([[first], one.stamps[inside], [last]])
        values = np.concatenate([_joined(one, first)[None], one.values[inside], _joined(one, last)[None]])
        if last == first:
            return np.asarray(values[0])
        return np.asarray(np.trapezoid(values, times, axis=0) / (last - first))


def _joined(one: _Samples, at: float) -> Array:
    """(S, 6) readings at a time between two samples, on the straight line that joins them."""
    right = min(max(1, int(np.searchsorted(one.stamps, at))), len(one.stamps) - 1)
    if right < 1:
        return np.asarray(one.values[0])
    before, after = one.stamps[right - 1 : right + 1]
    share = (at - before) / (after - before)
    # Not a weighted sum of both: a missing reading beside an exact sample would blank it.
    if share in (0.0, 1.0):
        return np.asarray(one.values[right - 1 + int(share)])
    return np.asarray((1.0 - share) * one.values[right - 1] + share * one.values[right])
