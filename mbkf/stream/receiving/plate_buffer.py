"""The latest readings of the plates, averaged over each frame as a whole trial's are.

What a person of the known mass cannot make a plate read is refused as it comes, sample by sample. Short gaps are
bridged as soon as a good sample ends them, with the numbers that a whole trial gets; a frame due before stays unread.
"""

from __future__ import annotations

from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.resample import integrals_between, window_ends
from mbkf.sensors.contact.cleaning import longest_bridge
from mbkf.sensors.contact.possible import Fault, impossible, reaches
from mbkf.stream.source import PlateSamples, StreamDescription

KEPT_S = 2.0
"""Readings older than this are forgotten."""

OUTSIDE = 0.5
"""A frame so many samples outside of what was read has no reading."""


class PlateBuffer:
    """Keeps the latest samples of all plates.

    Attributes:
        newest: Index of the newest sample, None before the first.
        missing: How many samples between others never came.
        refused: How many readings of single plates were not possible.
    """

    def __init__(self, stream: StreamDescription, mass_kg: float | None = None) -> None:
        """A buffer without readings.

        Args:
            stream: The stream's description.
            mass_kg: The person's mass, by which readings are judged; None for not at all.
        """
        self._count = len(stream.plates)
        self._rate_hz, self._frame_rate_hz = stream.plate_rate_hz, stream.rate_hz
        self._frames_from_s = stream.start_time_s
        self._from_s = stream.plates[0].start_time_s if stream.plates else 0.0
        self._half = 0.5 * self._rate_hz / self._frame_rate_hz
        self._origins = np.array([plate.origin_m for plate in stream.plates]).reshape(-1, 3)
        size = int(KEPT_S * self._rate_hz) + 4 * int(self._half + 1)
        self._values = np.full((size, 6 * self._count), np.nan)
        self._oldest = 0
        self.newest: int | None = None
        self.missing = 0
        self.refused = 0
        self._weight_n = None if mass_kg is None else GRAVITY_M_S2 * mass_kg
        self._reach_m = reaches(stream.plates)
        self._bridge = longest_bridge(self._rate_hz)
        self._last_good = np.full(self._count, -1)
        """Of each plate; −1 where there is none that a gap could begin after."""

    def put(self, samples: PlateSamples) -> PlateSamples:
        """Takes new samples; those not newer than what is known are left out of what is returned, refused ones NaN."""
        index, wrench = samples.index, samples.wrench
        if not len(index) or not self._count:
            return PlateSamples.none(self._count)
        if self.newest is not None and index[0] <= self.newest:
            fresh = index > self.newest
            index, wrench = index[fresh], wrench[fresh]
            if not len(index):
                return PlateSamples.none(self._count)
        size = len(self._values)
        if self.newest is None or index[0] - self.newest > size:
            self._values[:] = np.nan
            self._oldest = int(index[0])
            self._last_good[:] = -1
        else:
            self._values[np.arange(self.newest + 1, int(index[0])) % size] = np.nan
        expected = index[-1] - (index[0] - 1 if self.newest is None else self.newest)
        self.missing += int(expected) - len(index)
        if len(index) <= index[-1] - index[0]:
            self._values[np.setdiff1d(np.arange(index[0], index[-1]), index) % size] = np.nan
        wrench, good = self._judged(wrench)
        self._values[index % size] = wrench.reshape(len(index), -1)
        self._bridge_gaps(index, good)
        self.newest = int(index[-1])
        return PlateSamples(index, wrench)

    def _judged(self, wrench: Array) -> tuple[Array, BoolArray]:
        """Readings (S, K, 6) with NaN for those that are not possible, and which (S, K) are."""
        if self._weight_n is None:
            return wrench, np.asarray(np.isfinite(wrench).all(axis=2))
        good = impossible(wrench, self._weight_n, self._reach_m) == Fault.NONE
        if good.all():
            return wrench, good
        self.refused += int((~good).sum())
        return np.where(good[:, :, None], wrench, np.nan), good

    def _bridge_gaps(self, index: NDArray[np.int64], good: BoolArray) -> None:
        """Straight lines over short gaps that good samples (S, K) have ended, for each plate."""
        whole = len(index) == index[-1] - index[0] + 1
        if whole and good.all() and (self._last_good == index[0] - 1).all():
            self._last_good[:] = index[-1]
            return
        size = len(self._values)
        for k, own in enumerate(good.T):
            known = index[own]
            if self._last_good[k] >= 0:
                known = np.concatenate([self._last_good[k : k + 1], known])
            for before in np.flatnonzero(np.diff(known) > 1).tolist():
                first, last = int(known[before]), int(known[before + 1])
                if last - first - 1 > self._bridge:
                    continue
                gap, ends = np.arange(first + 1, last), np.array([first, last])
                for column in range(6 * k, 6 * k + 6):
                    values = self._values[ends % size, column]
                    self._values[gap % size, column] = np.interp(gap, ends, values)
            if len(known):
                self._last_good[k] = known[-1]

    def mean(self, number: int) -> Array:
        """(K, 6) mean force N and moment N m about the world's origin over a frame; NaN where not read."""
        unread = np.full((self._count, 6), np.nan)
        if self.newest is None:
            return unread
        position = self._position(number)
        oldest = max(self._oldest, self.newest - len(self._values) + 1)
        if not oldest - OUTSIDE <= position <= self.newest + OUTSIDE:
            return unread
        ends = np.concatenate(window_ends(np.array([position]), self._half))
        low, high = (min(max(end, oldest), self.newest) for end in ends.tolist())
        first = floor(low)
        rows = np.arange(first, ceil(high) + 1)
        samples = self._values[rows % len(self._values)]
        if high - low > 1e-9:
            area = integrals_between(
                samples, np.array([low - first]), np.array([high - first]), 2.0 * self._half
            )
            loads = (area / (high - low)).reshape(self._count, 6)
        else:
            loads = samples[round(min(max(position, oldest), self.newest)) - first].reshape(self._count, 6)
        loads[np.isnan(loads).any(axis=1)] = np.nan
        x, y, z = self._origins.T
        fx, fy, fz = loads[:, :3].T
        loads[:, 3] += y * fz - z * fy
        loads[:, 4] += z * fx - x * fz
        loads[:, 5] += x * fy - y * fx
        return loads

    def _position(self, number: int) -> float:
        """Where the middle of a frame lies, in samples."""
        time_s = self._frames_from_s + number / self._frame_rate_hz
        return (time_s - self._from_s) * self._rate_hz
