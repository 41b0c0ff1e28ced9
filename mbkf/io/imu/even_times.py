"""Times of samples from stamps that a logger rounded, or gave to whole packets.

A sensor samples at a steady rate; a logger writes stamps in whole milliseconds, or one stamp for all samples that a
packet brought. Such stamps are scattered about a line through all of them. Where samples are lost, the stamps after
the gap stay later than the line.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.runs import runs

_LEAST_STAMPS = 16
_UNEVEN, _FEW = 0.1, 0.01
"""Steps further than this share from a whole number of usual ones are uneven; fewer than the second share are gaps."""

_LOST_STEPS, _LOST_SHARE_OF_PACKET = 4.0, 0.75
"""In packets, stamps that stay later by so many steps, and by this share of a packet, show lost samples."""

_WINDOW, _LEVEL = 256, 12
_MOST_SCATTER_S = 0.1
"""Stamps further from the line than this, and than two packets, belong to no steady rate."""

_CRISP = 0.2
"""Steps that differ from the usual one by less than this share, in the middle, are rounded; others are scattered."""

_PASSES = 3


def even_times(stamps_s: Array, rate_hz: float | None = None) -> Array:
    """(T,) s: the line through stamps that are rounded or come in packets, with gaps where samples are lost.

    Stamps that are a whole number of steps apart, and those of no steady rate, stay as they are.

    Args:
        stamps_s: (T,) s, as written.
        rate_hz: Sample rate that the caller states; by default that of the line. With it, the rows of stamps that go
            back are counted.
    """
    stamps = np.asarray(stamps_s, dtype=float)
    if len(stamps) < _LEAST_STAMPS or not np.isfinite(stamps).all():
        return stamps
    steps = np.diff(stamps)
    if (steps < 0.0).any():
        return stamps if rate_hz is None else stamps[0] + np.arange(len(stamps)) / rate_hz
    if _whole_steps(steps):
        return stamps
    packet = 1 + max((stop - start for start, stop in runs(steps == 0.0)), default=0)
    step, row = _usual_step(stamps), np.arange(len(stamps), dtype=float)
    for _ in range(_PASSES):
        if not step > 0.0:
            return stamps
        row = np.arange(len(stamps)) + _lost(stamps, step, packet)
        step, first = np.polyfit(row, stamps, 1)
    if np.abs(stamps - first - step * row).max() > max(_MOST_SCATTER_S, 2.0 * packet * step):
        return stamps
    if rate_hz is not None:
        step = 1.0 / rate_hz
        first = float(np.median(stamps - step * row))
    even: Array = first + step * row
    return even


def _whole_steps(steps: Array) -> bool:
    """True for stamps that are whole numbers of usual steps apart, but for a few gaps."""
    if (steps == 0.0).any():
        return False
    ratio = steps / np.median(steps)
    return float((np.abs(ratio - np.round(ratio)) > _UNEVEN).mean()) < _FEW


def _usual_step(stamps: Array) -> float:
    """Time per row, s: the mean of the middle half of steps over many rows, which gaps and packets do not move."""
    width = min(_WINDOW, max(2, len(stamps) // 4))
    slopes = np.sort((stamps[width:] - stamps[:-width]) / width)
    quarter = len(slopes) // 4
    return float(slopes[quarter : len(slopes) - quarter].mean())


def _lost(stamps: Array, step: float, packet: int) -> Array:
    """(T,) number of samples lost before each row."""
    late = stamps - step * np.arange(len(stamps))
    steps = np.diff(stamps)
    jumps = np.flatnonzero(steps > (packet + 0.5) * step)
    crisp = packet == 1 and float(np.median(np.abs(steps - step))) < _CRISP * step
    least = 1.0 if packet == 1 else max(_LOST_STEPS, _LOST_SHARE_OF_PACKET * packet)
    reach = max(_LEVEL, 2 * packet)
    lost = np.zeros(len(stamps))
    for n, k in enumerate(jumps.tolist()):
        first, last = max(0, k - reach + 1), k + 1 + reach
        if crisp:  # each jump is a gap: the levels end at its neighbours
            first = max(first, jumps[n - 1] + 1 if n else 0)
            last = min(last, int(jumps[n + 1]) + 1 if n + 1 < len(jumps) else len(stamps))
        risen = np.median(late[k + 1 : last]) - np.median(late[first : k + 1])
        missing = round(risen / step)
        if missing >= least:
            lost[k + 1 :] += missing
            late[k + 1 :] -= missing * step
    return lost
