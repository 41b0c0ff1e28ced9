"""Direction: pelvic angles of two walks along y against Plug-in Gait, and of the same captures turned.

Plug-in Gait tells the pelvis's angles against the laboratory's axis nearest to the walk; the constant that this and
another pelvic plane make is removed. Its pelvis is the plane of three markers. Rows "as written" are the angles that
mbkf's files hold, those of the body's pelvis; rows "in Plug-in Gait's plane" are the same motion in axes fixed to that
pelvis along the person's LASI, RASI and SACR, which is like with like: a plane tilted by 20° exchanges a third of the
rotation with obliquity.

No public capture at hand turns, so the walks found are bent: led round a quarter of a circle, every frame moved and
turned as a whole. Tilt and obliquity should stay those of the straight walk; rotation also holds what smoothing takes
from the bend.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.dynamic.captures import SOURCES
from benchmarks.references import Curve, agreement, rms
from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import cardan_angles, quaternion_matrices
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.progression import kind_of, progression_of
from mbkf.trial.scale import scale

TURNS_DEG = (30.0, 90.0, 180.0)
"""Angles by which the captures are turned about the vertical."""

LEAST_R, LEAST_RANGE_DEG, MOST_RMS_DEG = 0.9, 4.0, 2.5
"""Bounds against Plug-in Gait: correlation where its curve ranges over more than an angle, and RMS without the mean."""

BEND_RADIUS_M = 1.0
"""Of the quarter of a circle."""

SAME_DEG = 1e-6
"""Largest difference of an angle between a capture and the same capture turned."""

SIGNS = {"pelvis_tilt": -1.0, "pelvis_list": 1.0, "pelvis_rotation": -1.0}
"""Our coordinates in the order of Plug-in Gait's left pelvis (forward tilt, left side up, left side forward)."""

PLUG_IN_GAIT_PELVIS = "LPelvisAngles"


WALKS = ("biomechzoo HC032A", "biomechzoo HC044A")
"""Straight walks with a standing trial, by their names among the dynamic benchmark's captures."""


def direction_rows(data: Path) -> list[Check]:
    """Both walks, as they are and turned, with default settings.

    Args:
        data: Folder of the public reference captures.
    """
    return [row for name in WALKS for row in _walk_rows(name, data)]


def _walk_rows(name: str, data: Path) -> Iterator[Check]:
    source = SOURCES[name]
    static, trial = (read_capture(data / source.folder / str(file)) for file in (source.static, source.trial))
    subject = scale(static, mass_kg=source.mass_kg)
    found = reconstruct(trial, subject)
    theirs = plug_in_gait_pelvis(trial)
    written = np.column_stack([sign * np.rad2deg(found.angle(name)) for name, sign in SIGNS.items()])
    yield from against(f"{name} as written", found.times_s, written, theirs)
    own = np.rad2deg(in_marker_plane(found))
    yield from against(f"{name} in Plug-in Gait's plane", found.times_s, own, theirs)
    yield from _bent_rows(name, found)
    for angle in TURNS_DEG:
        again = turned(trial, angle)
        yield _same(f"{name} turned by {angle:g}°", found, again, subject)
        anew = scale(turned(static, angle), mass_kg=source.mass_kg)
        yield _same(f"{name} turned by {angle:g}° and scaled anew", found, again, anew)


def _same(name: str, found: Reconstruction, capture: Capture, subject: Subject) -> Check:
    change = np.rad2deg(largest_change(found, reconstruct(capture, subject)))
    return Check(f"{name}: largest change of an angle", change, SAME_DEG, "<=", "°")


def _bent_rows(name: str, found: Reconstruction) -> Iterator[Check]:
    model = HumanModel.of(found.subject)
    clinical, q = ClinicalAngles(model), bent(found)
    frame = progression_of(model, q, found.times_s)
    angles = clinical.angles(clinical.against(frame.heading_rad, q))
    kept = float(kind_of(frame.direction, frame.heading_rad) == "turning path")
    yield Check(f"{name} round a bend: taken for a turn", kept, 1.0, ">=")
    for coordinate in SIGNS:
        change = angles[:, clinical.names.index(coordinate)] - found.angle(coordinate)
        rms_deg = rms(np.rad2deg(np.angle(np.exp(1j * change))))
        row = f"{name} round a bend: {coordinate.replace('_', ' ')}, RMS change"
        bounded = coordinate != "pelvis_rotation"
        yield Check(row, rms_deg, MOST_RMS_DEG, "<=", "°") if bounded else information(row, rms_deg, "°")


