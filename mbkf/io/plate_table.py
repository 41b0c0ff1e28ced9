"""Readings of a force plate whose corners are known: force and moment in plate or laboratory axes, on body or plate.

Exports differ in the axes of the vectors, in the point the moments refer to and in their unit. A file that states a
centre of pressure c decides what it does not state: about a point o of the surface, o + n × M / (n · F) is c, with the
normal n, force F and moment M. A file without it has to state its axes, and moments whose c lies on the plate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.axes import nearest_axis, rotation_to_world, up_axis
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_table import into_axes, reaction_sign
from mbkf.io.plate_corners import has_area, plate_axes, plate_normal, upward_normal
from mbkf.io.plausible import FARTHEST_M
from mbkf.io.readable_plates import readable_plates
from mbkf.io.records import PlateReadings
from mbkf.io.wrench import Tare, centre_of_pressure, find_tare, remove_tare, require_finite

_AGREEMENT_M = 0.01
_SAME_M = 0.001


@dataclass(frozen=True)
class PlateTable:
    """One plate's rows in the axes of its file.

    Attributes:
        path: The file.
        name: Name of the plate.
        corners_m: (4, 3) corners in the quadrants (+x +y), (−x +y), (−x −y), (+x −y) of the plate, laboratory axes.
        force_n: (S, 3) forces.
        moment: (S, 3) moments.
        pressure_m: (S, 3) centres of pressure, or None where the file has none.
        rate_hz: Sample rate.
        start_time_s: Time of the first sample.
        in_plate_axes: The vectors are in the plate's axes (z down); None where the file does not say so.
    """

    path: str
    name: str
    corners_m: Array
    force_n: Array
    moment: Array
    pressure_m: Array | None
    rate_hz: float
    start_time_s: float
    in_plate_axes: bool | None


@dataclass(frozen=True)
class _Reading:
    """One way to read a plate.

    Attributes:
        local: The vectors were taken as in plate axes.
        force_n: (S, 3) force in laboratory axes.
        moment_nm: (S, 3) moment about the plate's centre in laboratory axes.
        error_m: RMS distance from the stated centres of pressure and from the plate, infinite for an unloaded plate.
    """

    local: bool
    force_n: Array
    moment_nm: Array
    error_m: float


def plates_with_corners(
    tables: Sequence[PlateTable], up: str, options: CaptureOptions, *, needs_one: bool = True
) -> tuple[PlateReadings, ...]:
    """Readings of plates in SI units and world axes, about the centres of their surfaces.

    Args:
        tables: The plates of one trial.
        up: Axis of the laboratory that points up.
        options: Removal of offsets, threshold of the centres of pressure, and the lists that receive remarks and plates
            that cannot be read.
        needs_one: True where no readable plate is an error.

    Raises:
        FileFormatError: No plate can be read: the first has no usable corners, or its axes are not clear.
        InvalidInput: As before, for a force or moment that is not a number.
    """
    if not tables:
        return ()
    where = f"{tables[0].path}"
    named = ((one.name, one) for one in tables)
    read = readable_plates(named, lambda one: (one, _best(one, options)), options, where, needs_one=needs_one)
    if not read:
        return ()
    standing, up = faced_axis(read[0][0]), up_axis(up)
    rotation = rotation_to_world(standing)
    sign = reaction_sign([one.force_n @ rotation.T for _, one in read], options.notes)
    readings = []
    for table, one in read:
        wrench = sign * np.hstack([one.force_n @ rotation.T, one.moment_nm @ rotation.T])
        corners_m = table.corners_m @ rotation.T
        plate = table.name, table.rate_hz, table.start_time_s
        readings.append(plate_with_corners(*plate, corners_m, wrench, options)[0])
    return into_axes(readings, standing, up, options.notes)


def plate_with_corners(
    name: str,
    rate_hz: float,
    start_time_s: float,
    corners_m: Array,
    wrench: Array,
    options: CaptureOptions,
    tare: Tare | None = None,
) -> tuple[PlateReadings, Tare]:
    """A plate with corners, about the middle of its surface, and the offset found if one is to be removed.

    Args:
        name: Its name.
        rate_hz: Sample rate.
        start_time_s: Time of the first sample.
        corners_m: (4, 3) corners in world axes.
        wrench: (S, 6) force in N and moment in N m about the middle of the corners, world axes.
        options: Removal of the offset, and threshold of the centre of pressure.
        tare: The offset, where it is known; None: it is sought.
    """
    if tare is None:
        tare = find_tare(wrench, rate_hz) if options.tare else Tare(np.zeros(6), 0.0)
    if options.tare:
        wrench = remove_tare(wrench, tare)
    centre, force, moment = corners_m.mean(axis=0), wrench[:, :3], wrench[:, 3:]
    pressure = centre_of_pressure(force, moment, centre, upward_normal(corners_m), options.cop_threshold_n)
    readings = PlateReadings(
        name,
        rate_hz,
        start_time_s,
        centre,
        force,
        moment,
        pressure,
        options.cop_threshold_n,
        corners_m,
        tare.offset,
    )
    return readings, tare


def faced_axis(table: PlateTable) -> str:
    """The axis of the laboratory that a plate's surface faces, "z" or "-y" for instance."""
    return nearest_axis(plate_normal(table.corners_m))


