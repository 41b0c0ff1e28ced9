"""The latest readings of the plates, averaged over each frame as a whole trial's are.

Readings that a person of the known mass cannot cause are refused as they come, sample by sample. Short gaps are
bridged as soon as a good sample ends them, with the numbers that a whole trial gets; a frame due before stays unread.
"""

from __future__ import annotations

from math import floor

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray, read_only
from mbkf.io.resample import window_of, window_weights
from mbkf.kernel.loading import library
from mbkf.sensors.contact.cleaning import longest_bridge
from mbkf.sensors.contact.possible import Fault, all_possible, impossible, reaches
from mbkf.stream.source import PlateSamples, StreamDescription

KEPT_S = 2.0
"""Readings older than this are forgotten."""

ONE_SAMPLE = np.ones((1, 1))
"""The weight of a sample that is taken alone."""

OUTSIDE = 0.5
"""A frame so many samples outside of the readings has none."""


class PlateBuffer:
    """Keeps the latest samples of all plates.

    Attributes:
        newest: Index of the newest sample, None before the first.
        missing: How many samples between others never came.
        refused: How many readings of single plates were not possible.
    """

    def __init__(self, stream: StreamDescription, mass_kg: float | None = None) -> None:
        """A buffer without readings; ``mass_kg`` is the person's, by which readings are judged, None to accept all."""
        self._count = len(stream.plates)
        self._rate_hz, self._frame_rate_hz = stream.plate_rate_hz, stream.rate_hz
        self._frames_from_s = stream.start_time_s
        self._from_s = stream.plates[0].start_time_s if stream.plates else 0.0
        self._half = 0.5 * self._rate_hz / self._frame_rate_hz
        self._unread = read_only(np.full((self._count, 6), np.nan))
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
        self._last_good = [-1] * self._count
        """Last good sample of each plate, after which a gap could begin; −1 without one."""

    def put(self, samples: PlateSamples) -> PlateSamples:
        """Takes new samples and returns them without those that are not newer, refused ones as NaN."""
        index, wrench = samples.index, samples.wrench
        if not len(index) or not self._count:
            return PlateSamples.none(self._count)
        size, first, last = len(self._values), int(index[0]), int(index[-1])
        if self.newest is not None and first <= self.newest:
            fresh = index > self.newest
            index, wrench = index[fresh], wrench[fresh]
            if not len(index):
                return PlateSamples.none(self._count)
            first = int(index[0])
        count = len(index)
        whole = count == last - first + 1
        if self.newest is None or first - self.newest > size:
            self._values[:] = np.nan
            self._oldest = first
            self._last_good = [-1] * self._count
        elif first > self.newest + 1:
            self._values[np.arange(self.newest + 1, first) % size] = np.nan
        self.missing += last - (first - 1 if self.newest is None else self.newest) - count
        if not whole:
            self._values[np.setdiff1d(np.arange(first, last), index) % size] = np.nan
        judged, good = self._judged(wrench)
        place = first % size
        if whole and place + count <= size:
            self._values[place : place + count] = judged.reshape(count, -1)
        else:
            self._values[index % size] = judged.reshape(count, -1)
        if whole and good is None and self._last_good == [first - 1] * self._count:
            self._last_good = [last] * self._count
        else:
            self._bridge_gaps(index, np.ones(judged.shape[:2], dtype=bool) if good is None else good)
        self.newest = last
        return samples if judged is samples.wrench else PlateSamples(index, judged)

    def _judged(self, wrench: Array) -> tuple[Array, BoolArray | None]:
        """Readings (S, K, 6) with NaN for impossible ones, and (S, K) true for possible ones; None where all are."""
        if self._weight_n is None:
            good = np.asarray(np.isfinite(wrench).all(axis=2))
            return wrench, None if good.all() else good
        if all_possible(wrench, self._weight_n, self._reach_m):
            return wrench, None
        good = impossible(wrench, self._weight_n, self._reach_m) == Fault.NONE
        self.refused += int((~good).sum())
        return np.where(good[:, :, None], wrench, np.nan), good

    def _bridge_gaps(self, index: NDArray[np.int64], good: BoolArray) -> None:
        """Straight lines over short gaps that good samples (S, K) have ended, for each plate."""
        size = len(self._values)
        for k, own in enumerate(good.T):
            known = index[own]
            if self._last_good[k] >= 0:
                known = np.concatenate([[self._last_good[k]], known])
            for before in np.flatnonzero(np.diff(known) > 1).tolist():
                first, last = int(known[before]), int(known[before + 1])
                if last - first - 1 > self._bridge:
                    continue
                gap, ends = np.arange(first + 1, last), np.array([first, last])
                for column in range(6 * k, 6 * k + 6):
                    values = self._values[ends % size, column]
                    self._values[gap % size, column] = np.interp(gap, ends, values)
            if len(known):
                self._last_good[k] = int(known[-1])

    def mean(self, number: int) -> Array:
        """(K, 6) mean force N and moment N m about the world's origin over a frame; NaN where not read."""
        newest = self.newest
        if newest is None:
            return self._unread
        position = self._position(number)
        oldest = max(self._oldest, newest - len(self._values) + 1)
        if not oldest - OUTSIDE <= position <= newest + OUTSIDE:
            return self._unread
        low, high = (min(max(end, oldest), newest) for end in window_of(position, self._half))
        if high - low <= 1e-9:
            return self._weighed(round(min(max(position, oldest), newest)), ONE_SAMPLE, 1.0)
        first = floor(low)
        return self._weighed(first, window_weights(low - first, high - first), high - low)

    def _weighed(self, first: int, weights: Array, width: float) -> Array:
        """(K, 6) mean of samples from a first one on, by weights (n, 1) of sum ``width``, about the world's origin."""
        size, kernel = len(self._values), library()
        if kernel is not None and self._count:
            return kernel.wrench_means(self._values, first % size, weights.ravel(), width, self._origins)
        samples = self._values[np.arange(first, first + len(weights)) % size]
        loads = ((weights * samples).sum(axis=0) / width).reshape(self._count, 6)
        loads[np.isnan(loads.sum(axis=1))] = np.nan
        x, y, z = self._origins.T
        fx, fy, fz = loads[:, :3].T
        loads[:, 3] += y * fz - z * fy
        loads[:, 4] += z * fx - x * fz
        loads[:, 5] += x * fy - y * fx
        return loads

    def _position(self, number: int) -> float:
        """Middle of a frame, in samples."""
        time_s = self._frames_from_s + number / self._frame_rate_hz
        return (time_s - self._from_s) * self._rate_hz