def bent(found: Reconstruction) -> Array:
    """(T, nq) a straight walk led round a quarter of a circle to the left, in the middle of its way.

    The way along the straight line becomes the way along the bent one; what is beside it stays as far beside it, and
    the body turns with the way.
    """
    clinical = ClinicalAngles(HumanModel.of(found.subject))
    assert found.heading_rad is not None
    ahead = found.heading_rad[0]
    along = found.q[:, :2] @ [np.cos(ahead), np.sin(ahead)]
    beside = found.q[:, :2] @ [-np.sin(ahead), np.cos(ahead)]
    way = np.linspace(np.nanmin(along) - 0.1, np.nanmax(along) + 0.1, 5000)
    arc = BEND_RADIUS_M * np.pi / 2
    heading = np.pi / 2 * np.clip((way - way.mean()) / arc + 0.5, 0.0, 1.0)
    step = way[1] - way[0]
    line = np.cumsum(step * np.column_stack([np.cos(heading), np.sin(heading)]), axis=0)
    turn = np.interp(along, way, heading)
    q = clinical.against(ahead - turn, found.q)
    for axis, normal in enumerate((-np.sin(turn), np.cos(turn))):
        q[:, axis] = np.interp(along, way, line[:, axis]) + beside * normal
    return q


def against(name: str, times_s: Array, ours: Array, theirs: Array) -> Iterator[Check]:
    """Rows of three angles against a reference: correlation where it moves enough, and RMS without the mean.

    Args:
        name: Whose, for the rows.
        times_s: (T,) times.
        ours: (T, 3) angles, degrees.
        theirs: (T, 3) the reference's.
    """
    for k, angle in enumerate(SIGNS):
        found = agreement(Curve(times_s, ours[:, k]), Curve(times_s, theirs[:, k]))
        row = f"{name}: {angle.replace('_', ' ')}"
        if np.ptp(theirs[:, k]) > LEAST_RANGE_DEG:
            yield Check(f"{row}, correlation", found.r, LEAST_R, ">=")
        else:
            yield information(f"{row}, correlation", found.r)
        yield Check(f"{row}, RMS without the mean", found.rms_without_mean, MOST_RMS_DEG, "<=", "°")


def largest_change(one: Reconstruction, other: Reconstruction) -> float:
    """Largest difference of any clinical angle of two reconstructions, rad; whole turns do not count."""
    turns = [
        i
        for i, name in enumerate(one.coordinate_names)
        if not name.startswith("pelvis_t") or name == "pelvis_tilt"
    ]
    change = np.angle(np.exp(1j * (other.angles - one.angles)[:, turns]))
    return float(np.nanmax(np.abs(change)))


def plug_in_gait_pelvis(capture: Capture) -> Array:
    """(T, 3) tilt, obliquity and rotation of the left pelvis that Plug-in Gait stored in a C3D file, degrees.

    Raises:
        UnknownName: The file holds none.
    """
    stored = {point.name: point.values for point in capture.derived}
    if PLUG_IN_GAIT_PELVIS not in stored:
        raise UnknownName("angle", PLUG_IN_GAIT_PELVIS, stored, capture.path)
    return stored[PLUG_IN_GAIT_PELVIS]


def in_marker_plane(found: Reconstruction) -> Array:
    """(T, 3) Plug-in Gait's angles, rad, of axes fixed to the pelvis along the person's LASI, RASI and SACR."""
    place = {marker.name: np.asarray(marker.position_m) for marker in found.subject.markers}
    left = place["LASI"] - place["RASI"]
    up = np.cross(0.5 * (place["LASI"] + place["RASI"]) - place["SACR"], left)
    y, z = left / np.linalg.norm(left), up / np.linalg.norm(up)
    axes = np.column_stack([np.cross(y, z), y, z])
    assert found.heading_rad is not None
    cos, sin = np.cos(found.heading_rad), np.sin(found.heading_rad)
    back = np.zeros((found.frames, 3, 3))
    back[:, 0, 0], back[:, 0, 1], back[:, 1, 0], back[:, 1, 1], back[:, 2, 2] = cos, sin, -sin, cos, 1.0
    R = back @ quaternion_matrices(found.q[:, 3:7]) @ axes
    order = np.array([1, 0, 2])
    yxz = cardan_angles(R[:, order][:, :, order], np.array(-1.0))
    return np.asarray(yxz * [1.0, 1.0, -1.0])


def turned(capture: Capture, angle_deg: float) -> Capture:
    """The capture in a laboratory whose axes lie otherwise: markers and plates turned about the vertical."""
    c, s = np.cos(np.deg2rad(angle_deg)), np.sin(np.deg2rad(angle_deg))
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    markers = replace(capture.markers, positions_m=capture.markers.positions_m @ R.T)
    return replace(
        capture, markers=markers, plates=tuple(_turned_plate(plate, R) for plate in capture.plates)
    )


def _turned_plate(plate: PlateReadings, R: Array) -> PlateReadings:
    return replace(
        plate,
        origin_m=R @ plate.origin_m,
        force_n=plate.force_n @ R.T,
        moment_nm=plate.moment_nm @ R.T,
        centre_of_pressure_m=plate.centre_of_pressure_m @ R.T,
        corners_m=None if plate.corners_m is None else plate.corners_m @ R.T,
        offset=(plate.offset.reshape(2, 3) @ R.T).ravel(),
    )