def faced_axes(tables: Sequence[PlateTable]) -> list[str]:
    """The axes of the laboratory that plates with usable corners face, without repetition, in the plates' order."""
    usable = [table for table in tables if has_area(table.corners_m, FARTHEST_M)]
    return list(dict.fromkeys(faced_axis(table) for table in usable))


def check_corners(table: PlateTable) -> None:
    """Refuses a plate whose corners enclose no area, or lie outside of any laboratory.

    Raises:
        FileFormatError: It is such a plate.
    """
    if not has_area(table.corners_m, FARTHEST_M):
        raise FileFormatError(table.path, f"plate '{table.name}' has no usable corners; export them too")


def _best(table: PlateTable, options: CaptureOptions) -> _Reading:
    """The reading of a plate whose moments give the centres of pressure that the file states."""
    check_corners(table)
    where = f"{table.path}, plate '{table.name}'"
    require_finite(table.force_n, table.moment, table.rate_hz, table.start_time_s, where)
    if table.in_plate_axes is None and table.pressure_m is None:
        reason = "neither axes nor a centre of pressure are stated; export the centre of pressure too"
        raise FileFormatError(table.path, f"plate '{table.name}': {reason}")
    frames = (True, False) if table.in_plate_axes is None else (table.in_plate_axes,)
    ways = [
        _read(table, local, about_centre, factor, options.cop_threshold_n)
        for factor in (1.0, 1e-3)
        for local in frames
        for about_centre in ((True,) if local else (True, False))
    ]
    best = min(ways, key=lambda way: way.error_m)
    other = min((way.error_m for way in ways if way.local != best.local), default=np.inf)
    if np.isfinite(other) and other < best.error_m + _SAME_M:
        reason = "its vectors fit plate and laboratory axes equally well; export it with its DESCRIPTION"
        raise FileFormatError(table.path, f"plate '{table.name}': {reason}")
    if best.error_m > _AGREEMENT_M and np.isfinite(best.error_m):
        options.notes.append(
            f"plate '{table.name}': moments and centres of pressure disagree by {1e3 * best.error_m:.0f} mm"
        )
    return best if np.isfinite(best.error_m) else ways[0]


def _read(table: PlateTable, local: bool, about_centre: bool, factor: float, threshold_n: float) -> _Reading:
    """A plate read one way: vectors in its own axes (``local``) or the laboratory's, moments about its centre or 0.

    ``factor`` is N m per unit of the moments; a centre of pressure counts from ``threshold_n`` normal to the plate on.
    """
    axes = plate_axes(table.corners_m)
    centre, normal = table.corners_m.mean(axis=0), axes[:, 2]
    turn = axes.T if local else np.eye(3)
    force, moment = table.force_n @ turn, factor * table.moment @ turn
    if not about_centre:
        moment = moment - np.cross(centre, force)
    pressed = np.abs(force @ normal) >= threshold_n
    if table.pressure_m is not None:
        pressed &= (np.abs(table.pressure_m) <= FARTHEST_M).all(axis=1)
        pressed &= table.pressure_m.any(axis=1)  # exactly 0 where the file states no point
    if not pressed.any():
        return _Reading(local, force, moment, np.inf)
    found = centre + np.cross(normal, moment[pressed]) / (force[pressed] @ normal)[:, None]
    half = np.abs((table.corners_m - centre) @ axes[:, :2]).max(axis=0)
    outside = np.maximum(np.abs((found - centre) @ axes[:, :2]) - half, 0.0)
    off = np.zeros_like(outside)
    if table.pressure_m is not None:
        off = (table.pressure_m[pressed] @ turn + (centre if local else 0.0) - found) @ axes[:, :2]
    return _Reading(local, force, moment, _rms(off) + _rms(outside))


def _rms(vectors: Array) -> float:
    """RMS of the norms of (S, 2) vectors."""
    return float(np.sqrt((vectors**2).sum(axis=1).mean()))
