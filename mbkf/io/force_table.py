"""Ground reactions of a table of named columns: units, moments and axes completed where the numbers decide them.

A table states, per set, the force and its point of application. Other entries follow from mechanics, or a remark names
the assumption:

- **Up**: the mean force of a person is weight, so it points along the vertical.
- **Sign**: a plate pushes. Forces that pull down, in a file that does not state whose they are, are those on the
  plate, and are turned.
- **Moment**: its point and unit agree with forces and points of application (:mod:`mbkf.io.moment_reference`).
- **Units**: a point lies in a laboratory.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import FileFormatError
from mbkf.io.axes import finite, nearest_axis, rotation_to_world, up_axis
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_names import ForceSet, force_sets
from mbkf.io.moment_reference import LABORATORY_M, MomentReference, reference_at_point, reference_of_moments
from mbkf.io.readable_plates import readable_plates
from mbkf.io.records import PlateReadings
from mbkf.io.turning import rotated
from mbkf.io.wrench import LARGEST, centre_of_pressure, find_tare, remove_tare, require_finite

_LEAST_OFFSET_N = 2.0
_UP = np.array([0.0, 0.0, 1.0])
_LEAST_WEIGHT_N = 10.0
_VERTICAL_SHARE = 0.9
_FREE_SHARE = 0.1
"""Vertical moments about a point are free torques if they are less than this share of the alternative, squared."""


@dataclass(frozen=True)
class ForceTable:
    """A table of ground reactions in the axes of its file.

    Attributes:
        path: The file.
        names: C column names.
        values: (S, C) values; forces in N.
        rate_hz: Sample rate in Hz.
        start_time_s: Time of the first sample in s.
        metres: Metres per unit of the points; None where the file does not state the unit.
        newton_metres: N m per unit of the moments; None where the file does not state it.
        at_point: Moments act at the point of application, as OpenSim has them.
        on_body: Forces are those on the body; else they may be those on the plate.
    """

    path: str
    names: tuple[str, ...]
    values: Array
    rate_hz: float
    start_time_s: float
    metres: float | None = 1.0
    newton_metres: float | None = 1.0
    at_point: bool = True
    on_body: bool = True


@dataclass(frozen=True)
class _Columns:
    """(S, 3) force, point and moment of a set in world axes."""

    name: str
    force: Array
    point: Array
    moment: Array


def plates_of_table(table: ForceTable, options: CaptureOptions) -> tuple[PlateReadings, ...]:
    """Ground reactions of a table, in SI units and world axes.

    With p the point of application, F the force and T the torque there, the moment about the set's origin o is
    T + (p − o) × F. The origin is the mean point of application while loaded, or the one that the moments have.
    Where weight shows that another axis is vertical, all this is done with that one; the vectors keep to the axis that
    was asked for, so that they stay in the axes of markers that were read with it. An offset of the unloaded set is
    removed where it is 2 N or more.

    Raises:
        FileFormatError: Columns of a set, or its point of application, are missing.
        InvalidInput: A force, point or torque is not a number.
        UnknownName: No column follows a known naming.
    """
    notes, threshold_n = options.notes, options.cop_threshold_n
    sets = force_sets(table.names, table.path)
    up = up_axis(options.up or options.shared_up or _weight_axis(table, sets, notes))
    standing = _standing(table, sets, up)
    columns = [_columns(table, one, standing, notes) for one in sets]
    sign = 1.0 if table.on_body else reaction_sign([one.force for one in columns], notes)
    metres = _metres(table, columns, threshold_n, notes)
    readings = readable_plates(
        ((one.name, one) for one in columns),
        lambda one: _set_readings(table, one, (sign, metres), options),
        options,
        table.path,
    )
    return into_axes(readings, standing, up, notes)


def _set_readings(
    table: ForceTable, one: _Columns, factors: tuple[float, float], options: CaptureOptions
) -> PlateReadings:
    """Readings of a set, with the factors of its forces (their sign) and of its points (metres).

    Raises:
        FileFormatError: The moments do not agree with the points of application.
        InvalidInput: A force, point or torque is not a number.
    """
    sign, metres = factors
    force, moment, point = sign * one.force, sign * one.moment, metres * one.point
    loaded = force[:, 2] >= options.cop_threshold_n
    point[~loaded & ~finite(point)] = 0.0  # no force, so no point of application
    where = f"{table.path}, set '{one.name}'"
    require_finite(np.hstack([force, point]), moment, table.rate_hz, table.start_time_s, where)
    factor, origin, doubt = _moment_reference(table, force[loaded], point[loaded], moment[loaded], one.name)
    about = factor * moment
    if doubt:
        options.notes.append(f"set '{one.name}': {doubt}")
    if table.at_point and factor != 1.0:
        options.notes.append(f"set '{one.name}': torques fit feet as N mm, not as N m; taken as N mm")
    if origin is None:
        origin = point[loaded].mean(axis=0) if loaded.any() else np.zeros(3)
        with np.errstate(all="ignore"):  # impossible points give impossible moments, which are refused later
            about = about + np.cross(point - origin, force)
    else:
        place = f"({', '.join(f'{value + 0.0:.3f}' for value in np.round(origin, 3))}) m"
        place = place if np.round(origin, 3).any() else "the laboratory's origin"
        found = f"set '{one.name}': moments refer to {place}, as its centres of pressure show"
        if table.at_point:
            found += "; they are moved to the centre of pressure, about which such a file should state them"
            about = _with_vertical(about, np.cross(point - origin, force), loaded)
        options.notes.append(found)
    return _readings(table, one.name, np.hstack([force, about]), point, origin, options)


def vertical_axis(forces: Sequence[Array]) -> str | None:
    """The axis, "y" or "-z" for instance, of the mean of forces (S, 3) of each set; None for oblique or small ones."""
    with np.errstate(all="ignore"):
        mean = _mean_force(forces)
        size = float(np.linalg.norm(mean))
    if not size >= _LEAST_WEIGHT_N or np.abs(mean).max() < _VERTICAL_SHARE * size:
        return None
    return nearest_axis(mean)


def reaction_sign(forces: Sequence[Array], notes: list[str]) -> float:
    """1 where the forces (S, 3) of each set, world axes, act on the body, −1 where they act on the plate."""
    mean = _mean_force(forces)
    if mean[2] > -_LEAST_WEIGHT_N or -mean[2] < _VERTICAL_SHARE * np.linalg.norm(mean):
        return 1.0
    notes.append("the file holds the forces on the plates; turned into those on the body")
    return -1.0


def _mean_force(forces: Sequence[Array]) -> Array:
    """(3,) sum over the sets of their mean force in N."""
    plain = [np.clip(np.nan_to_num(force), -LARGEST, LARGEST) for force in forces]
    return np.asarray(np.sum([force.mean(axis=0) for force in plain], axis=0))


def into_axes(
    plates: Sequence[PlateReadings], standing: str, up: str, notes: list[str]
) -> tuple[PlateReadings, ...]:
    """Plates that were read with one axis up as if another had been.

    Args:
        plates: Readings in world axes.
        standing: Axis of the file that was up.
        up: Axis that is to be up.
        notes: Receives the remark that the two differ.
    """
    if standing == up:
        return tuple(plates)
    notes.append(
        f"the ground reactions point along {standing} of their file, which was read with {up} up; give "
        "--up, unless the body in the capture puts the axes right"
    )
    turn = rotation_to_world(up) @ rotation_to_world(standing).T
    return tuple(rotated(plate, turn, turn) for plate in plates)


def _standing(table: ForceTable, sets: Sequence[ForceSet], up: str) -> str:
    """The axis of the file on which people stand: ``up``, unless weight points along another."""
    found = vertical_axis(_forces(table, sets))
    if found is None or table.on_body:
        return found or up
    return up if found[-1] == up[-1] else found[-1]


def _weight_axis(table: ForceTable, sets: Sequence[ForceSet], notes: list[str]) -> str:
    """The axis that carries the weight; y, the usual one, where the forces point along none."""
    found = vertical_axis(_forces(table, sets))
    if found is not None and not table.on_body:
        found = found[-1]
    if found is None or found == "y":
        return "y"
    notes.append(
        f"the ground reactions carry weight along {found}; taken as up in their file (--up changes it)"
    )
    return found


def _forces(table: ForceTable, sets: Sequence[ForceSet]) -> list[Array]:
    return [table.values[:, list(one.force)] for one in sets]


def _with_vertical(about: Array, lever: Array, loaded: BoolArray) -> Array:
    """Moments (S, 3) about an origin, whose vertical part a file may state as the free torque nevertheless.

    Args:
        about: Moments as they are stated, N m.
        lever: (S, 3) moments of the forces at their points about the origin.
        loaded: (S,) samples with a load.
    """
    stated, free = about[loaded, 2], about[loaded, 2] - lever[loaded, 2]
    if (stated**2).sum() >= _FREE_SHARE * (free**2).sum():
        return about
    return about + lever * [0.0, 0.0, 1.0]


def _columns(table: ForceTable, one: ForceSet, up: str, notes: list[str]) -> _Columns:
    """A set's vectors in world axes; missing columns are completed."""
    rotation = rotation_to_world(up)
    vertical = int(np.argmax(np.abs(rotation[2])))

    def vectors(indices: Sequence[int | None]) -> Array:
        zero = np.zeros(len(table.values))
        return np.column_stack([zero if index is None else table.values[:, index] for index in indices])

    point, moment = one.point, one.moment
    if all(index is None for index in point):
        reason = f"set '{one.name}' has no point of application; export the centre of pressure too"
        raise FileFormatError(table.path, reason)
    if None in point:
        if point[vertical] is not None:
            reason = f"set '{one.name}' lacks the {'xyz'[point.index(None)]} of its point of application"
            raise FileFormatError(table.path, f"{reason}, and {up} is up; export it, or give the right --up")
        notes.append(f"set '{one.name}' gives no height of the point of application; taken as 0")
    given = [index for index in moment if index is not None]
    if not given:
        notes.append(f"set '{one.name}' has no torque; the free moment is taken as 0")
    elif len(given) == 1:  # the free moment, whatever its axis is called
        moment = tuple(given[0] if axis == vertical else None for axis in range(3))
    force, point_vectors, moment_vectors = (vectors(group) for group in (one.force, point, moment))
    if len(given) == 1:  # it is about the vertical that points up
        moment_vectors = np.abs(rotation[2]) * moment_vectors * np.sign(rotation[2, vertical])
    with np.errstate(all="ignore"):  # cells that are not numbers are refused later
        return _Columns(one.name, *(values @ rotation.T for values in (force, point_vectors, moment_vectors)))


