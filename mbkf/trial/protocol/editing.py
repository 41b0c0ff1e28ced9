"""A marker set changed by hand: markers moved to another segment or landmark, left out, or taken in."""

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
from mbkf.trial.protocol.standing import Standing, in_reference, stands_still

SURE = 0.9
"""A marker is in doubt where its probability is below this."""

LEFT_OUT = "left out by hand"


@dataclass(frozen=True)
class Choice:
    """What a person wants of a marker: one of the three is not empty; all empty confirms what the set says.

    Attributes:
        segment: The segment that carries it, where the capture shows it.
        landmark: The landmark that it is on.
        ignored: Why it is to be left out.
    """

    segment: str = ""
    landmark: str = ""
    ignored: str = ""


def starting_set(capture: Capture, given: str | None) -> tuple[Protocol, Capture]:
    """The marker set to begin with: the given one, the shipped one that knows the names, an inferred or an empty one.

    Args:
        capture: The capture.
        given: Name or file of a marker set, None where none was named.

    Returns:
        The set, and the capture, with its axes put right where the set was inferred from it.

    Raises:
        UnknownName: No marker set is called so.
        FileFormatError: The file is not a valid one.
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
    """The marker set with a person's choices.

    Markers that are moved get the place at which the capture shows them. One that the capture does not show can be
    moved to a landmark or left out, not to a segment.

    Args:
        protocol: The set before.
        standing: The capture, with the body beside it.
        choices: The choice by the marker's name in the capture, or in the set where the capture lacks it.
        name: What the changed set is called.

    Raises:
        InvalidInput: A marker is to be moved to a segment that the capture does not show it on.
        UnknownName: The marker, the segment or the landmark is not known.
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
    told = protocol.source or (protocol.title if protocol.markers else "")
    return told if "by hand" in told else f"{told}, changed by hand".removeprefix(", ")


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
            raise InvalidInput(
                f"the capture does not show '{name}'; choose a landmark for it, or leave it out"
            )
        position = read_only(np.round(in_reference(standing, segment, point_m), 4))
    if before is None:
        return ProtocolMarker(
            name,
            segment,
            position,
            kind,
            DEFAULT_PLACEMENT_SD_M[kind],
            DEFAULT_NOISE_M[kind],
            landmark=choice.landmark,
        )
    kind = before.kind if before.kind == "keypoint" else kind
    return replace(
        before,
        segment=segment,
        position_m=position,
        kind=kind,
        placement_sd_m=DEFAULT_PLACEMENT_SD_M[kind],
        landmark=choice.landmark,
        probability=1.0,
        alternatives=(),
    )
