"""Sources of live frames, network streams and files alike: the protocol and its records."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.imu.plausible import MOST_MPS2, MOST_RAD_S
from mbkf.io.records import PlateReadings
from mbkf.kernel.loading import library

FARTHEST_M = 100.0
"""Bound of a point's coordinates: camera volumes are smaller."""

LARGEST_COUNT = 2**36
"""Bound of a count of frames or samples, either way: at 1000 Hz it is that of two years."""

UNCOUNTED = -(2**62)
"""Number of a frame or a sample whose count cannot be read (NaN, infinite, absurdly large)."""


@dataclass(frozen=True)
class StreamDescription:
    """A stream's description, known before its first frame.

    Attributes:
        trial: Name of the played trial, or of the stream.
        marker_names: (M,) its markers; none where points come without names.
        rate_hz: Frame rate.
        start_time_s: Time of frame 0 of the source's own counting.
        plates: Its plates without readings, all at one rate; ``start_time_s`` is the time of sample 0.
        sensors: (S,) its inertial sensors.
    """

    trial: str
    marker_names: tuple[str, ...]
    rate_hz: float
    start_time_s: float = 0.0
    plates: tuple[PlateReadings, ...] = ()
    sensors: tuple[str, ...] = ()

    @property
    def plate_rate_hz(self) -> float:
        """Rate of the plates, that of the frames where there are none."""
        return self.plates[0].rate_hz if self.plates else self.rate_hz


@dataclass(frozen=True)
class PlateSamples:
    """Readings of all plates, one after the other.

    Attributes:
        index: (S,) numbers of the samples, ascending; of a source as it counts, :data:`UNCOUNTED` where that cannot be
            read.
        wrench: (S, K, 6) force N and moment N m about each plate's own origin, world axes.
    """

    index: NDArray[np.int64]
    wrench: Array

    @classmethod
    def none(cls, plates: int) -> PlateSamples:
        """An empty record for so many plates."""
        return cls(np.zeros(0, dtype=int), np.zeros((0, plates, 6)))


@dataclass(frozen=True)
class SourceFrame:
    """One frame as a source delivers it; world axes, m.

    Attributes:
        number: As the source counts frames, :data:`UNCOUNTED` where that cannot be read.
        arrival_s: When it arrived, on the clock of ``time.perf_counter``.
        markers_m: (M, 3) named markers, NaN where missing.
        unlabelled_m: (N, 3) points without names.
        plates: What the plates read since the frame before.
        imus: (S, 6) angular velocity rad/s and specific force m/s² of inertial sensors in their own axes, NaN where
            missing; None where there are none.
        orientations: (S, 4) unit quaternions of the segments' own frames (x forward, y left, z up in the neutral
            posture) → one world, z up; NaN where missing; None where they are not known.
        residuals_m: (M + N,) the camera system's residuals of markers and points, NaN where it states no residual;
            None for a system that streams no residuals.
    """

    number: int
    arrival_s: float
    markers_m: Array
    unlabelled_m: Array
    plates: PlateSamples
    imus: Array | None = None
    orientations: Array | None = None
    residuals_m: Array | None = None


class FrameSource(Protocol):
    """Delivers frames one by one.

    Attributes:
        patient: Whether it waits for a slow reader, as a file does; a camera does not.
    """

    patient: bool

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """Looks for the stream for so long; None where it is not there (yet).

        Raises:
            MbkfError: The stream is there, but cannot be used.
        """

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame; None where none has come for so long. A stream that died is looked for again meanwhile.

        Raises:
            EOFError: No more frames will ever come.
        """

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call, each a kind and a sentence."""

    def close(self) -> None:
        """Lets go of the stream."""


def counts(values: Array | np.float64) -> NDArray[np.int64]:
    """(n,) whole numbers of counts that came as numbers (n,); :data:`UNCOUNTED` for an unreadable one."""
    with np.errstate(invalid="ignore"):
        known = np.abs(values) <= LARGEST_COUNT
    return np.where(known, np.round(np.where(known, values, 0.0)), UNCOUNTED).astype(np.int64)


def plausible(points_m: Array) -> tuple[Array, int]:
    """Points (N, 3) with implausible ones replaced by NaN, and their number; NaN points are not counted.

    Where no coordinate is missing or implausible, the array given is returned.
    """
    kernel = library()
    if kernel is not None:
        wrong_ones, absent, shown = kernel.plausible_points(
            np.ascontiguousarray(points_m, dtype=np.float64), FARTHEST_M
        )
        return shown if absent else points_m, wrong_ones
    far = np.abs(points_m) > FARTHEST_M
    missing = np.asarray(np.isnan(points_m).any(axis=1))
    if far.any():
        wrong = ~missing & np.asarray(far.any(axis=1))
        return np.where((missing | wrong)[:, None], np.nan, points_m), int(wrong.sum())
    return (np.where(missing[:, None], np.nan, points_m) if missing.any() else points_m), 0


def plausible_imus(imus: Array) -> tuple[Array, int]:
    """Readings (S, 6) with impossible ones replaced by NaN, and the number of sensors with such a reading."""
    wrong = np.abs(imus) > np.repeat([MOST_RAD_S, MOST_MPS2], 3)
    return (np.where(wrong, np.nan, imus), int(wrong.any(axis=1).sum())) if wrong.any() else (imus, 0)


def empty_plate(
    name: str,
    rate_hz: float,
    start_time_s: float,
    origin_m: Array,
    threshold_n: float,
    corners_m: Array | None,
) -> PlateReadings:
    """A plate without readings.

    Args:
        name: Its name.
        rate_hz: Rate of its samples.
        start_time_s: Time of sample 0.
        origin_m: (3,) its origin in the world.
        threshold_n: Vertical force from which on a centre of pressure is computed, N.
        corners_m: (4, 3) its corners in the world, None where not known.
    """
    nothing = np.zeros((0, 3))
    return PlateReadings(
        name, rate_hz, start_time_s, origin_m, nothing, nothing, nothing, threshold_n, corners_m
    )


def without_readings(plate: PlateReadings) -> PlateReadings:
    """The same plate before it has read anything."""
    nothing = np.zeros((0, 3))
    return replace(plate, force_n=nothing, moment_nm=nothing, centre_of_pressure_m=nothing)
