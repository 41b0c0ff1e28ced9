"""Poses of one segment that match its marker cluster with unlabelled points, by distances between points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import HIDDEN, AssignmentSettings, Indices
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

MATCH_M = 0.045
"""A point further than this from where a placed segment has a marker is not that marker."""

PLACING_SD_M = 0.008
"""How far a segment placed by two points is off, besides the spread of its markers."""

MOST_POSTURE = 8.0
"""Greatest cost of an unusual turn of a joint: people squat and kneel."""

JOINT_TOLERANCE_M = 0.045
"""How far a joint may be from where the chain placed it."""

LENGTH_TOLERANCE_M = 0.025
"""How much two markers' distance may differ from that on the body."""

_POSTURE_PULL = 2e-3
_MOST = 80


@dataclass(frozen=True)
class Placing:
    """One way to place a segment.

    Attributes:
        rotation: (3, 3) its orientation in the world.
        points: (k,) the point of each of its markers, ``HIDDEN`` where none.
        score: Log-likelihood ratio of its matches, less the cost of the joint's turn.
    """

    rotation: Array
    points: Indices
    score: float


def placings(
    cluster: Cluster, origin_m: Array, parent: Array, points_m: Array, free: Indices, most: int
) -> list[Placing]:
    """The best ways to place a segment whose joint and parent are placed, one of them with no marker found.

    Args:
        cluster: The segment.
        origin_m: (3,) its joint.
        parent: (3, 3) orientation of the segment before.
        points_m: (N, 3) all points.
        free: Points not yet taken.
        most: How many to return at most.
    """
    nothing = Placing(parent, np.full(len(cluster.markers), HIDDEN, dtype=np.intp), 0.0)
    if not len(cluster.markers) or not len(free):
        return [nothing]
    arms = points_m[free] - origin_m
    rotations = _rotations(cluster.local_m, arms, parent)
    if not len(rotations):
        return [nothing]
    matched, squared = match(np.einsum("nij,kj->nki", rotations, cluster.local_m), arms)
    turn = np.arccos(np.clip((np.einsum("nij,ij->n", rotations, parent) - 1.0) / 2.0, -1.0, 1.0))
    score = worths(cluster, matched, squared) - np.minimum((turn / cluster.posture_sd_rad) ** 2, MOST_POSTURE)
    found: list[Placing] = []
    seen = set()
    for n in np.argsort(-score):
        key = matched[n].tobytes()
        if key not in seen and (matched[n] != HIDDEN).any():
            seen.add(key)
            own = np.where(matched[n] == HIDDEN, HIDDEN, free[matched[n]])
            found.append(Placing(rotations[n], own, float(score[n])))
        if len(found) == most - 1:
            break
    return [*found, nothing]


def match(placed: Array, points_m: Array) -> tuple[Indices, Array]:
    """Nearest points of placed clusters (n, k, 3): their indices (n, k) and squared distances.

    ``HIDDEN`` where none lies within reach, or where another marker of the cluster lies nearer to it.
    """
    away = placed[:, :, None] - points_m
    squared = np.einsum("nkpi,nkpi->nkp", away, away)
    nearest = squared.argmin(axis=2)
    least = np.take_along_axis(squared, nearest[:, :, None], axis=2)[:, :, 0]
    same = nearest[:, :, None] == nearest[:, None]
    beaten = (same & (least[:, None] < least[:, :, None])).any(axis=2)
    good = (least <= MATCH_M**2) & ~beaten
    return np.where(good, nearest, HIDDEN), np.where(good, least, 0.0)


def worths(cluster: Cluster, matched: Indices, squared: Array) -> Array:
    """(n,) log-likelihood ratios of alternative matches, summed over their markers, see :func:`likeness`.

    Args:
        cluster: The segment.
        matched: (n, k) point of each marker, ``HIDDEN`` where none.
        squared: (n, k) squared distances of these points from the placed markers, m².
    """
    worth = likeness(squared, np.hypot(cluster.sd_m, PLACING_SD_M))
    return np.asarray(np.where(matched != HIDDEN, np.maximum(worth, 0.0), 0.0).sum(axis=1))


def likeness(squared: Array, sd_m: Array) -> Array:
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
    single = arms[point][:, :, None] * local_m[marker][:, None]
    one, two = np.triu_indices(len(marker), 1)
    between = np.linalg.norm(local_m[marker[one]] - local_m[marker[two]], axis=1)
    apart = np.linalg.norm(arms[point[one]] - arms[point[two]], axis=1)
    misfit = np.abs(between - apart)
    fits = (marker[one] != marker[two]) & (point[one] != point[two]) & (misfit <= LENGTH_TOLERANCE_M)
    pairs = np.flatnonzero(fits)
    # Long distances determine the orientation better, and are matched less often by chance.
    pairs = pairs[np.argsort(misfit[pairs] - 0.1 * between[pairs])[:_MOST]]
    both = single[one[pairs]] + single[two[pairs]]
    return nearest_rotations(np.concatenate([both, single[:_MOST]]) + _POSTURE_PULL * parent)
