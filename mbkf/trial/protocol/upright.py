"""Captures of a person of unknown marker set, with corrected axes: by names, or by the posed body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.io.axes import axes_matrix, axes_text, rotation_to_world
from mbkf.io.records import AxesSource, Capture
from mbkf.marker_sets.frames import anchor_frames
from mbkf.marker_sets.inference import CLEAR_LOG_RATIO
from mbkf.marker_sets.names import NameReading
from mbkf.marker_sets.places import worn_places
from mbkf.marker_sets.search import FEWEST_POINTS, find_body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import DEFAULT_NOISE_M, DEFAULT_PLACEMENT_SD_M, ProtocolMarker
from mbkf.trial.axes.decision import AxesFinding, Verdict, applied, find_axes, may_follow
from mbkf.trial.axes.evidence import marker_places

SURE_NAME = 0.8
"""Probability from which the place that a name means is certain."""

CLEARLY = 15.0
"""Least gain in the log posterior of the body along another axis than the file's for that axis to be up: a body along a
wrong axis is lower by 30 and more."""

UPS = ("z", "-z", "x", "-x", "y", "-y")


def upright_captures(
    captures: Sequence[Capture],
    readings: Mapping[str, NameReading],
    body: BodyDescription,
    *,
    standing: int = 0,
) -> list[Capture]:
    """Captures of one person with checked and corrected axes.

    Names of certain places decide about up and handedness, as those of a protocol do. Without such names, the axis
    along which a body explains the points clearly better is up; handedness then remains unknown.

    Args:
        captures: The captures.
        readings: Readings of their markers' names, by name.
        body: The reference body.
        standing: Number of captures, from the first on, in which the person is known to stand.

    Raises:
        InvalidInput: The axes or the unit of a capture are wrong, and the right ones are ambiguous.
    """
    known = known_places(readings, body)
    found = [
        find_axes(
            one,
            marker_places(one.markers.names, _of(known, one), body),
            with_plates=False,
            standing=k < standing,
        )
        for k, one in enumerate(captures)
    ]
    clear = next((one for one in found if one.verdict in (Verdict.RIGHT, Verdict.PUT_RIGHT)), None)
    result = []
    for capture, finding in zip(captures, found, strict=True):
        own = finding
        if own.verdict is Verdict.UNKNOWN and clear is None:
            own = clear = _by_body(capture, body)
        elif clear is not None and _alike(captures, found, clear, capture) and may_follow(own, clear.turn):
            own = clear
        if own.verdict in (Verdict.UNKNOWN, Verdict.KEPT):
            own = _by_others(capture, body, own)
        result.append(applied(capture, own))
    return result


def known_places(readings: Mapping[str, NameReading], body: BodyDescription) -> dict[str, ProtocolMarker]:
    """Markers whose names certainly mean a landmark, by name."""
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
    captures: Sequence[Capture], found: Sequence[AxesFinding], clear: AxesFinding, capture: Capture
) -> bool:
    """True where a capture was read with the same axes as that of a clear finding."""
    return any(
        (one.axes, one.axes_source) == (capture.axes, capture.axes_source)
        for one, finding in zip(captures, found, strict=True)
        if finding is clear
    )


def _by_others(capture: Capture, body: BodyDescription, own: AxesFinding) -> AxesFinding:
    """The finding about another person of the same file, which has the same axes, where that one is clear."""
    if capture.others is None or len(capture.others.names) < FEWEST_POINTS:
        return own
    other = _by_body(replace(capture, markers=capture.others, others=None), body)
    return other if other.verdict is Verdict.PUT_RIGHT and may_follow(own, other.turn) else own


def _by_body(capture: Capture, body: BodyDescription) -> AxesFinding:
    """The finding about the up axis from the body that explains a frame's points best."""
    same = AxesFinding(Verdict.UNKNOWN, np.eye(3))
    if capture.axes_source in (AxesSource.UP_GIVEN, AxesSource.GIVEN):
        return same
    markers = capture.markers
    frame = anchor_frames([markers], markers.names, 1)[0]
    points = frame[~np.isnan(frame[:, 0])]
    old = axes_matrix(capture.axes)
    turns = {up: np.asarray(rotation_to_world(up)) for up in UPS}
    posterior = {"z": -np.inf}
    try:
        standing = find_body(worn_places(body), points)
    except NotObservable:
        pass
    else:
        if standing.log_ratio_per_point >= CLEAR_LOG_RATIO:
            return same
        posterior["z"] = standing.log_posterior
    posterior |= {up: _log_posterior(points @ turn.T, body) for up, turn in turns.items() if up != "z"}
    best = max(posterior, key=posterior.__getitem__)
    if best == "z" or posterior[best] < posterior["z"] + CLEARLY:
        return same
    axes = axes_text(turns[best] @ old)
    note = (
        f"axes put right: {axes} point forward, left and up, not {capture.axes} (only then does a body stand upright); "
        f"--axes={capture.axes} keeps them"
    )
    return AxesFinding(Verdict.PUT_RIGHT, turns[best], note)


def _log_posterior(points_m: Array, body: BodyDescription) -> float:
    try:
        return find_body(worn_places(body), points_m).log_posterior
    except NotObservable:
        return -np.inf
