"""A reconstruction as the files OpenSim opens: angles.mot, angles_lab.mot, torques.sto, reactions.mot, markers.trc.

OpenSim's axes: x forward, y up, z right. In angles.mot the pelvis's angles are in the frame of progression;
beside reactions.mot or markers.trc they belong in the laboratory's axes, as in angles_lab.mot.

Only the range from the first to the last tracked frame is written. OpenSim's reader of tables refuses NaN, so frames
inside that range with a value missing are left out of the tables (the times show it; OpenSim interpolates), and
columns that are never known are left out altogether; markers.trc keeps every frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from mbkf.conventions import SIDES, Array, BoolArray
from mbkf.io.axes import rotation_to_world
from mbkf.io.contacts import Source
from mbkf.io.dimensions import AXES, labels_of
from mbkf.io.quantities import Quantity
from mbkf.io.records import MarkerTrajectories
from mbkf.io.results import QUANTITIES, Reconstruction
from mbkf.io.storage import Table, write_storage
from mbkf.io.trc import write_trc
from mbkf.numerics.cardan import quaternion_matrices

ANGLES_FILE, ANGLES_LAB_FILE, TORQUES_FILE = "angles.mot", "angles_lab.mot", "torques.sto"
REACTIONS_FILE, MARKERS_FILE = "reactions.mot", "markers.trc"

TITLES = {
    ANGLES_FILE: "Coordinates",
    ANGLES_LAB_FILE: "Coordinates",
    TORQUES_FILE: "Inverse Dynamics Generalized Forces",
    REACTIONS_FILE: "Ground reactions",
}
"""Titles of the tables; those of angles are in degrees."""

PELVIS_PLACE = ("pelvis_tx", "pelvis_ty", "pelvis_tz")
"""OpenSim's coordinates of the pelvis's place, forward, up and to the right."""

OPENSIM_FILES = (*TITLES, MARKERS_FILE)
"""Names of the files."""


def write_opensim(reconstruction: Reconstruction, folder: Path, run_id: str = "") -> None:
    """Writes the files into a folder that exists.

    Args:
        reconstruction: The result.
        folder: The folder.
        run_id: Number that the files of one run share, for the tables' headers.

    Raises:
        OSError: A file cannot be written.
    """
    for name in TITLES:
        table = opensim_table(reconstruction, name)
        run = {"Run": run_id} if run_id else {}
        write_storage(replace(table, header={**table.header, **run}), folder / name)
    write_trc(reconstructed_markers(reconstruction), folder / MARKERS_FILE)


def opensim_table(reconstruction: Reconstruction, name: str) -> Table:
    """A table by the name of its file: the quantities that declare a column there; reactions begin with the loads.

    Angles are in degrees and count from OpenSim's zeros; the pelvis's translations, in m, are those of its origin in
    OpenSim. Moments are named as OpenSim's inverse dynamics names them;
    those that bear the name of OpenSim's lumbar joint are the trunk's moments at that joint's level, and those at other
    levels of the spine follow (:func:`_trunk_columns`).
    """
    r = reconstruction
    in_degrees = TITLES[name] == "Coordinates"
    columns = _load_columns(r) if name == REACTIONS_FILE else {}
    for one in QUANTITIES.values():
        if one.column is not None and one.column.file == name:
            columns |= _columns(r, one, in_degrees)
    columns = _trunk_columns(r, columns) if name == TORQUES_FILE else columns
    columns = _as_opensim_counts(r, columns) if in_degrees else columns
    values = np.column_stack(list(columns.values()))
    known = np.logical_or.reduce(np.isfinite(values[r.tracked]), axis=0)
    rows = r.tracked & np.isfinite(values[:, known]).all(axis=1)
    kept = tuple(column for column, finite in zip(columns, known, strict=True) if finite)
    header = {"Trial": r.trial, "Software": f"mbkf {r.version}", "LaterFrames": r.later_frames}
    return Table(
        kept, r.times_s[rows], values[rows][:, known], in_degrees, TITLES[name], header | _header(r, name)
    )


def _header(r: Reconstruction, name: str) -> dict[str, str]:
    """Entries of a table's header besides those of every table."""
    if name == TORQUES_FILE:
        levels = ", ".join(
            f"{column} {level}" for column, level in zip(r.level_columns, r.level_names, strict=True)
        )
        return {"AnglesRead": "model", **({"TrunkLevels": levels} if levels else {})}
    if name == REACTIONS_FILE:
        loads, shown = r.loads, _shown(r)
        estimated = [loads.names[k] for k in shown if (loads.source[:, k] >= Source.SHARED).any()]
        return {
            "Contacts": ", ".join(loads.names[k] for k in shown),
            "Estimated": ", ".join(estimated) or "none",
        }
    direction = "laboratory"
    if name == ANGLES_FILE:
        turns = r.heading_rad is not None and r.frames and np.ptp(r.heading_rad) > 0.0
        heading = 0.0 if r.heading_rad is None or not r.frames else float(np.rad2deg(r.heading_rad[0]))
        direction = f"{r.direction}, " + (
            "turning with it" if turns else f"{heading:.6g} degrees from the x axis"
        )
    return {"Direction": direction, "AnglesRead": r.angles_read, "AnglesZero": r.angles_zero}


