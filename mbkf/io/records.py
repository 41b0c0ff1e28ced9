"""Contents of a capture: immutable records in SI units and mbkf's world axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.errors import ShapeError, UnknownName


class AxesSource(StrEnum):
    """Origin of the axes of a file that point forward, left and up."""

    PLATES = "plates"
    """The surfaces of the file's force plates face up."""
    SCREEN = "screen"
    """POINT:Y_SCREEN, the axis that the laboratory's screen shows as up."""
    DEFAULT = "default"
    """The file does not say: the format's usual axes."""
    UP_GIVEN = "up given"
    """The caller named the axis that points up."""
    GIVEN = "given"
    """The caller named all three axes; nothing is changed."""
    BODY = "body"
    """The markers of the person contradicted the file, which was put right."""
    MADE = "made"
    """Made in memory, in world axes."""


@dataclass(frozen=True)
class MarkerTrajectories:
    """Measured marker positions of one trial.

    Attributes:
        names: M marker names.
        positions_m: (T, M, 3) world positions in m; NaN where a marker is not seen.
        rate_hz: Frame rate in Hz, as the file states it.
        start_time_s: Time of the first frame in s.
    """

    names: tuple[str, ...]
    positions_m: Array
    rate_hz: float
    start_time_s: float = 0.0

    def __post_init__(self) -> None:
        positions = read_only(self.positions_m)
        if positions.ndim != 3 or positions.shape[1:] != (len(self.names), 3):
            raise ShapeError("positions_m", f"(T, {len(self.names)}, 3)", positions.shape)
        object.__setattr__(self, "positions_m", positions)

    @property
    def frames(self) -> int:
        """Number of frames T."""
        return self.positions_m.shape[0]

    @property
    def times_s(self) -> Array:
        """(T,) times of the frames in s."""
        return self.start_time_s + np.arange(self.frames) / self.rate_hz

    @property
    def present(self) -> BoolArray:
        """(T, M) whether a marker is seen in a frame."""
        return np.logical_not(np.isnan(self.positions_m).any(axis=2))

    def select(self, names: tuple[str, ...]) -> MarkerTrajectories:
        """The trajectories of the named markers, in that order.

        Raises:
            UnknownName: A name is not among the markers.
        """
        index = {name: i for i, name in enumerate(self.names)}
        for name in names:
            if name not in index:
                raise UnknownName("marker", name, self.names)
        columns = [index[name] for name in names]
        return MarkerTrajectories(names, self.positions_m[:, columns], self.rate_hz, self.start_time_s)


@dataclass(frozen=True)
class PlateReadings:
    """One force plate (or one column set of a force file) over a trial.

    Attributes:
        name: Plate name: its number ("1", "2", …) or the set's name in the file ("r", "l", …).
        rate_hz: Sample rate in Hz.
        start_time_s: Time of the first sample in s.
        origin_m: (3,) world point the moments refer to (the centre of the plate's surface; for
            force files without geometry the mean centre of pressure).
        force_n: (S, 3) force of the plate on the body in N, world axes, offset removed.
        moment_nm: (S, 3) moment on the body about ``origin_m`` in N m, world axes.
        centre_of_pressure_m: (S, 3) world point where the force acts on the plate's surface; NaN
            where the vertical force is below ``threshold_n``.
        threshold_n: Vertical force below which no centre of pressure is given, in N.
        corners_m: (4, 3) world corners of the surface, or None where the file has no geometry.
        offset: (6,) wrench (N, N m; world axes, about ``origin_m``) that was removed as offset.
        description: Origin of the readings, in words; empty where the plate itself read them.
    """

    name: str
    rate_hz: float
    start_time_s: float
    origin_m: Array
    force_n: Array
    moment_nm: Array
    centre_of_pressure_m: Array
    threshold_n: float
    corners_m: Array | None = None
    offset: Array = field(default_factory=lambda: np.zeros(6))
    description: str = ""

    def __post_init__(self) -> None:
        for name in ("origin_m", "force_n", "moment_nm", "centre_of_pressure_m", "offset"):
            object.__setattr__(self, name, read_only(getattr(self, name)))
        if self.corners_m is not None:
            object.__setattr__(self, "corners_m", read_only(self.corners_m))
        for name in ("force_n", "moment_nm", "centre_of_pressure_m"):
            if getattr(self, name).shape != (len(self.force_n), 3):
                raise ShapeError(name, f"({len(self.force_n)}, 3)", getattr(self, name).shape)

    @property
    def times_s(self) -> Array:
        """(S,) sample times in s."""
        return self.start_time_s + np.arange(len(self.force_n)) / self.rate_hz


