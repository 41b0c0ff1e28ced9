"""A marker set changed by hand: markers moved to another segment or landmark, left out, or added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.io.records import Capture
from mbkf.model.body_file import load_body
from mbkf.model.protocol import (
    DEFAULT_NOISE_M,
    DEFAULT_PLACEMENT_SD_M,
    Protocol,
    ProtocolMarker,
    load_protocol,
)
from mbkf.trial.protocol.choice import choose_marker_set
from mbkf.trial.protocol.standing import Standing, stands_still

SURE = 0.9
"""Probability below which a marker is doubtful."""

LEFT_OUT = "left out by hand"


@dataclass(frozen=True)
class Choice:
    """A user's choice for a marker, by one of three fields; all empty confirms the set.

    Attributes:
        segment: The segment that carries it, at its place in the capture.
        landmark: The landmark that it is on.
        ignored: Reason to leave it out.
    """

    segment: str = ""
    landmark: str = ""
    ignored: str = ""


def starting_set(capture: Capture, given: str | None) -> tuple[Protocol, Capture]:
    """The marker set to begin with, and the capture, with corrected axes where the set was inferred from it.

    It is the given name or file, else the shipped set that knows the names, an inferred one, or an empty one.

    Raises:
        UnknownName: There is no such marker set.
        FileFormatError: The file is not a valid marker set.
    """
    if given is not None:
        return load_protocol(given), capture
    still = stands_still(capture.markers)
    try:
        chosen = choose_marker_set(capture if still else None, () if still else (capture,))
    except (NotObservable, InvalidInput):
        return Protocol("my_markers", "My markers", load_body("human18"), ()), capture
    return chosen.protocol, chosen.captures[0]


def edited(protocol: Protocol, standing: Standing, choices: Mapping[str, Choice], name: str) -> Protocol:
    """The marker set with a user's choices.

    A marker moved to a segment gets its place in the capture; without one there, it can be moved to a landmark or left
    out.

    Args:
        protocol: The set before.
        standing: The capture, with the body beside it.
        choices: The choice by the marker's name in the capture, or in the set where the capture lacks it.
        name: Name of the changed set.

    Raises:
        InvalidInput: A marker without a place in the capture is to be moved to a segment.
        UnknownName: The marker, the segment or the landmark is unknown.
    """
    match = protocol.match(standing.names)
    points = {one: point for one, point in zip(standing.names, standing.points_m, strict=True)}
    markers = {marker.name: marker for marker in protocol.markers}
    ignored = dict(protocol.ignored)
    known = {*points, *markers, *ignored}
    for called, choice in choices.items():
        if called not in known:
            raise UnknownName("marker", called, sorted(known))
        own = match[called].name if called in match else called
        if choice.ignored:
            markers.pop(own, None)
            ignored[called] = choice.ignored
            continue
        before = markers.get(own)
        if choice.segment or choice.landmark:
            markers[own] = _placed(own, before, choice, standing, points.get(called))
            ignored.pop(called, None)
        elif before is not None:
            markers[own] = replace(before, probability=1.0, alternatives=())
    return replace(
        protocol,
        name=name,
        title=protocol.title if name == protocol.name else name.replace("_", " "),
        markers=tuple(markers.values()),
        ignored=ignored,
        source=_source(protocol),
    )


def _source(protocol: Protocol) -> str:
    source = protocol.source or (protocol.title if protocol.markers else "")
    return source if "by hand" in source else f"{source}, changed by hand".removeprefix(", ")


def _placed(
    name: str, before: ProtocolMarker | None, choice: Choice, standing: Standing, point_m: Array | None
) -> ProtocolMarker:
    body = standing.model.description
    if choice.landmark:
        landmark = body.landmark(choice.landmark)
        kind, segment, position = "anatomical", landmark.segment, landmark.position_m
    else:
        kind, segment = "technical", body.segment(choice.segment).name
        if point_m is None:
            raise InvalidInput(f"the capture does not show '{name}'; choose a landmark, or leave it out")
        position = read_only(np.round(standing.to_reference(segment, point_m), 4))
    if before is None:
        spreads = DEFAULT_PLACEMENT_SD_M[kind], DEFAULT_NOISE_M[kind]
        return ProtocolMarker(name, segment, position, kind, *spreads, landmark=choice.landmark)
    kind = before.kind if before.kind == "keypoint" else kind
    placed = replace(before, segment=segment, position_m=position, kind=kind, landmark=choice.landmark)
    return replace(placed, placement_sd_m=DEFAULT_PLACEMENT_SD_M[kind], probability=1.0, alternatives=())
