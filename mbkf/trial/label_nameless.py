"""Labels, a marker set and a scaled subject from an unlabelled capture, given only the body mass.

The tracks of the capture replace names: a marker set is inferred from them, tracks that are pieces of one marker are
joined, the person is scaled from them, and the capture is labelled by the scaled person.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.naming import trajectories
from mbkf.labelling.tracks import Tracks, link_tracks
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.numerics.threads import single_threaded
from mbkf.trial.label import label
from mbkf.trial.labelling.result import Labelling
from mbkf.trial.persons import check_one_person
from mbkf.trial.protocol.inferred import InferredSet, infer_marker_set
from mbkf.trial.scale import scale

STAGE = "Inferring the marker set"
"""Name of the first stage in progress reports."""

LEAST_SEEN = 0.1
"""Least share of the frames in which a track of its own is seen."""

SAME_PLACE_M = 0.04
"""Greatest distance of the places, on one segment, of two tracks of one marker that are never seen together."""


def label_nameless(
    capture: Capture,
    *,
    mass_kg: float | None = None,
    height_m: float | None = None,
    progress: StageCallback | None = None,
) -> tuple[Labelling, Subject, InferredSet]:
    """Names the points of a capture of unknown marker set, after landmarks and segments of the body.

    Args:
        capture: Unlabelled points; names are ignored, columns may be tracks or shuffled in every frame.
        mass_kg: Body mass; by default what the capture states.
        height_m: Body height, if known.
        progress: Called with the stage, items done and items in all.

    Returns:
        The labels, the person, and the marker set with its doubts.

    Raises:
        InvalidInput: No mass, an impossible mass or height, or points of several persons.
        NotObservable: Too few points, or no body is found among them.
        NotConverged: The points do not fit a body.
    """
    report = progress or (lambda *_: None)
    mass = capture.subject_mass_kg if mass_kg is None else mass_kg
    if mass is None:
        raise InvalidInput("the capture does not state the body mass; give --mass KG")
    check_one_person(capture)
    report(STAGE, 0, 1)
    points = capture.markers.positions_m
    with single_threaded():
        tracks = link_tracks(points, capture.markers.rate_hz)
    whole = tracks.positions(points, np.arange(len(points)))
    kept = np.flatnonzero((~np.isnan(whole[:, :, 0])).mean(axis=0) >= LEAST_SEEN)
    names = tuple(f"track {k}" for k in kept)
    shown = MarkerTrajectories(names, whole[:, kept], capture.markers.rate_hz, capture.markers.start_time_s)
    found = infer_marker_set(None, [replace(capture, markers=shown)], use_names=False)
    report(STAGE, 1, 1)
    protocol, owner = _named(
        found.protocol, tracks, {name: int(k) for name, k in zip(names, kept, strict=True)}
    )
    (upright,) = found.captures
    turned = replace(upright, markers=replace(capture.markers, positions_m=points @ _turn(shown, upright).T))
    together = MarkerTrajectories(
        tuple(marker.name for marker in protocol.markers),
        trajectories(turned.markers.positions_m, tracks, owner, len(protocol.markers)),
        capture.markers.rate_hz,
        capture.markers.start_time_s,
    )
    person = scale(
        trials=[replace(turned, markers=together)],
        mass_kg=mass,
        height_m=height_m,
        protocol=protocol,
        progress=progress,
    )
    labels = label(turned, person, progress=progress)
    return labels, person, replace(found, protocol=protocol, captures=(turned,))


def _turn(before: MarkerTrajectories, after: Capture) -> Array:
    """(3, 3) rotation by which the capture's axes were corrected."""
    one, other = before.positions_m, after.markers.positions_m
    seen = ~np.isnan(one).any(axis=2)
    turn, *_ = np.linalg.lstsq(one[seen], other[seen], rcond=None)
    return np.asarray(np.round(turn.T))


def _named(inferred: Protocol, tracks: Tracks, number: dict[str, int]) -> tuple[Protocol, Indices]:
    """The marker set with the pieces of a marker joined and named after the body, and each track's marker.

    Args:
        inferred: Its markers are tracks.
        tracks: The tracks.
        number: Number of the track by its name.
    """
    lives = tracks.visible()
    groups: list[tuple[ProtocolMarker, list[int]]] = []
    seen_most = sorted(inferred.markers, key=lambda marker: -lives[number[marker.name]].sum())
    for marker in seen_most:
        track = number[marker.name]
        known = next(
            (
                members
                for first, members in groups
                if first.segment == marker.segment
                and np.linalg.norm(first.position_m - marker.position_m) < SAME_PLACE_M
                and not (lives[members].any(axis=0) & lives[track]).any()
            ),
            None,
        )
        if known is None:
            groups.append((marker, [track]))
        else:
            known.append(track)
    owner = np.full(tracks.count, HIDDEN, dtype=np.intp)
    used: Counter[str] = Counter()
    markers = []
    for index, (marker, members) in enumerate(groups):
        owner[members] = index
        used[marker.segment] += 1
        name = marker.landmark or f"{marker.segment}_{used[marker.segment]}"
        markers.append(replace(marker, name=name))
    return replace(inferred, markers=tuple(markers), ignored={}), owner
