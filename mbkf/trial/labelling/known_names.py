"""Reliable names of a capture: those that the body does not contradict.

A name is judged per tracklet, since a column may hold another marker after a gap. All names are ignored where their
points change from frame to frame, as in shuffled captures, or where most of them contradict the body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import SubjectMarker, match_names
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.exchanges import Distances, body_distances, find_exchanges, misfits
from mbkf.labelling.tracklets import Tracklets, link_points
from mbkf.labelling.tracks import columns_are_tracks
from mbkf.sensors.marker_sensor import MarkerSensor

PLACED_SD_M = 0.015
"""Spread of a marker about its place in the static trial, besides that of the subject file."""

CONTRADICTED = 3.0
"""Mean squared deviation of a name's distances to its neighbours, in variances, from which it is contradicted."""

LEAST_NEIGHBOURS = 2.0
"""Least number of named neighbours by which a name is judged; with fewer it is kept."""

UNKNOWN_M = 1e3
"""Spread of an unknown distance."""

MOST_CONTRADICTED = 0.5
"""Share of a capture's named samples contradicting the body above which all names are ignored."""

LOOKS = 60
"""Frames in which the points of named columns are compared with those of the frame before."""


@dataclass(frozen=True)
class KnownNames:
    """Names of a capture.

    Attributes:
        claimed: (T, C) marker by each point's name, ``HIDDEN`` where it has none.
        trusted: (T, C) the same, without names that the body contradicts.
        ignored: Reason why all names are ignored, "" where they are used.
    """

    claimed: Indices
    trusted: Indices
    ignored: str = ""

    @property
    def names(self) -> bool:
        """True where some name is reliable."""
        return bool((self.trusted != HIDDEN).any())


def no_names(points: MarkerTrajectories) -> KnownNames:
    """A capture without names."""
    nothing = np.full(points.positions_m.shape[:2], HIDDEN, dtype=np.intp)
    return KnownNames(nothing, nothing)


def known_names(
    points: MarkerTrajectories, markers: Sequence[SubjectMarker], sensor: MarkerSensor
) -> KnownNames:
    """The reliable names of a capture.

    Args:
        points: The capture, wholly, partly or not named.
        markers: The M markers that are looked for.
        sensor: They on the body.
    """
    nothing = no_names(points)
    place = {marker.name: k for k, marker in enumerate(markers)}
    column = {
        points.names.index(name): place[marker.name]
        for name, marker in match_names(points.names, markers).items()
        if marker.name in place and points.present[:, points.names.index(name)].any()
    }
    if not column:
        return nothing
    named = np.array(list(column), dtype=np.intp)
    if not columns_are_tracks(points.positions_m, named, LOOKS):
        return replace(nothing, ignored="their points change from frame to frame")
    owner = np.array(list(column.values()), dtype=np.intp)
    placed = np.array([np.hypot(np.hypot(m.noise_m, m.session_sd_m), PLACED_SD_M) for m in markers])
    distances = body_distances(sensor, placed)
    unnamed = np.setdiff1d(np.arange(len(markers)), owner)
    distances.sd_m[:, unnamed] = UNKNOWN_M  # a marker's neighbours are those that have names
    shown = np.full((points.frames, len(markers), 3), np.nan)
    shown[:, owner] = points.positions_m[:, named]
    claimed = np.full(points.positions_m.shape[:2], HIDDEN, dtype=np.intp)
    claimed[:, named] = np.where(np.isnan(points.positions_m[:, named, 0]), HIDDEN, owner)
    tracklets = link_points(points.positions_m)
    if _contradicted(points.positions_m, claimed, tracklets, distances) > MOST_CONTRADICTED:
        return KnownNames(claimed, nothing.trusted, "most of them contradict the body")
    right = claimed.copy()
    for one in find_exchanges(shown, distances):
        a, b = (right == one.a) & one.frames[:, None], (right == one.b) & one.frames[:, None]
        right[a], right[b] = one.b, one.a
    return KnownNames(claimed, _trusted(points.positions_m, right, tracklets, distances))


def with_claims(labels: Indices, names: KnownNames) -> Indices:
    """(T, C) labels, in which a point without one keeps the capture's name where no other point has it.

    A marker that was moved on its segment contradicts the body and is still that marker.
    """
    if names.ignored or not names.names:
        return labels
    found = labels.copy()
    for t, c in np.argwhere((labels == HIDDEN) & (names.claimed != HIDDEN)):
        if names.claimed[t, c] not in found[t]:
            found[t, c] = names.claimed[t, c]
    return found


def _contradicted(positions_m: Array, claimed: Indices, tracklets: Tracklets, distances: Distances) -> float:
    """Share of the named samples whose names contradict the body."""
    label = np.array([_most(claimed[f, c]) for f, c in tracklets.pieces], dtype=np.intp)
    mean = _mean_misfits(positions_m, label, tracklets, distances, len(distances.expected_m))
    length = np.diff(tracklets.spans, axis=1)[:, 0] * (label != HIDDEN)
    return float(length[mean > CONTRADICTED].sum()) / max(1, int(length.sum()))


def _trusted(positions_m: Array, right: Indices, tracklets: Tracklets, distances: Distances) -> Indices:
    """(T, C) names of the tracklets that fit the body; the worst is dropped first, since it affects its neighbours."""
    label = np.array([_most(right[f, c]) for f, c in tracklets.pieces], dtype=np.intp)
    markers = len(distances.expected_m)
    dropped = np.zeros(len(label), dtype=bool)
    for _ in range(len(label)):
        own = np.where(dropped, HIDDEN, label)
        mean = _mean_misfits(positions_m, own, tracklets, distances, markers)
        bad = mean > CONTRADICTED
        if not bad.any():
            break
        worst = float(mean[bad].max())
        dropped |= bad & (mean >= 0.8 * worst)
    trusted = tracklets.points(np.where(dropped, HIDDEN, label))
    return np.where(right == trusted, trusted, HIDDEN)


def _most(names: Indices) -> int:
    """The most frequent name of a tracklet's points, ``HIDDEN`` among them."""
    values, counts = np.unique(names, return_counts=True)
    return int(values[counts.argmax()])


def _mean_misfits(
    positions_m: Array, label: Indices, tracklets: Tracklets, distances: Distances, markers: int
) -> Array:
    """(n,) mean misfit of every named tracklet, 0 where it has too few neighbours."""
    shown = np.full((len(positions_m), markers, 3), np.nan)
    named: BoolArray = np.asarray(label != HIDDEN)
    for k in np.flatnonzero(named):
        frames, columns = tracklets.pieces[k]
        shown[frames, label[k]] = positions_m[frames, columns]
    cost, count = misfits(shown, distances)
    found = np.zeros(len(label))
    for k in np.flatnonzero(named):
        frames, _ = tracklets.pieces[k]
        near = count[frames, label[k]]
        if near.mean() >= LEAST_NEIGHBOURS:
            found[k] = cost[frames, label[k]].sum() / near.sum()
    return found
