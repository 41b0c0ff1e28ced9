"""Names of neighbouring markers on one segment, which only the posture of the whole body distinguishes.

A trial may show only one of two markers a few centimetres apart. Two exchanged markers of a wrist fit the forearm as
well, turned by half a turn. A first frame or a gap may confuse such names; here a few frames are fitted with either
name, and the more likely posture decides.
"""

from __future__ import annotations

import itertools
import warnings

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import Indices
from mbkf.labelling.first_frame import FirstFrameSearch
from mbkf.labelling.tracklets import Tracklets
from mbkf.numerics.runs import spread_indices
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment

LOOKS = 16
"""Frames that are fitted to find the name of a marker that was not worn."""

FEW_LOOKS = 5
"""Frames that are fitted to find exchanged names."""

NEAR_M = 0.10
"""Greatest distance of a trajectory from the place of a name that is tried on it."""

GAIN = 1.0
"""Least mean gain of a frame (twice the log-likelihood ratio) by which a name is changed."""

EXCHANGE_GAIN = 3.0
"""The same for two exchanged names."""

SMALL = 3
"""Greatest number of a segment's markers that are tried with exchanged names; more markers fit one way only."""

MOST_CHANGES = 6


def renamed(search: FirstFrameSearch, markers_m: Array, q: Array) -> Indices:
    """(M,) marker that the trajectory of each marker really shows.

    Args:
        search: The body, its markers and their spreads.
        markers_m: (T, M, 3) labelled trajectories, NaN where hidden.
        q: (T, nq) poses, NaN where the body was not tracked.
    """
    followed = np.flatnonzero(~np.isnan(q).any(axis=1))
    looks = followed[spread_indices(len(followed), LOOKS)]
    name = np.arange(markers_m.shape[1])
    shown = markers_m[looks]
    log_ratio, poses = _mean_log_ratio(search, shown, q[looks])
    for _ in range(MOST_CHANGES):
        tried = [
            (*_mean_log_ratio(search, _moved(shown, old, new), poses), old, new)
            for old, new in _unused_neighbours(search, shown, poses)
        ]
        best = max(tried, key=lambda one: one[0], default=None)
        if best is None or best[0] < log_ratio + GAIN:
            break
        log_ratio, poses, old, new = best
        shown = _moved(shown, old, new)
        name[name == old] = new
    return name


def exchanged(
    search: FirstFrameSearch, markers_m: Array, q: Array, label: Indices, tracklets: Tracklets
) -> Indices:
    """(n,) labels of the tracklets, with names of two markers exchanged where that makes the posture more likely.

    Args:
        search: The body, its markers and their spreads.
        markers_m: (T, M, 3) labelled trajectories, NaN where hidden.
        q: (T, nq) poses, NaN where the body was not tracked.
        label: (n,) labels of the tracklets.
        tracklets: Links of the points.
    """
    label, segments = label.copy(), np.array(search.sensor.segments)
    followed = ~np.isnan(q).any(axis=1)
    for segment in dict.fromkeys(search.sensor.segments):
        own = np.intersect1d(np.flatnonzero(segments == segment), label)
        if len(own) > SMALL:
            continue
        for a, b in itertools.combinations(own, 2):
            for together in _overlapping(np.flatnonzero((label == a) | (label == b)), tracklets):
                spans = tracklets.spans[together]
                first, end = int(spans[:, 0].min()), int(spans[:, 1].max())
                there = first + np.flatnonzero(np.asarray(followed)[first:end])
                looks = there[spread_indices(len(there), FEW_LOOKS)]
                if _exchange_is_likelier(search, markers_m[looks], q[looks], a, b):
                    label[together] = a + b - label[together]
    return label


def _overlapping(pieces: Indices, tracklets: Tracklets) -> list[Indices]:
    """The tracklets in groups that overlap in time, with gaps between the groups."""
    spans = tracklets.spans[pieces]
    order = np.argsort(spans[:, 0])
    reached = np.maximum.accumulate(spans[order, 1])
    return np.split(pieces[order], 1 + np.flatnonzero(spans[order[1:], 0] >= reached[:-1]))


def _exchange_is_likelier(search: FirstFrameSearch, markers_m: Array, q: Array, a: int, b: int) -> bool:
    if not len(q):
        return False
    other = markers_m.copy()
    other[:, [a, b]] = markers_m[:, [b, a]]
    return _best_log_ratio(search, other, q) > _best_log_ratio(search, markers_m, q) + EXCHANGE_GAIN


def _best_log_ratio(search: FirstFrameSearch, markers_m: Array, q: Array) -> float:
    """Mean log ratio of frames (n, M, 3), fitted from poses (n, nq) or from the markers alone, the better of both."""
    total = 0.0
    for frame, *starts in zip(markers_m, q, segment_by_segment(search.sensor, markers_m), strict=True):
        fits = [_fit(search, frame, start) for start in starts]
        total += max(search.log_ratio(frame, fit) for fit in fits)
    return total / len(q)


def _fit(search: FirstFrameSearch, markers_m: Array, start: Array) -> Array:
    fit = fit_pose(search.sensor, search.posture, markers_m, search.sd_m, start, max_iterations=10)
    return fit.q


def _moved(markers_m: Array, old: int, new: int) -> Array:
    moved = markers_m.copy()
    moved[:, new], moved[:, old] = markers_m[:, old], np.nan
    return moved


def _mean_log_ratio(search: FirstFrameSearch, markers_m: Array, q: Array) -> tuple[float, Array]:
    """Mean log ratio of frames (n, M, 3) under these names, and the poses (n, nq) fitted to them from poses q."""
    if not len(q):
        return 0.0, q
    poses = np.array([_fit(search, frame, pose) for frame, pose in zip(markers_m, q, strict=True)])
    return float(np.mean([search.log_ratio(*one) for one in zip(markers_m, poses, strict=True)])), poses


def _unused_neighbours(search: FirstFrameSearch, markers_m: Array, q: Array) -> list[tuple[int, int]]:
    """Pairs of a marker in use and one of its segment that is not, whose place is near the former's trajectory."""
    sensor = search.sensor
    used = ~np.isnan(markers_m[:, :, 0]).all(axis=0)
    mean = _mean_place(search, markers_m, q)
    return [
        (int(old), int(new))
        for new in np.flatnonzero(~used)
        for old in np.flatnonzero(used)
        if sensor.segments[old] == sensor.segments[new]
        and np.linalg.norm(mean[old] - sensor.local_m[new]) <= NEAR_M
    ]


def _mean_place(search: FirstFrameSearch, markers_m: Array, q: Array) -> Array:
    """(M, 3) median places of the trajectories in their segments' frames."""
    joints = search.sensor.joint_ids
    place = np.full(markers_m.shape, np.nan)
    for k, pose in enumerate(q):
        rotations, origins = search.sensor.model.placements(pose)
        place[k] = np.einsum("mji,mj->mi", rotations[joints], markers_m[k] - origins[joints])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # markers not in use
        return np.asarray(np.nanmedian(place, axis=0) if len(q) else np.full(markers_m.shape[1:], np.nan))
