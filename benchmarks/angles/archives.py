"""Angles of three walks, read as Plug-in Gait reads them, against those that the files hold.

The files' angles were computed by the laboratories. Of every joint and plane two numbers count: the mean difference,
which axes make, and the RMS of what is left of it, which skin makes: Plug-in Gait's axes are renewed with the markers
of every frame. The same numbers in the body's own axes, and without the file's widths and offsets, are for information.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.scale import scale

MOST_OFFSET_DEG = (4.0, 6.0, 6.0)
"""Sagittal, frontal and transverse plane."""

MOST_RMS_DEG = 3.0

PLANES = ("sagittal", "frontal", "transverse")

JOINTS = {
    "Pelvis": ("-pelvis_tilt", "-pelvis_list", "pelvis_rotation"),
    "Hip": ("hip_flexion", "hip_adduction", "hip_rotation"),
    "Knee": ("knee_angle", "knee_adduction", "knee_rotation"),
    "Ankle": ("ankle_angle", "-subtalar_angle", "ankle_rotation"),
}
"""Coordinates that the three columns of each joint compare with on the right, with their signs."""


@dataclass(frozen=True)
class Archive:
    """A walk whose file holds Plug-in Gait's angles.

    Attributes:
        name: For the rows.
        folder, trial, static: Files below the data folder; None without a static trial.
        mass_kg: Of the person.
    """

    name: str
    folder: str
    trial: str
    static: str | None
    mass_kg: float

    def read(self, data: Path) -> tuple[Capture, Capture | None]:
        """The walk and the static trial, without plates, which the marker filter does not follow."""
        walk = replace(read_capture(data / self.folder / self.trial), plates=())
        return walk, None if self.static is None else read_capture(data / self.folder / self.static)


ARCHIVES = (
    Archive(
        "HC032A", "biomechzoo_walk_turn", "HC032A_Straight_HC032A03.c3d", "HC032A_Static_HC032A01.c3d", 60.3
    ),
    Archive(
        "HC044A", "biomechzoo_walk_turn", "HC044A_Straight_HC044A15.c3d", "HC044A_Static_HC044A01.c3d", 39.4
    ),
    Archive("cgm24", "cgm24_lowerlimb_walk", "CGM24_Walking01.c3d", None, 77.6),
)


def archive_rows(data: Path) -> list[Check]:
    """The rows of all captures.

    Args:
        data: Folder of the reference captures.
    """
    return [row for one in ARCHIVES for row in _rows(one, data)]


def _rows(one: Archive, data: Path) -> list[Check]:
    walk, static = one.read(data)
    subject = scale(static, [walk], mass_kg=one.mass_kg)
    pig = differences(walk, followed(walk, subject, "pig"))
    rows = []
    for joint in JOINTS:
        for plane, most in enumerate(MOST_OFFSET_DEG):
            name = f"{one.name}, {joint.lower()}, {PLANES[plane]} plane"
            offset, rms = worst(pig, joint, plane)
            rows.append(Check(f"{name}: mean difference", offset, most, "<=", "°"))
            rows.append(Check(f"{name}: RMS without the mean", rms, MOST_RMS_DEG, "<=", "°"))
    bare = replace(walk, processing={})
    for told, found in (
        ("in the ISB's axes", differences(walk, followed(walk, subject, "isb"))),
        ("in the body's own axes", differences(walk, followed(walk, subject, "model"))),
        ("without the file's widths and offsets", differences(walk, followed(bare, subject, "pig"))),
    ):
        for plane in range(len(PLANES)):
            most = max(worst(found, joint, plane)[0] for joint in JOINTS)
            rows.append(
                information(f"{one.name}, {told}, {PLANES[plane]} plane: largest mean difference", most, "°")
            )
    return rows


def followed(walk: Capture, subject: Subject, angles: str) -> Reconstruction:
    """The walk by the marker filter, smoothed.

    Args:
        walk: The walk, without plates.
        subject: The person.
        angles: How angles are read.
    """
    settings = ReconstructSettings(filter="kinematic", smooth=True, angles=angles)
    return reconstruct(walk, subject, settings=settings)


def differences(walk: Capture, found: Reconstruction) -> dict[str, Array]:
    """(T, 3) ours minus the file's by joint and side ("RHip"), degrees within half a turn; NaN where it has none."""
    derived = {point.name: point for point in walk.derived if point.kind == "angle"}
    away = {}
    for joint, columns in JOINTS.items():
        for side in "RL":
            reference = derived[f"{side}{joint}Angles"].values
            reference = np.where((reference == 0.0).all(axis=1)[:, None], np.nan, reference)
            ours = np.column_stack([_coordinate(found, column, side, joint) for column in columns])
            away[side + joint] = (ours - reference + 180.0) % 360.0 - 180.0
    return away


def worst(away: dict[str, Array], joint: str, plane: int) -> tuple[float, float]:
    """Largest mean difference of both sides, without sign, and largest RMS without the mean, degrees.

    Args:
        away: The differences.
        joint: Key of :data:`JOINTS`.
        plane: Column.
    """
    both = [away[side + joint][:, plane] for side in "RL"]
    return max(abs(float(np.nanmean(one))) for one in both), max(float(np.nanstd(one)) for one in both)


def _coordinate(found: Reconstruction, column: str, side: str, joint: str) -> Array:
    """(T,) a coordinate in degrees with Plug-in Gait's sign, which turns round on the left of the pelvis."""
    sign, name = (-1.0, column[1:]) if column.startswith("-") else (1.0, column)
    if joint != "Pelvis":
        name = f"{name}_{side.lower()}"
    elif side == "L" and name != "pelvis_tilt":
        sign = -sign
    return sign * np.rad2deg(found.angle(name))
