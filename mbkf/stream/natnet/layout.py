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
from mbkf.stream.identity import Columns, elsewhere, plate_places
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

NO_PLATE = -1
"""Number of a plate that the server does not describe any more; no samples have it."""

NO_POINTS = read_only(np.zeros((0, 3)))
"""The points without names of a frame that has none."""


NOWHERE = np.zeros(0, dtype=np.intp)
"""Rows of an empty selection of points."""


class StreamLayout:
    """Turns a stream's frames into those of a :class:`mbkf.stream.source.FrameSource`.

    Attributes:
        stream: The stream's description; it stays when the server describes its stream anew.
        outdated: A frame did not fit the latest description of the server.
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
        self._sets = own_sets(described)
        self._known = _markers_of(self._sets)
        self._columns: Columns | None = None
        self.outdated = False
        names = [name for _, name in self._known]
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
            markers, points, residuals = self._points(frame)
            plates = self._plates(frame)
            return SourceFrame(frame.number, arrival_s, markers, points, plates, residuals_m=residuals)

    def describe(self, described: Descriptions) -> list[tuple[str, str]]:
        """Takes a later description: markers are found by name, plates by where they lie. Returns events."""
        self.outdated = False
        news: list[tuple[str, str]] = []
        sets = own_sets(described)
        places = [_place(one, _markers_of(sets)) for one in self._known]
        missing = [name for (_, name), place in zip(self._known, places, strict=True) if place < 0]
        if self._known and len(missing) == len(places):
            return [
                ("refused", "the camera computer describes other markers; the known ones are read as before")
            ]
        if missing:
            news.append(
                (
                    "markers",
                    f"{len(missing)} of {len(places)} markers are no longer described ({missing[0]} …)",
                )
            )
        self._sets = sets
        whole = places == list(range(sum(len(one.markers) for one in sets)))
        self._columns = None if whole else np.array(places, dtype=np.int64)
        return news + self._describe_plates(described.plates)

    def _describe_plates(self, described: Sequence[ForcePlate]) -> list[tuple[str, str]]:
        known, news = self.stream.plates, []
        usable = [plate for plate in described if _calibrated(plate)]
        with np.errstate(invalid="ignore", over="ignore"):
            found = [self._plate(plate, self.stream.plate_rate_hz) for plate in usable]
        numbers = []
        for plate, place in zip(known, plate_places(known, found), strict=True):
            numbers.append(NO_PLATE if place is None else usable[place].number)
            if place is None:
                news.append(("plates refused", f"{elsewhere(plate, found)}; it is not read any more"))
        self._plate_numbers = numbers
        return news

    def _plate(self, plate: ForcePlate, rate_hz: float) -> PlateReadings:
        if not _calibrated(plate):
            raise InvalidInput(
                f"NatNet: force plate {plate.serial} sends raw voltages; let Motive stream calibrated forces"
            )
        corners = plate.corners_m @ self._rotation.T
        origin = corners.mean(axis=0) + axes_of(corners) @ plate.offset_m
        known = corners if has_area(corners) else None
        name = plate.serial or str(plate.number)
        return empty_plate(name, rate_hz, 0.0, origin, DEFAULT_COP_THRESHOLD_N, known)

    def _points(self, frame: Frame) -> tuple[Array, Array, Array | None]:
        """(M, 3) named markers, (N, 3) points, and residuals of both; positions that Motive filled in are missing."""
        rows = [self._rows(frame.sets.get(one.name), len(one.markers)) for one in self._sets]
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
        residuals = None
        if len(frame.labelled):
            every = np.concatenate([found, points], dtype=np.float32)
            residuals = _residuals(every, frame.labelled)
            residuals[: len(found)][missing] = np.nan
        if self._columns is not None:
            markers = np.vstack([markers, np.full(3, np.nan)])[self._columns]
            if residuals is not None:
                own = np.append(residuals[: len(found)], np.nan)[self._columns]
                residuals = np.concatenate([own, residuals[len(found) :]])
        return markers, points.astype(float) @ self._rotation.T if len(points) else NO_POINTS, residuals

    def _rows(self, found: NDArray[np.float32] | None, count: int) -> NDArray[np.float32]:
        """(count, 3) positions of a set's markers; NaN where their number is not that of the description.

        Which marker came or went is not known then, so that no position has a name.
        """
        if found is not None and len(found) == count:
            return found
        self.outdated = self.outdated or found is not None
        return np.full((count, 3), np.nan, dtype=np.float32)

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


def own_sets(described: Descriptions) -> list[MarkerSet]:
    """Marker sets but the one that holds all markers once more."""
    return [one for one in described.sets if one.name.lower() != EVERYTHING]


def _markers_of(sets: Sequence[MarkerSet]) -> list[tuple[str, str]]:
    """Set and name of every marker."""
    return [(one.name, name) for one in sets for name in one.markers]


def _place(known: tuple[str, str], found: Sequence[tuple[str, str]]) -> int:
    """Place of a marker of a set: by both names, or by its own where only one marker has it; −1 without one."""
    if known in found:
        return found.index(known)
    names = [name for _, name in found]
    return names.index(known[1]) if names.count(known[1]) == 1 else -1


def _calibrated(plate: ForcePlate) -> bool:
    return not plate.raw and len(plate.channels) >= len(packets.CHANNELS)


def _at_nought(points: NDArray[np.float32]) -> BoolArray:
    """(M,) true for points (M, 3) at the origin."""
    nought = np.asarray(points[:, 0] == 0.0)
    return nought & ~points.any(axis=1) if nought.any() else nought


def _among(found: NDArray[np.float32], others: NDArray[np.float32]) -> BoolArray:
    """(M,) true for points (M, 3) that are among the others (K, 3)."""
    among = np.zeros(len(found), dtype=bool)
    among[_pairs(found, others)[0]] = True
    return among


def _residuals(points: NDArray[np.float32], labelled: NDArray[np.void]) -> Array:
    """(M,) residuals, m, of points (M, 3) by the labelled markers of their place; NaN without one."""
    places = labelled["position"]
    if places.tobytes() == points.tobytes():  # as a rule
        found = labelled["residual"].astype(float)
    else:
        found = np.full(len(points), np.nan)
        rows, which = _pairs(points, places)
        found[rows] = labelled["residual"][which]
    found[~(found >= 0.0)] = np.nan
    return found


def _pairs(
    found: NDArray[np.float32], others: NDArray[np.float32]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers of points (M, 3) and of the others (K, 3) at the same place."""
    if not len(found) or not len(others):
        return NOWHERE, NOWHERE
    rows, which = np.nonzero(found[:, None, 0] == others[:, 0])
    same = (found[rows] == others[which]).all(axis=1)
    return rows[same], which[same]


def _rate(frames: Sequence[Frame]) -> float:
    first, last = frames[0], frames[-1]
    count, passed = last.number - first.number, last.time_s - first.time_s
    if count <= 0 or not 0.0 < passed < math.inf:
        raise InvalidInput("NatNet: the frames' numbers and time stamps determine no rate")
    rate_hz = count / passed
    whole = float(round(rate_hz))
    return whole if abs(rate_hz - whole) <= WHOLE_RATE * rate_hz else float(round(rate_hz, 4))