def _columns(r: Reconstruction, one: Quantity, in_degrees: bool) -> dict[str, Array]:
    """Columns of a declared quantity, world axes as OpenSim's; none where the result lacks it.

    Args:
        r: The result.
        one: The quantity.
        in_degrees: Angles are written in degrees.
    """
    assert one.column is not None
    values = getattr(r, one.name)
    if values is None and one.column.instead:
        values = getattr(r, one.column.instead)
    if values is None:
        return {}
    if one.axes[-1] == "xyz":
        values = values @ rotation_to_world("y")
    found = {}
    names = {axis: getattr(r, AXES[axis].names) for axis in one.axes[1:] if not AXES[axis].labels}
    columns = values.reshape(len(values), -1).T
    for words, column in zip(labels_of(one.axes[1:], names), columns, strict=True):
        unit = one.unit.of(words[one.axes[-1]])
        shown = {"side": words.get("foot", " ")[0], "load": "force" if unit == "N" else "moment", **words}
        degrees = in_degrees and unit == "rad"
        found[one.column.name.format(**shown)] = np.rad2deg(column) if degrees else column
    return found


def _as_opensim_counts(r: Reconstruction, columns: Mapping[str, Array]) -> dict[str, Array]:
    """Columns of coordinates counted from OpenSim's zeros, the root's place that of OpenSim's origin.

    Args:
        r: The result.
        columns: (T,) values by coordinate, degrees and m.
    """
    found = dict(columns)
    for name, zero in r.opensim_zeros_rad.items():
        if name in found:
            found[name] = found[name] + np.rad2deg(zero)
    if r.opensim_origin_m:
        from_root = quaternion_matrices(r.q[:, 3:7]) @ np.array(r.opensim_origin_m) @ rotation_to_world("y")
        for name, along in zip(PELVIS_PLACE, from_root.T, strict=True):
            found[name] = found[name] + along
    return found


def _trunk_columns(r: Reconstruction, columns: Mapping[str, Array]) -> dict[str, Array]:
    """Columns of torques with the trunk's moments at levels of the spine; other columns stay as they are.

    Bottom-up moments have columns where they are known in every frame in which the torques are: a table has no gaps.

    Args:
        r: The result.
        columns: (T,) values by column.
    """
    found = dict(columns)
    if r.trunk_moments is None:
        return found
    frames = np.isfinite(np.column_stack([np.zeros(r.frames), *columns.values()])).all(axis=1)
    for (way, level, turn), values in zip(
        product(AXES["way"].labels, r.level_columns, AXES["turn"].labels),
        r.trunk_moments.reshape(r.frames, -1).T,
        strict=True,
    ):
        measured = way == "bottom_up"
        if not measured or np.isfinite(values[frames]).all():
            found["_".join([level, *([way] if measured else []), turn, "moment"])] = values
    return found


def _load_columns(r: Reconstruction) -> dict[str, Array]:
    """Force, point and moment on each foot and on every other part that ever bears load, in OpenSim's axes.

    The point is the centre of pressure, and while the part is not loaded the last one (the first one before
    it was ever loaded), so that nothing jumps where OpenSim interpolates. The moment is that about the
    point, so that force, point and moment together are the wrench exactly. The header names the parts in the order of
    the columns, and those that are estimated at any time.
    """
    R, loads, columns = rotation_to_world("y"), r.loads, {}
    for k, begins in zip(_shown(r), load_columns(r).values(), strict=True):
        force, moment = loads.wrench[:, k, :3], loads.wrench[:, k, 3:]
        point = _filled(loads.point_m[:, k])
        about_point = moment - np.cross(point, force)
        for begin, vectors in zip(begins, (force, point, about_point), strict=True):
            for axis, values in zip("xyz", (vectors @ R).T, strict=True):
                columns[f"{begin}{axis}"] = values
    return columns


def load_columns(r: Reconstruction) -> dict[str, tuple[str, str, str]]:
    """Beginnings of the columns of force, point and moment in reactions.mot, by the part that bears the load."""
    suffixes = [*SIDES, *r.support_names]
    return {
        r.loads.names[k]: (
            f"ground_force_{suffixes[k]}_v",
            f"ground_force_{suffixes[k]}_p",
            f"ground_torque_{suffixes[k]}_",
        )
        for k in _shown(r)
    }


def _shown(r: Reconstruction) -> list[int]:
    """Numbers of the loads that reactions.mot has: the feet and every other part that ever bears load."""
    source = r.loads.source
    return [k for k in range(source.shape[1]) if k < len(SIDES) or source[:, k].any()]


def reconstructed_markers(reconstruction: Reconstruction) -> MarkerTrajectories:
    """The reconstructed body's markers in the range of tracked frames, missing where it is not followed."""
    r = reconstruction
    first, last = _tracked_range(r.tracked)
    positions = np.where(r.tracked[:, None, None], r.predicted_m, np.nan)[first:last]
    start = r.times_s[first] if last > first else 0.0
    return MarkerTrajectories(r.marker_names, positions, r.rate_hz, float(start))


def _tracked_range(tracked: BoolArray) -> tuple[int, int]:
    """First tracked frame and the one after the last; (0, 0) where there is none."""
    found = np.flatnonzero(tracked)
    return (int(found[0]), int(found[-1]) + 1) if len(found) else (0, 0)


def _filled(points: Array) -> Array:
    """Points (T, 3), gaps filled by the last one before, or the first one after; zero where there is none."""
    seen = ~np.isnan(points).any(axis=1)
    if not seen.any():
        return np.zeros_like(points)
    latest = np.maximum.accumulate(np.where(seen, np.arange(len(points)), -1))
    return points[np.where(latest < 0, int(np.argmax(seen)), latest)]
