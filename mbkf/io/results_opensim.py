"""A reconstruction as the files OpenSim opens: angles.mot, angles_lab.mot, torques.sto, reactions.mot, markers.trc.

OpenSim's axes: x forward, y up, z right. In angles.mot the pelvis's angles are told in the frame of progression;
together with reactions.mot or markers.trc OpenSim needs them in the laboratory's axes, as in angles_lab.mot.

Only the range from the first to the last tracked frame is written. OpenSim's reader of tables refuses NaN, so frames
inside that range with a value missing are left out of the tables (the times show it; OpenSim interpolates), and
columns that are never known are left out altogether; markers.trc keeps every frame.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.conventions import SIDES, Array, BoolArray
from mbkf.io.axes import rotation_to_world
from mbkf.io.contacts import Source
from mbkf.io.records import MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.storage import Table, write_storage
from mbkf.io.trc import write_trc

MARKERS_FILE = "markers.trc"

TRANSLATIONS = ("pelvis_tx", "pelvis_ty", "pelvis_tz")
"""Coordinates that are lengths, not angles."""


def write_opensim(reconstruction: Reconstruction, folder: Path, run_id: str = "") -> None:
    """Writes the files into a folder that exists.

    Args:
        reconstruction: The result.
        folder: The folder.
        run_id: What the files of one run share; told in the tables' headers.

    Raises:
        OSError: A file cannot be written.
    """
    for name, table in _TABLES.items():
        made = table(reconstruction)
        told = {"Run": run_id} if run_id else {}
        write_storage(replace(made, header={**made.header, **told}), folder / name)
    write_trc(reconstructed_markers(reconstruction), folder / MARKERS_FILE)


def angles_table(reconstruction: Reconstruction) -> Table:
    """Clinical coordinates in degrees, the pelvis's translations in m."""
    r = reconstruction
    turns = r.heading_rad is not None and r.frames and np.ptp(r.heading_rad) > 0.0
    heading = 0.0 if r.heading_rad is None or not r.frames else float(np.rad2deg(r.heading_rad[0]))
    where = "turning with it" if turns else f"{heading:.6g} degrees from the x axis"
    return _angles(r, r.angles, f"{r.direction}, {where}")


def angles_lab_table(reconstruction: Reconstruction) -> Table:
    """The same with the pelvis's angles in the laboratory's axes, as OpenSim defines them."""
    r = reconstruction
    return _angles(r, r.angles if r.angles_lab is None else r.angles_lab, "laboratory")


def _angles(r: Reconstruction, angles: Array, direction: str) -> Table:
    lengths = np.isin(r.coordinate_names, TRANSLATIONS)
    values = np.where(lengths, angles, np.rad2deg(angles))
    table = _table(r, r.coordinate_names, values, "Coordinates", in_degrees=True)
    told = {"Direction": direction, "AnglesRead": r.angles_read, "AnglesZero": r.angles_zero}
    return replace(table, header={**table.header, **told})


def torques_table(reconstruction: Reconstruction) -> Table:
    """Moments named as OpenSim's inverse dynamics names them; the pelvis's columns are the residual."""
    r = reconstruction
    names = tuple(f"{name}_{'force' if name in TRANSLATIONS else 'moment'}" for name in r.coordinate_names)
    table = _table(r, names, r.moments, "Inverse Dynamics Generalized Forces")
    return replace(table, header={**table.header, "AnglesRead": "model"})


def reactions_table(reconstruction: Reconstruction) -> Table:
    """Force, point and moment on each foot and on every other part that ever bears load, in OpenSim's axes.

    The point is the centre of pressure, and while the part is not loaded the last one (the first one before
    it was ever loaded), so that nothing jumps where OpenSim interpolates. The moment is that about the
    point, so that force, point and moment together are the wrench exactly. The header tells the parts in the order of
    the columns, and which of them are estimated at any time.
    """
    r = reconstruction
    R = rotation_to_world("y")
    loads = r.loads
    shown = [k for k in range(len(loads.names)) if k < len(SIDES) or loads.source[:, k].any()]
    suffixes = [*SIDES, *r.support_names]
    names: list[str] = []
    columns: list[Array] = []
    for k in shown:
        force, moment = loads.wrench[:, k, :3], loads.wrench[:, k, 3:]
        point = _filled(loads.point_m[:, k])
        about_point = moment - np.cross(point, force)
        for prefix, vectors in (("force_{}_v", force), ("force_{}_p", point), ("torque_{}_", about_point)):
            names += [f"ground_{prefix.format(suffixes[k])}{axis}" for axis in "xyz"]
            columns.append(vectors @ R)
    table = _table(r, tuple(names), np.concatenate(columns, axis=1), "Ground reactions")
    estimated = [loads.names[k] for k in shown if (loads.source[:, k] >= Source.SHARED).any()]
    said = {
        "Contacts": ", ".join(loads.names[k] for k in shown),
        "Estimated": ", ".join(estimated) or "none",
    }
    return replace(table, header={**table.header, **said})


def reconstructed_markers(reconstruction: Reconstruction) -> MarkerTrajectories:
    """The reconstructed body's markers in the range of tracked frames, missing where it is not followed."""
    r = reconstruction
    first, last = _tracked_range(r.tracked)
    positions = np.where(r.tracked[:, None, None], r.predicted_m, np.nan)[first:last]
    start = r.times_s[first] if last > first else 0.0
    return MarkerTrajectories(r.marker_names, positions, r.rate_hz, float(start))


def _table(
    r: Reconstruction, names: tuple[str, ...], values: Array, title: str, in_degrees: bool = False
) -> Table:
    known = np.logical_or.reduce(np.isfinite(values[r.tracked]), axis=0)
    rows = r.tracked & np.isfinite(values[:, known]).all(axis=1)
    kept = tuple(name for name, finite in zip(names, known, strict=True) if finite)
    header = {"Trial": r.trial, "Software": f"mbkf {r.version}", "LaterFrames": r.later_frames}
    return Table(kept, r.times_s[rows], values[rows][:, known], in_degrees, title, header)


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


_TABLES: Mapping[str, Callable[[Reconstruction], Table]] = {
    "angles.mot": angles_table,
    "angles_lab.mot": angles_lab_table,
    "torques.sto": torques_table,
    "reactions.mot": reactions_table,
}

OPENSIM_FILES = (*_TABLES, MARKERS_FILE)
"""Names of the files."""