@dataclass(frozen=True)
class DerivedPoint:
    """A point a laboratory's software computed and stored among the markers.

    Attributes:
        name: Its label.
        kind: "angle", "moment", "force", "power", "scalar" or "point" (joint centres, axes …).
        values: (T, 3) in the file's own units and axes; NaN where missing.
        unit: The file's unit for that kind, "" where it states none.
        description: What the file says of it.
    """

    name: str
    kind: str
    values: Array
    unit: str
    description: str = ""


class SampleScaling(NamedTuple):
    """Scaling of stored samples: value = (sample − offset) · scale · general; ``general`` is that of all channels."""

    scale: float = 1.0
    general: float = 1.0
    offset: float = 0.0


UNSCALED = SampleScaling()
"""Samples that are the values themselves."""


@dataclass(frozen=True)
class AnalogChannel:
    """One analog channel, kept as stored (EMG, raw plate channels, …).

    Attributes:
        name: Its label.
        values: (S,) samples in ``unit``.
        unit: Their unit, "" where the file states none.
        rate_hz: Sample rate in Hz.
        scaling: Of the samples in the file, so that they can be written again bit by bit.
        description: What the file says of it.
    """

    name: str
    values: Array
    unit: str
    rate_hz: float
    scaling: SampleScaling = UNSCALED
    description: str = ""


@dataclass(frozen=True)
class CaptureEvent:
    """A labelled instant, e.g. label "Foot Strike", context "Left", at ``time_s``."""

    label: str
    context: str
    time_s: float


@dataclass(frozen=True)
class Capture:
    """Everything one trial file (and its force file) holds.

    Attributes:
        path: The file it was read from, "" when made in memory.
        markers: Measured markers only; derived points are kept apart.
        plates: Force plates, possibly none.
        derived: Points computed by other software.
        analog: Every analog channel as stored.
        events: Labelled instants in order of time.
        up_axis: Axis of the file that points up ("x", "y", "z", possibly with "-").
        length_unit: Unit of the file's marker coordinates ("mm", "m", "cm").
        notes: Remarks of the reader (empty unit, malformed header, offsets removed …).
        subject_mass_kg: Body mass stated in the file, or None.
        axes: Axes of the file that became x (forward), y (left) and z (up), as ``"x,-z,y"``.
        axes_source: Where that is known from.
        processing: Numbers that the laboratory's software stored of the person, by their name in capitals and in its
            units (C3D's PROCESSING group: widths of joints in mm, offsets of Plug-in Gait in rad).
        plates_left_out: Force plates of the file that are not among ``plates``, by their names, with the reason.
        others: Markers of the other persons in the file, where one of several was chosen; None otherwise.
    """

    path: str
    markers: MarkerTrajectories
    plates: tuple[PlateReadings, ...] = ()
    derived: tuple[DerivedPoint, ...] = ()
    analog: tuple[AnalogChannel, ...] = ()
    events: tuple[CaptureEvent, ...] = ()
    up_axis: str = "z"
    length_unit: str = "m"
    notes: tuple[str, ...] = ()
    subject_mass_kg: float | None = None
    axes: str = "x,y,z"
    axes_source: AxesSource = AxesSource.MADE
    processing: Mapping[str, float] = field(default_factory=dict)
    plates_left_out: Mapping[str, str] = field(default_factory=dict)
    others: MarkerTrajectories | None = None
