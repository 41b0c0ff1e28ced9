"""A capture cut into frames as a camera system sends them: markers, and the plates' samples until each frame's end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.resample import WHOLE
from mbkf.io.utf8 import storable
from mbkf.stream.source import PlateSamples, StreamDescription, without_readings
from mbkf.trial.inertial.motion_inputs import frame_times
from mbkf.trial.inertial.on_body import frame_readings


@dataclass(frozen=True)
class PlayedFrame:
    """One frame to send.

    Attributes:
        number: From 0.
        markers_m: (M, 3) named markers, NaN where missing; for points without names (C, 3), in any order.
        plates: The plates' samples until the end of the frame that were not sent before.
        imus: (S, 6) readings of inertial sensors; None where there are none.
    """

    number: int
    markers_m: Array
    plates: PlateSamples
    imus: Array | None = None


@dataclass(frozen=True)
class Played:
    """A capture as a stream.

    Attributes:
        stream: Its description.
        markers_m: (T, M, 3) markers or points.
        wrench: (S, K, 6) readings of all plates about their own origins.
        imus: (T, S, 6) angular velocity rad/s and specific force m/s² of inertial sensors; None where there are none.
    """

    stream: StreamDescription
    markers_m: Array
    wrench: Array
    imus: Array | None = None

    def __len__(self) -> int:
        return len(self.markers_m)

    @property
    def due_after_s(self) -> float:
        """A frame is complete this long after its time: half a frame, and a sample of the plates."""
        return 0.5 / self.stream.rate_hz + 1.0 / self.stream.plate_rate_hz

    def frames(self) -> Iterator[PlayedFrame]:
        """All frames in order."""
        stream = self.stream
        ratio = stream.plate_rate_hz / stream.rate_hz
        offset = 0.0
        if stream.plates:
            offset = (stream.start_time_s - stream.plates[0].start_time_s) * stream.plate_rate_hz
        sent = max(0, int(np.floor(offset - 0.5 * ratio)) - 1)
        for number, markers in enumerate(self.markers_m):
            last = np.ceil(offset + (number + 0.5) * ratio - WHOLE)
            until = min(int(last) + 1, len(self.wrench))
            index = np.arange(sent, max(until, sent))
            imus = None if self.imus is None else self.imus[number]
            yield PlayedFrame(number, markers, PlateSamples(index, self.wrench[index]), imus)
            sent = max(until, sent)


def played(capture: Capture, unlabelled: bool = False, seed: int = 0) -> Played:
    """A capture as a stream.

    Args:
        capture: Markers and plates.
        unlabelled: Whether names are dropped; the points of a frame then come in an order of their own. So they do
            where all names begin with a star, the names of unlabelled points in C3D files.
        seed: Of that order.

    Raises:
        InvalidInput: It has no frames, or its plates have different rates or times.
    """
    markers, plates = capture.markers, capture.plates
    if not markers.frames:
        raise InvalidInput(f"{capture.path or 'the capture'} has no frames to play")
    unlabelled = unlabelled or all(name.startswith("*") for name in markers.names)
    positions = np.array(markers.positions_m)
    if unlabelled:
        rng = np.random.default_rng(seed)
        positions = np.array([_shuffled(frame, rng) for frame in positions])
    length = _common_length(plates, capture.path)
    wrench = np.zeros((length, len(plates), 6))
    for k, plate in enumerate(plates):
        wrench[:, k] = np.hstack([plate.force_n, plate.moment_nm])[:length]
    stream = StreamDescription(
        storable(Path(capture.path).stem) or "capture",
        () if unlabelled else markers.names,
        markers.rate_hz,
        markers.start_time_s,
        tuple(without_readings(plate) for plate in plates),
    )
    return Played(stream, positions, wrench)


def played_sensors(readings: Sequence[ImuReadings], trial: str) -> Played:
    """Recorded inertial sensors on one clock as a stream, at the first one's times.

    Raises:
        InvalidInput: There are no sensors, or fewer than two samples.
    """
    if not readings or readings[0].samples < 2:
        raise InvalidInput(f"{trial} has no readings to play")
    times_s = frame_times(readings[0])
    rate_hz = readings[0].rate_hz / round(readings[0].samples / len(times_s))
    names = tuple(one.name for one in readings)
    stream = StreamDescription(trial, (), rate_hz, float(times_s[0]), sensors=names)
    none = np.zeros((len(times_s), 0, 3))
    return Played(stream, none, np.zeros((0, 0, 6)), frame_readings(readings, times_s))


def _shuffled(points_m: Array, rng: np.random.Generator) -> Array:
    """Points (C, 3) in random order, those that are there first."""
    present = points_m[~np.isnan(points_m).any(axis=1)]
    found = np.full(points_m.shape, np.nan)
    found[: len(present)] = rng.permutation(present)
    return found


def _common_length(plates: tuple[PlateReadings, ...], path: str) -> int:
    if not plates:
        return 0
    times = {(plate.rate_hz, plate.start_time_s) for plate in plates}
    if len(times) > 1:
        raise InvalidInput(f"{path}: its plates have different rates or times and cannot be one stream")
    return min(len(plate.force_n) for plate in plates)
