"""Whole tracks named by a body: by the marker that a track is near in many frames."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.placing import log_likelihood_ratio
from mbkf.labelling.tracks import Tracks
from mbkf.numerics.runs import spread_indices
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor

LOOKS = 60
"""Frames, spread over the capture, in which tracks are compared with the body."""

LEAST_RATIO = -15.0
"""Least log-likelihood ratio of a pair in one frame: the limb may be placed wrongly there."""

MIN_MARKERS = 6
"""Least number of named tracks that determine a pose."""


def trajectories(points_m: Array, tracks: Tracks, owner: Indices, markers: int) -> Array:
    """(T, M, 3) trajectories of markers from the tracks they own, NaN elsewhere.

    Args:
        points_m: (T, C, 3) points of the capture.
        tracks: Their tracks.
        owner: (count,) marker of every track, ``HIDDEN`` for those of no marker.
        markers: Number of markers.
    """
    found = np.full((len(points_m), markers, 3), np.nan)
    whose = np.where(tracks.number == HIDDEN, HIDDEN, owner[tracks.number])
    frames, columns = np.nonzero(whose != HIDDEN)
    found[frames, whose[frames, columns]] = points_m[frames, columns]
    return found


def name_tracks(
    sensor: MarkerSensor, sd_m: Array, points_m: Array, tracks: Tracks, owner: Indices
) -> tuple[Indices, float]:
    """Marker of every track (count,) by a body posed by the tracks named before, and their log-likelihood ratio.

    Pairs of track and marker are taken by their likelihood over all frames in which the track is seen, the likeliest
    first; two tracks that are seen at once are not the same marker.

    Args:
        sensor: The markers on the body.
        sd_m: (M,) spread of each marker about its place.
        points_m: (T, C, 3) points of the capture.
        tracks: Their tracks.
        owner: (count,) marker of the tracks named so far.
    """
    looks = spread_indices(len(points_m), LOOKS)
    seen = tracks.positions(points_m, looks)
    known = trajectories(points_m, tracks, owner, len(sd_m))[looks]
    evidence = _evidence(sensor, sd_m, seen, known)
    found = _without_conflicts(evidence, tracks.visible())
    named = np.flatnonzero(found != HIDDEN)
    return found, float(evidence[named, found[named]].sum())


def _evidence(sensor: MarkerSensor, sd_m: Array, seen_m: Array, known_m: Array) -> Array:
    """(count, M) log-likelihood ratios that a track (F, count, 3) is a marker, on a body posed by markers (F, M, 3)."""
    posture = PostureSensor(sensor.model)
    total = np.zeros((seen_m.shape[1], len(sd_m)))
    for points, measured in zip(seen_m, known_m, strict=True):
        if np.count_nonzero(~np.isnan(measured[:, 0])) < MIN_MARKERS:
            continue
        start = segment_by_segment(sensor, measured)
        placed = sensor.positions(fit_pose(sensor, posture, measured, sd_m, start, max_iterations=12).q)
        squared = ((points[:, None] - placed) ** 2).sum(axis=2)
        total += np.nan_to_num(np.maximum(log_likelihood_ratio(squared, sd_m), LEAST_RATIO))
    return total


def _without_conflicts(evidence: Array, lives: BoolArray) -> Indices:
    """(count,) marker of every track, no marker on two tracks (count, T) in one frame."""
    owner = np.full(len(evidence), HIDDEN, dtype=np.intp)
    taken = np.zeros((evidence.shape[1], lives.shape[1]), dtype=bool)
    likeliest = np.argsort(-evidence, axis=None)[: np.count_nonzero(evidence > 0.0)]
    for track, marker in zip(*np.unravel_index(likeliest, evidence.shape), strict=True):
        if owner[track] == HIDDEN and not (taken[marker] & lives[track]).any():
            owner[track] = marker
            taken[marker] |= lives[track]
    return owner
