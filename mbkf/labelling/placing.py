"""Poses of one segment that match its marker cluster with unlabelled points, by distances between points."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.distance import cdist

from mbkf.conventions import Array
from mbkf.labelling.assignment import HIDDEN, AssignmentSettings, Indices
from mbkf.labelling.beam import BRANCHES, Placing, distinct_rows
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

MATCH_M = 0.045
"""Greatest distance of a point from a placed segment's marker."""

PLACING_SD_M = 0.008
"""Error of a segment placed by two points, besides the spread of its markers."""

MOST_POSTURE = 8.0
"""Greatest cost of an unusual turn of a joint: people squat and kneel."""

JOINT_TOLERANCE_M = 0.045
"""Greatest distance of a joint from its place in the chain of segments."""

LENGTH_TOLERANCE_M = 0.025
"""Greatest difference of two markers' distance from that on the body."""

_POSTURE_PULL = 2e-3
_MOST = 80


class FramePlacings:
    """:func:`placings` among the points of one frame, each found once: the bodies of a beam share most of them."""

    def __init__(self, points_m: Array) -> None:
        """Args: points_m: (N, 3) all points."""
        self._points_m = points_m
        self._found: dict[tuple[int, bytes, bytes, bytes], list[Placing]] = {}

    def __call__(self, cluster: Cluster, origin_m: Array, parent: Array, free: Indices) -> list[Placing]:
        """Args: as :func:`placings`."""
        near = _within_reach(self._points_m, cluster, origin_m, free)
        key = cluster.number, origin_m.tobytes(), parent.tobytes(), near.tobytes()
        if key not in self._found:
            self._found[key] = placings(self._points_m, cluster, origin_m, parent, near)
        return self._found[key]


def _within_reach(points_m: Array, cluster: Cluster, origin_m: Array, free: Indices) -> Indices:
    """The free points that a marker of a segment may be, however the segment is turned about its joint."""
    reach = np.linalg.norm(cluster.local_m, axis=1).max(initial=0.0) + max(MATCH_M, JOINT_TOLERANCE_M)
    away = points_m[free] - origin_m
    return np.asarray(free[np.einsum("ni,ni->n", away, away) <= (reach + 1e-9) ** 2])


def placings(
    points_m: Array, cluster: Cluster, origin_m: Array, parent: Array, free: Indices
) -> list[Placing]:
    """The best ways to place a segment whose joint and parent are placed; the last is without any marker.

    Args:
        points_m: (N, 3) all points.
        cluster: The segment.
        origin_m: (3,) its joint.
        parent: (3, 3) orientation of the segment before.
        free: Points not yet taken.
    """
    nothing = Placing(parent, origin_m, np.full(len(cluster.markers), HIDDEN, dtype=np.intp), 0.0)
    if not len(cluster.markers) or not len(free):
        return [nothing]
    arms = points_m[free] - origin_m
    rotations = _rotations(cluster.local_m, arms, parent)
    if not len(rotations):
        return [nothing]
    matched, squared = match(cluster.local_m @ rotations.transpose(0, 2, 1), arms)
    turn = np.arccos(np.clip((np.einsum("nij,ij->n", rotations, parent) - 1.0) / 2.0, -1.0, 1.0))
    unusual = np.minimum((turn / cluster.posture_sd_rad) ** 2, MOST_POSTURE)
    score = match_log_ratios(cluster, matched, squared) - unusual
    rows = [n for n in distinct_rows(matched, score, BRANCHES) if (matched[n] != HIDDEN).any()]
    labels = np.where(matched == HIDDEN, HIDDEN, free[matched])
    found = [Placing(rotations[n], origin_m, labels[n], float(score[n])) for n in rows[: BRANCHES - 1]]
    return [*found, nothing]


def match(placed: Array, points_m: Array) -> tuple[Indices, Array]:
    """Nearest points of placed clusters (n, k, 3), as :func:`nearest`."""
    squared = cdist(placed.reshape(-1, 3), points_m, "sqeuclidean")
    return nearest(squared.reshape(*placed.shape[:2], len(points_m)), MATCH_M)


def nearest(squared: Array, reach_m: float | Array) -> tuple[Indices, Array]:
    """(n, k) nearest point of each marker, by squared distances (n, k, N), and these.

    ``HIDDEN``, and 0, where none lies within reach (k,) or where another marker of the cluster lies nearer to it.
    """
    found = squared.argmin(axis=2)
    least = np.take_along_axis(squared, found[:, :, None], axis=2)[:, :, 0]
    same = found[:, :, None] == found[:, None]
    beaten = (same & (least[:, None] < least[:, :, None])).any(axis=2)
    good = (least <= np.square(reach_m)) & ~beaten
    return np.where(good, found, HIDDEN), np.where(good, least, 0.0)


def match_log_ratios(cluster: Cluster, matched: Indices, squared: Array) -> Array:
    """(n,) log-likelihood ratios of alternative matches, summed over their markers.

    Args:
        cluster: The segment.
        matched: (n, k) point of each marker, ``HIDDEN`` where none.
        squared: (n, k) squared distances of these points from the placed markers, m².
    """
    ratios = log_likelihood_ratio(squared, np.hypot(cluster.sd_m, PLACING_SD_M))
    return np.asarray(np.where(matched != HIDDEN, np.maximum(ratios, 0.0), 0.0).sum(axis=1))


def log_likelihood_ratio(squared: Array, sd_m: Array) -> Array:
    """(…, k) twice the log-likelihood ratio of marker and ghost for points at squared distances, with spreads (k,)."""
    ghosts = 2.0 * math.log(AssignmentSettings.ghosts_per_m3)
    return np.asarray(-squared / sd_m**2 - 3.0 * np.log(2.0 * np.pi * sd_m**2) - ghosts)


def _rotations(local_m: Array, arms: Array, parent: Array) -> Array:
    """(n, 3, 3) orientations that point one or two markers at points."""
    radius = np.linalg.norm(local_m, axis=1)
    reach = np.abs(np.linalg.norm(arms, axis=1) - radius[:, None]) <= JOINT_TOLERANCE_M
    marker, point = np.nonzero(reach)
    if not len(marker):
        return np.zeros((0, 3, 3))
    own, found = local_m[marker], arms[point]
    single = found[:, :, None] * own[:, None]
    between = cdist(own, own)
    misfit = np.abs(between - cdist(found, found))
    # markers come in order, so that each pair is found once
    fits = (misfit <= LENGTH_TOLERANCE_M) & (marker[:, None] < marker) & (point[:, None] != point)
    one, two = np.nonzero(fits)
    # Long distances determine the orientation better, and are matched less often by chance.
    pairs = np.argsort(misfit[one, two] - 0.1 * between[one, two])[:_MOST]
    both = single[one[pairs]] + single[two[pairs]]
    return nearest_rotations(np.concatenate([both, single[:_MOST]]) + _POSTURE_PULL * parent)
