"""Innovations against what one frame's are expected to be, by kind of reading: markers, plates, Newton's law, others.

A filter of skin-borne markers weighs readings by a noise R that is wider than one frame's errors, and its P is as wide;
yᵀ(H P Hᵀ + R)⁻¹y is then small by construction and tells nothing. Here each channel of readings (a marker; forces and
moments of plates and of Newton's law) has the spread that its own innovations had before (:mod:`running_spread`):

    y² / σ²(frames before),   σ within a range of what is expected of a reading of that kind

Its mean is one where the spread lies in that range and lasts; components are normalised one by one, so the mean is one
whether they are correlated or not. It is above one where readings err more than anything expected of their kind, and
while they suddenly do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import READING_KINDS, Array
from mbkf.kernel.loading import library
from mbkf.numerics.kalman import Information
from mbkf.numerics.running_spread import RunningSpread
from mbkf.sensors.block import AnyBlock, Channels, Rows, Statement

MEMORY_S = 0.3
"""Time over which a spread is taken: skin and movement last for about as long."""

LEAST, MOST = 0.1, 3.0
"""Range of a spread over what is expected of it; plates and law, whose loads may change by any amount, have no most."""

EXPECTED_FRAMES = 2.0
"""So many frames the expected spread of a marker counts as."""


class Innovations(NamedTuple):
    """A frame's innovations.

    Attributes:
        squared: (4,) sum of normalised squares by :data:`mbkf.conventions.READING_KINDS`.
        readings: (4,) how many numbers those are.
        markers: (M,) mean of each marker's, NaN where it was not used.
        marker_spread_m: (M,) σ of each marker, per coordinate, m.
    """

    squared: Array
    readings: NDArray[np.int_]
    markers: Array
    marker_spread_m: Array


class InnovationSpreads:
    """The running spreads of all channels of a filter's blocks."""

    def __init__(self, blocks: Sequence[AnyBlock], dt_s: float) -> None:
        """Args: the filter's blocks, and the time between frames."""
        self._forget = 1.0 - math.exp(-dt_s / MEMORY_S)
        self._readers: list[tuple[int, AnyBlock, slice]] = []
        kinds: list[int] = []
        sd: list[Array] = []
        known: list[Array] = []
        self._markers = slice(0)
        for number, block in enumerate(blocks):
            if block.prior:
                continue
            expected, first = block.expected_spread(), len(kinds)
            sd.append(np.ones(block.quantities) if expected is None else expected)
            known.append(np.full(len(sd[-1]), expected is not None))
            kinds += len(sd[-1]) * [READING_KINDS.index(block.kind)]
            self._readers.append((number, block, slice(first, len(kinds))))
            if block.kind == "markers":
                self._markers = slice(first, len(kinds))
        self._kinds = np.array(kinds, dtype=np.int32)
        self._of_kind = np.equal.outer(kinds, np.arange(len(READING_KINDS))).astype(float)
        spread, is_known = (np.concatenate([np.zeros(0), *parts]) for parts in (sd, known))
        self._first = RunningSpread(spread**2, EXPECTED_FRAMES * is_known)
        self._least = (LEAST * spread) ** 2
        self._most = np.where(is_known > 0.0, (MOST * spread) ** 2, np.inf)

    def begin(self) -> RunningSpread:
        """Before the first frame: what blocks expect of a reading, or nothing."""
        return self._first

    def read(self, chosen: Sequence[object], said: Sequence[Statement]) -> Channels:
        """A frame's readings by channel.

        Args:
            chosen: What the blocks decided.
            said: What they said.
        """
        mean_square, readings, kernel = np.zeros(len(self._kinds)), np.zeros(len(self._kinds)), library()
        for k, block, own in self._readers:
            read, one = block.channels(chosen[k]), said[k]
            if read is None and isinstance(one, Rows) and kernel is not None:
                whitened, count = np.ascontiguousarray(one.innovation, dtype=float), own.stop - own.start
                kernel.square_channels(whitened, one.readings, own.start, count, mean_square, readings)
                continue
            if read is None and one is not None:
                read = _whitened(one, own.stop - own.start)
            if read is not None:
                mean_square[own], readings[own] = read
        return Channels(mean_square, readings)

    def judged(self, before: RunningSpread, read: Channels) -> tuple[Innovations, RunningSpread]:
        """:meth:`innovations` and :meth:`after` together, by the compiled kernel where there is one."""
        kernel = library()
        if kernel is None:
            return self.innovations(before, read), self.after(before, read)
        own, kinds = self._markers, len(READING_KINDS)
        squared, counted, ratio, variance, *after = kernel.judge_innovations(
            kinds,
            read.mean_square,
            read.readings,
            *before,
            self._least,
            self._most,
            self._kinds,
            self._forget,
        )
        found = Innovations(squared, counted.astype(int), ratio[own], np.sqrt(variance[own]))
        return found, RunningSpread(*after)

    def innovations(self, before: RunningSpread, read: Channels) -> Innovations:
        """A frame's readings in units of their spread in the frames before."""
        variance = np.minimum(np.maximum(before.mean_square, self._least), self._most)
        ratio, own = read.mean_square / variance, self._markers
        counted = np.empty((2, len(ratio)))
        np.multiply(read.readings, before.frames > 0.0, out=counted[1])
        np.multiply(ratio, counted[1], out=counted[0])
        squared, readings = counted @ self._of_kind
        markers = ratio[own]
        markers[counted[1, own] == 0.0] = np.nan
        return Innovations(squared, readings.astype(int), markers, np.sqrt(variance[own]))

    def after(self, before: RunningSpread, read: Channels) -> RunningSpread:
        """The spreads that a frame's readings leave for the next."""
        return before.followed(read.mean_square, read.readings > 0, self._forget)


def _whitened(said: Statement, channels: int) -> Channels:
    """The counted readings of whitened rows, which alternate in threes between the channels, or of information.

    Args:
        said: What a block said.
        channels: How many channels it has.
    """
    if isinstance(said, Information):
        first = np.arange(channels) == 0
        return Channels(first * (said.innovation / max(said.readings, 1)), first * said.readings)
    squares, readings = [0.0] * channels, [0] * channels
    for rows in (said,) if isinstance(said, Rows) else said or ():
        for k, y in enumerate(rows.innovation[: rows.readings].tolist()):
            channel = k // 3 % channels
            squares[channel] += y * y
            readings[channel] += 1
    mean_square = [total / max(n, 1) for total, n in zip(squares, readings, strict=True)]
    return Channels(np.array(mean_square), np.array(readings, dtype=float))