def _metres(table: ForceTable, columns: Sequence[_Columns], threshold_n: float, notes: list[str]) -> float:
    """Metres per unit of the points."""
    if table.metres is not None:
        return table.metres
    loaded = [one.point[np.abs(one.force[:, 2]) >= threshold_n] for one in columns]
    reach = [np.percentile(np.abs(np.nan_to_num(one)).max(axis=1), 90.0) for one in loaded if len(one)]
    farthest = float(max(reach, default=0.0))
    if farthest <= LABORATORY_M:
        return 1.0
    notes.append(f"points of application reach {farthest:.0f} without a unit; taken as mm")
    return 1e-3


def _moment_reference(
    table: ForceTable, force: Array, point: Array, moment: Array, name: str
) -> MomentReference:
    """Unit and point of the moments of a set's loaded samples, (S, 3) each.

    Raises:
        FileFormatError: No point explains them.
    """
    if len(force) == 0 or not moment.any():
        return MomentReference(1.0 if table.newton_metres is None else table.newton_metres, None)
    if table.at_point:
        return reference_at_point(force, point, moment)
    found = reference_of_moments(force, point, moment, table.newton_metres)
    if found is None:
        reason = f"set '{name}': moments do not agree with the points of application; export it again"
        raise FileFormatError(table.path, reason)
    return found


def _readings(
    table: ForceTable, name: str, wrench: Array, point: Array, origin: Array, options: CaptureOptions
) -> PlateReadings:
    """Readings of a set; ``wrench`` is (S, 6) about ``origin``, ``point`` (S, 3) the point of application."""
    threshold_n, offset = options.cop_threshold_n, np.zeros(6)
    pressure = np.where((wrench[:, 2] >= threshold_n)[:, None], point, np.nan)
    found = find_tare(wrench, table.rate_hz) if options.tare else None
    if found is not None and abs(found.offset[2]) >= _LEAST_OFFSET_N:
        wrench, offset = remove_tare(wrench, found), found.offset
        pressure = centre_of_pressure(wrench[:, :3], wrench[:, 3:], origin, _UP, threshold_n)
    return PlateReadings(
        name,
        table.rate_hz,
        table.start_time_s,
        origin,
        wrench[:, :3],
        wrench[:, 3:],
        pressure,
        threshold_n,
        offset=offset,
    )
