"""Angles and moments of the references, under our names and signs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.real_truth.persons import IN_C3D, OPENSIM, RBDL, RealPerson, RealTrial
from benchmarks.references import PLUG_IN_GAIT, Curve, in_degrees
from mbkf.conventions import SIDES, Array
from mbkf.io.records import Capture
from mbkf.io.storage import Table, read_storage

OPENSIM_ANGLES = (
    "hip_flexion", "hip_adduction", "knee_angle", "ankle_angle", "arm_flex", "elbow_flex",
)  # fmt: skip
"""Coordinates with a side that are compared with OpenSim's; rotations about long axes are left out."""

LUMBAR = ("lumbar_extension", "lumbar_bending", "lumbar_rotation")

MOMENTS = {"hip_flexion": "HipMoment", "knee_angle": "KneeMoment", "ankle_angle": "AnkleMoment"}
"""Our coordinates, and the points whose first component holds the moment; extension counts positive there."""

PER_KG = 1e-3
"""Plug-in Gait writes N mm per kg of body mass."""

RBDL_COLUMNS = {"hip_flexion": (7, 16, -1.0), "knee_angle": (10, 19, 1.0), "ankle_angle": (13, 22, -1.0)}
"""Column of the first of three rotations x, y, z, right and left, after the time; sign of the flexion (y is left)."""


@dataclass(frozen=True)
class Curves:
    """Curves of a reference.

    Attributes:
        angles: By coordinate, degrees.
        moments: By coordinate, N m/kg; empty where the reference has none.
        residual_n: RMS force at the pelvis that inverse dynamics left; NaN where none is stored.
    """

    angles: dict[str, Curve]
    moments: dict[str, Curve]
    residual_n: float = float("nan")


def read_reference(data: Path, person: RealPerson, one: RealTrial, capture: Capture) -> Curves:
    """The reference of a trial.

    Args:
        data: Folder of the reference captures.
        person: The person.
        one: The trial.
        capture: The trial as read.
    """
    readers: dict[str, Callable[[], Curves]] = {
        OPENSIM: lambda: _opensim(data / person.folder, one, person.mass_kg),
        IN_C3D: lambda: _in_c3d(capture, one.reference.suffix),
        RBDL: lambda: _rbdl(data / person.folder / one.reference.angles),
    }
    return readers[one.reference.kind]()


def _opensim(folder: Path, one: RealTrial, mass_kg: float) -> Curves:
    angles = in_degrees(read_storage(folder / one.reference.angles))
    columns = {_short(name): angles.columns[:, i] for i, name in enumerate(angles.names)}
    wanted = [*(f"{name}_{side}" for name in OPENSIM_ANGLES for side in SIDES), *LUMBAR]
    found = {
        name: Curve(angles.times_s, columns[name] * (one.reference.knee if name.startswith("knee") else 1.0))
        for name in wanted
        if name in columns
    }
    if not one.reference.moments:
        return Curves(found, {})
    table = read_storage(folder / one.reference.moments)
    moments = {}
    for name in PLUG_IN_GAIT:
        sign = one.reference.knee if name.startswith("knee") else 1.0
        for side in SIDES:
            values = sign * table.column(f"{name}_{side}_moment") / mass_kg
            moments[f"{name}_{side}"] = Curve(table.times_s, values)
    return Curves(found, moments, _residual(table))


def _residual(table: Table) -> float:
    forces = np.column_stack([table.column(f"pelvis_t{axis}_force") for axis in "xyz"])
    return float(np.sqrt((forces**2).sum(axis=1).mean()))


def _short(name: str) -> str:
    """A coordinate's name without the path that newer versions of OpenSim write."""
    return name.split("/")[-2] if name.endswith("/value") else name


def _in_c3d(capture: Capture, suffix: str) -> Curves:
    points = {point.name: point.values for point in capture.derived}
    times = capture.markers.times_s

    def curves(labels: dict[str, str], factor: float) -> dict[str, Curve]:
        found = {}
        for name, label in labels.items():
            for side in SIDES:
                values = points.get(side.upper() + label + suffix)
                if values is not None:
                    shown = np.where((values == 0.0).all(axis=1), np.nan, values[:, 0])
                    if np.isfinite(shown).any():
                        found[f"{name}_{side}"] = Curve(times, factor * shown)
        return found

    return Curves(curves(PLUG_IN_GAIT, 1.0), curves(MOMENTS, -PER_KG))


def _rbdl(path: Path) -> Curves:
    """Its joints turn about x, y, z in this order; flexion first, as ours, is y, x, z of the same rotation."""
    rows = np.loadtxt(path, delimiter=",")
    found = {}
    for name, (*columns, sign) in RBDL_COLUMNS.items():
        for side, column in zip(SIDES, columns, strict=True):
            found[f"{name}_{side}"] = Curve(
                rows[:, 0], sign * _flexion(rows[:, int(column) : int(column) + 3])
            )
    return Curves(found, {})


def _flexion(angles: Array) -> Array:
    """(T,) degrees, the first of the rotations y, x, z that equal those about x, y, z by ``angles`` (T, 3) rad."""
    turned: Array = Rotation.from_euler("XYZ", angles).as_euler("YXZ", degrees=True)
    return turned[:, 0]
