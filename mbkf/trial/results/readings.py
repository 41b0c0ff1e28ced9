"""The axes that a trial's angles are read in: the body's own, or those of a convention on a person's body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.angle_reading import AngleReading
from mbkf.model.body import Body
from mbkf.model.description import Landmark
from mbkf.model.isb_axes import isb_axes
from mbkf.model.plug_in_gait import THORAX, measured_of, plug_in_gait
from mbkf.model.protocol import load_protocol, protocol_names

MODEL, ISB, PIG = "model", "isb", "pig"
ANGLES = (MODEL, ISB, PIG)
"""Ways to read angles that can be asked for."""


AXES, STATIC = "axes", "static"
ANGLES_ZERO = (AXES, STATIC)
"""Zero of angles: a joint whose two sets of axes coincide, or the posture of the static trial."""


@dataclass(frozen=True)
class Point:
    """A point that axes are made of.

    Attributes:
        name: Its name, without the side.
        marker: Name of Plug-in Gait's marker on it, without the side; "": no marker.
        landmark: The body's landmark, "" for a wand, which stands nowhere in particular.
        sided: Whether there are two.
        needed: Whether a body without the landmark has no such axes at all.
    """

    name: str
    marker: str
    landmark: str
    sided: bool = True
    needed: bool = True


POINTS = (
    Point("asis", "ASI", "asis"),
    Point("psis", "PSI", "psis"),
    Point("sacrum", "SACR", "sacrum", sided=False),
    Point("hip_centre", "", "hip_centre"),
    Point("thigh_wand", "THI", ""),
    Point("knee", "KNE", "knee_lateral"),
    Point("knee_medial", "", "knee_medial"),
    Point("knee_centre", "", "knee_centre"),
    Point("shank_wand", "TIB", ""),
    Point("ankle", "ANK", "ankle_lateral"),
    Point("ankle_medial", "", "ankle_medial"),
    Point("ankle_centre", "", "ankle_centre"),
    Point("heel", "HEE", "heel"),
    Point("toe", "TOE", "metatarsal_2"),
    *(
        Point(landmark, marker, landmark, sided=False, needed=False)
        for landmark, marker in zip(THORAX, ("C7", "T10", "CLAV", "STRN"), strict=True)
    ),
)

WANDS = {"thigh_wand": "thigh", "shank_wand": "shank"}
"""Segments of the wands, without the side."""

SIDES, UNPAIRED = (("R", "right_"), ("L", "left_")), (("", ""),)
"""Letters of markers and beginnings of names."""


def angle_reading(asked: str, model: Body, subject: Subject, processing: Mapping[str, float]) -> AngleReading:
    """The reading that is asked for.

    Args:
        asked: One of :data:`ANGLES`.
        model: The person's body.
        subject: The person, with their markers.
        processing: Statements of the capture about the person (:attr:`mbkf.io.records.Capture.processing`).

    Raises:
        UnknownName: The reading does not exist.
        InvalidInput: The body lacks a landmark that the axes are made of.
    """
    if asked not in ANGLES:
        raise UnknownName("reading of angles", asked, ANGLES)
    if asked == MODEL:
        return AngleReading()
    if asked == ISB:
        return isb_axes(anatomical_places(model, subject))
    return plug_in_gait(anatomical_places(model, subject), measured_of(processing))


def zero_posture(asked: str, subject: Subject) -> Array | None:
    """(nq,) the posture in which angles are to be zero; None: zero by the axes.

    Raises:
        UnknownName: The zero does not exist.
        InvalidInput: The person was scaled without a static trial.
    """
    if asked not in ANGLES_ZERO:
        raise UnknownName("zero of angles", asked, ANGLES_ZERO)
    if asked == AXES:
        return None
    if subject.standing_q is None:
        raise InvalidInput(
            "the subject holds no standing posture that angles could be zero in; scale it anew with a static trial "
            "('mbkf scale STATIC'), or leave --angles-zero out"
        )
    return subject.standing_q


def anatomical_places(model: Body, subject: Subject) -> dict[str, Array]:
    """Places of points in the body's neutral posture: of the marker on each, else of the body's landmark.

    Where the person wears markers on both PSIS, the sacrum is between them. Wands are left out without a marker.

    Args:
        model: The person's body.
        subject: The person.

    Returns:
        (3,) places by name, ``right_`` and ``left_`` before those that there are two of, m.

    Raises:
        InvalidInput: The body lacks a landmark.
    """
    by_landmark = _markers_by_landmark(subject)
    by_name = {name: marker for marker in subject.markers for name in (*marker.aliases, marker.name)}
    rotations, origins = model.placements(model.neutral())

    def placed(segment: str, position_m: Array) -> Array:
        joint = model.joint(segment).joint_id
        return np.asarray(origins[joint] + rotations[joint] @ position_m)

    places: dict[str, Array] = {}
    worn: set[str] = set()
    for point in POINTS:
        for letter, side in SIDES if point.sided else UNPAIRED:
            if not point.needed and side + point.landmark not in model.description.landmarks:
                continue
            landmark = _landmark(model, side + point.landmark) if point.landmark else None
            segment = side + WANDS[point.name] if landmark is None else landmark.segment
            named = by_name.get(letter + point.marker) if point.marker else None
            found = [m for m in (named, by_landmark.get(side + point.landmark)) if m and m.segment == segment]
            if found:
                worn.add(side + point.name)
                places[side + point.name] = placed(segment, found[0].position_m)
            elif landmark is not None:
                scale = model.axis_scale(model.description.segment(segment))
                places[side + point.name] = placed(segment, scale * landmark.position_m)
    if {"right_psis", "left_psis"} <= worn and "sacrum" not in worn:
        places["sacrum"] = 0.5 * (places["right_psis"] + places["left_psis"])
    return places


def _landmark(model: Body, name: str) -> Landmark:
    """A landmark of the body.

    Raises:
        InvalidInput: The subject file holds no posture of a static trial.
    """
    if name not in model.description.landmarks:
        raise InvalidInput(
            f"the body '{model.description.name}' has no landmark '{name}', which these angles need; "
            "use --angles model"
        )
    return model.description.landmarks[name]


def _markers_by_landmark(subject: Subject) -> dict[str, SubjectMarker]:
    """The person's markers by the landmark that their protocol places them on, if it is one that comes with mbkf."""
    if subject.protocol not in protocol_names():
        return {}
    landmarks = {marker.name: marker.landmark for marker in load_protocol(subject.protocol).markers}
    return {landmarks[m.name]: m for m in subject.markers if landmarks.get(m.name)}
