"""Layout of a NatNet stream's frames by its description: markers, points without names, plates; world axes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.errors import InvalidInput
from mbkf.io.plate_corners import has_area
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.stream.natnet import packets
from mbkf.stream.natnet.descriptions import Descriptions, MarkerSet
from mbkf.stream.natnet.frames import Frame
from mbkf.stream.natnet.packets import ForcePlate
from mbkf.stream.natnet.player import axes_of
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription, empty_plate

WHOLE_RATE = 2e-3
"""A rate nearer than this share to a whole number is that number."""

EVERYTHING = "all"
"""Motive's set of all markers; it repeats the others."""

NO_POINTS = read_only(np.zeros((0, 3)))
"""The points without names of a frame that has none."""


class StreamLayout:
    """Turns a stream's frames into those of a :class:`mbkf.stream.source.FrameSource`.

    Attributes:
        stream: The stream's description.
    """

    def __init__(self, described: Descriptions, frames: Sequence[Frame], rotation: Array) -> None:
        """The layout of a stream.

        Args:
            described: Its marker sets and plates.
            frames: Its first frames, at least two, whose time stamps give the rate.
            rotation: (3, 3) from the stream's axes to the world's.

        Raises:
            InvalidInput: The time stamps give no rate, or plates send raw voltages.
        """
        self._rotation = rotation
        self._sets: list[MarkerSet] = [s for s in described.sets if s.name.lower() != EVERYTHING]
        names = [name for one in self._sets for name in one.markers]
        rate_hz = _rate(frames)
        self._samples = max((samples.shape[1] for samples in frames[0].plates.samples), default=1)
        with np.errstate(invalid="ignore", over="ignore"):
            plates = [self._plate(plate, rate_hz * self._samples) for plate in described.plates]
        axes = [axes_of(plate.corners_m) for plate in plates]
        self._plate_axes = np.array(axes).reshape(-1, 1, 3, 3)
        self._plate_numbers = [plate.number for plate in described.plates]
        trial = self._sets[0].name if self._sets else "natnet"
        self.stream = StreamDescription(trial, tuple(names), rate_hz, 0.0, tuple(plates))

    def frame(self, frame: Frame, arrival_s: float) -> SourceFrame:
        """One frame in the world's axes; its samples of the plates are numbered from its own number on."""
        with np.errstate(invalid="ignore"):  # numbers of a server may be NaN
            markers, points = self._points(frame)
            return SourceFrame(frame.number, arrival_s, markers, points, self._plates(frame))

    def _plate(self, plate: ForcePlate, rate_hz: float) -> PlateReadings:
        if plate.raw or len(plate.channels) < len(packets.CHANNELS):
            raise InvalidInput(
                f"NatNet: force plate {plate.serial} sends raw voltages; let Motive stream calibrated forces"
            )
        corners = plate.corners_m @ self._rotation.T
        origin = corners.mean(axis=0) + axes_of(corners) @ plate.offset_m
        known = corners if has_area(corners) else None
        name = plate.serial or str(plate.number)
        return empty_plate(name, rate_hz, 0.0, origin, DEFAULT_COP_THRESHOLD_N, known)

    def _points(self, frame: Frame) -> tuple[Array, Array]:
        """(M, 3) named markers and (N, 3) points; positions that Motive only filled in count as missing."""
        rows = [_rows(frame.sets.get(one.name), len(one.markers)) for one in self._sets]
        found = rows[0] if len(rows) == 1 else np.concatenate([*rows, packets.NO_POINTS])
        flags, points, missing = frame.labelled["flags"], frame.points, _at_nought(found)
        raised = int(np.bitwise_or.reduce(flags))
        if raised & packets.OCCLUDED:
            occluded = frame.labelled["position"][flags & packets.OCCLUDED != 0]
            missing |= _among(found, occluded[~_at_nought(occluded)])
        if raised & packets.UNLABELLED and not len(points):
            points = frame.labelled["position"][flags & packets.UNLABELLED != 0]
        markers = found.astype(float) @ self._rotation.T
        markers[missing] = np.nan
        return markers, points.astype(float) @ self._rotation.T if len(points) else NO_POINTS

    def _plates(self, frame: Frame) -> PlateSamples:
        count, each = len(self._plate_numbers), self._samples
        numbers, sent = frame.plates
        if not count or not numbers:
            return PlateSamples.none(count)
        if numbers == self._plate_numbers and isinstance(sent, np.ndarray) and sent.shape[1:] == (6, each):
            channels = sent.astype(float)
        else:
            channels = np.full((count, 6, each), np.nan)
            by_number = dict(zip(numbers, sent, strict=True))
            for k, number in enumerate(self._plate_numbers):
                samples = by_number.get(number)
                if samples is not None and len(samples) >= 6 and samples.shape[1] == each:
                    channels[k] = samples[:6]
        turned = self._plate_axes @ channels.reshape(count, 2, 3, each)
        wrench = np.ascontiguousarray(turned.reshape(count, 6, each).transpose(2, 0, 1))
        first = frame.number * each
        return PlateSamples(np.arange(first, first + each), wrench)


def _rows(found: NDArray[np.float32] | None, count: int) -> NDArray[np.float32]:
    """(count, 3) positions of a set's markers; those that were not sent are NaN."""
    if found is not None and len(found) == count:
        return found
    rows = np.full((count, 3), np.nan, dtype=np.float32)
    if found is not None:
        rows[: len(found)] = found[:count]
    return rows


def _at_nought(points: NDArray[np.float32]) -> BoolArray:
    """(M,) true for points (M, 3) at the origin."""
    nought = np.asarray(points[:, 0] == 0.0)
    return nought & ~points.any(axis=1) if nought.any() else nought


def _among(found: NDArray[np.float32], others: NDArray[np.float32]) -> BoolArray:
    """(M,) true for points (M, 3) that are among the others (K, 3)."""
    among = np.zeros(len(found), dtype=bool)
    if not len(others):
        return among
    rows, which = np.nonzero(found[:, None, 0] == others[:, 0])
    same = (found[rows] == others[which]).all(axis=1)
    among[rows[same]] = True
    return among


def _rate(frames: Sequence[Frame]) -> float:
    first, last = frames[0], frames[-1]
    count, passed = last.number - first.number, last.time_s - first.time_s
    if count <= 0 or not 0.0 < passed < math.inf:
        raise InvalidInput("NatNet: the frames' numbers and time stamps determine no rate")
    rate_hz = count / passed
    whole = float(round(rate_hz))
    return whole if abs(rate_hz - whole) <= WHOLE_RATE * rate_hz else float(round(rate_hz, 4))
