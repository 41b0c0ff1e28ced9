"""Captures of a person whose marker set is not known yet, with their axes put right: by names, or by the posed body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.io.axes import axes_matrix, axes_text, rotation_to_world
from mbkf.io.records import AxesSource, Capture
from mbkf.marker_sets.frames import anchor_frames
from mbkf.marker_sets.inference import CLEAR_EVIDENCE
from mbkf.marker_sets.names import NameReading
from mbkf.marker_sets.places import worn_places
from mbkf.marker_sets.search import find_body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import DEFAULT_NOISE_M, DEFAULT_PLACEMENT_SD_M, ProtocolMarker
from mbkf.trial.axes.decision import AxesFinding, Verdict, applied, find_axes, may_follow
from mbkf.trial.axes.evidence import marker_places

SURE_NAME = 0.8
"""From this probability on a name tells where its marker is."""

CLEARLY = 15.0
"""How much likelier (logarithm) the body must be along another axis than along the file's for that axis to be up: one
found along a wrong axis falls 30 and more behind."""

UPS = ("z", "-z", "x", "-x", "y", "-y")


def upright_captures(
    captures: Sequence[Capture], readings: Mapping[str, NameReading], body: BodyDescription
) -> list[Capture]:
    """Captures of one person with their axes checked and put right.

    Names that tell where their markers are decide about up and handedness, as those of a protocol do. Where they do
    not, the axis is up along which a body explains the points clearly better; a mirror image is a person as well then.

    Args:
        captures: The captures.
        readings: What the names of their markers tell, by name.
        body: The reference body.

    Raises:
        InvalidInput: The axes or the unit of a capture cannot be right, and it is not clear what they are.
    """
    known = known_places(readings, body)
    found = [
        find_axes(one, marker_places(one.markers.names, _of(known, one), body), with_plates=False)
        for one in captures
    ]
    told = next((one for one in found if one.verdict in (Verdict.RIGHT, Verdict.PUT_RIGHT)), None)
    result = []
    for capture, finding in zip(captures, found, strict=True):
        own = finding
        if own.verdict is Verdict.UNKNOWN and told is None:
            own = told = _by_body(capture, body)
        elif told is not None and _alike(captures, found, told, capture) and may_follow(own, told.turn):
            own = told
        result.append(applied(capture, own))
    return result


def known_places(readings: Mapping[str, NameReading], body: BodyDescription) -> dict[str, ProtocolMarker]:
    """Markers whose names tell a landmark for sure, by name.

    Args:
        readings: What the names tell, by name.
        body: The reference body.
    """
    known = {}
    for name, reading in readings.items():
        best = reading.places[0] if reading.places else None
        if best is not None and best.probability >= SURE_NAME and best.landmark in body.landmarks:
            landmark = body.landmark(best.landmark)
            known[name] = ProtocolMarker(
                name,
                landmark.segment,
                landmark.position_m,
                "anatomical",
                DEFAULT_PLACEMENT_SD_M["anatomical"],
                DEFAULT_NOISE_M["anatomical"],
            )
    return known


def _of(known: Mapping[str, ProtocolMarker], capture: Capture) -> dict[str, ProtocolMarker]:
    return {name: known[name] for name in capture.markers.names if name in known}


def _alike(
    captures: Sequence[Capture], found: Sequence[AxesFinding], told: AxesFinding, capture: Capture
) -> bool:
    """Whether a capture was read with the axes of the one that told."""
    return any(
        (one.axes, one.axes_source) == (capture.axes, capture.axes_source)
        for one, finding in zip(captures, found, strict=True)
        if finding is told
    )


def _by_body(capture: Capture, body: BodyDescription) -> AxesFinding:
    """Which axis points up by the body that explains a frame's points best."""
    same = AxesFinding(Verdict.UNKNOWN, np.eye(3))
    if capture.axes_source in (AxesSource.UP_GIVEN, AxesSource.GIVEN):
        return same
    markers = capture.markers
    frame = anchor_frames([markers], markers.names, 1)[0]
    points = frame[~np.isnan(frame[:, 0])]
    old = axes_matrix(capture.axes)
    turns = {up: np.asarray(rotation_to_world(up)) for up in UPS}
    worth = {"z": -np.inf}
    try:
        standing = find_body(worn_places(body), points)
    except NotObservable:
        pass
    else:
        if standing.evidence >= CLEAR_EVIDENCE:
            return same
        worth["z"] = standing.worth
    worth |= {up: _worth(points @ turn.T, body) for up, turn in turns.items() if up != "z"}
    best = max(worth, key=lambda up: worth[up])
    if best == "z" or worth[best] < worth["z"] + CLEARLY:
        return same
    axes = axes_text(turns[best] @ old)
    note = (
        f"axes put right: {axes} point forward, left and up, not {capture.axes} (a body stands there upright, "
        f"and nowhere else); --axes={capture.axes} keeps them"
    )
    return AxesFinding(Verdict.PUT_RIGHT, turns[best], note)


def _worth(points_m: Array, body: BodyDescription) -> float:
    try:
        return find_body(worn_places(body), points_m).worth
    except NotObservable:
        return -np.inf
