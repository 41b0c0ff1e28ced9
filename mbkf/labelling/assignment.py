"""Measured points to predicted markers, all at once: the most likely assignment inside every marker's gate.

The point of marker i lies about its prediction with innovation covariance S_i; a point of no marker (a ghost) may lie
anywhere, with density λ per m³. The cost of a pair is minus twice the log-likelihood ratio of the two hypotheses
(Blackman & Popoli, *Design and Analysis of Modern Tracking Systems*, 1999, ch. 6), with d²_ij the squared Mahalanobis
distance where thesis eq. 4.6 has the Euclidean one:

    c_ij = d²_ij + ln det(2π S_i) + 2 ln λ

A negative cost is better than a hidden marker and a ghost; ``linear_sum_assignment`` finds the
cheapest set of pairs, so that no point gets two labels and no marker two points. Departs from thesis eq. 4.6 in this,
too: the thesis takes the nearest pairs first.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from mbkf.conventions import Array, BoolArray

HIDDEN = -1
"""Index that stands for no point (of a hidden marker) and for no marker (of a ghost point)."""

Indices = NDArray[np.intp]


@dataclass(frozen=True)
class AssignmentSettings:
    """Gates and prior probabilities of an assignment.

    Attributes:
        gate: Greatest squared Mahalanobis distance (3 coordinates) of a marker's point.
        radius_m: Greatest distance of a marker's point.
        ghosts_per_m3: Expected density of ghosts, λ.
        near_m: A point this near its marker, with every other marker and point further than ``clear_m``, is taken
            without covariances.
        clear_m: See ``near_m``.
        known_bonus: Reduction of a pair's cost where it was a pair in the frame before, by the point's own track.
    """

    gate: float = 25.0
    radius_m: float = 0.15
    ghosts_per_m3: float = 5.0
    near_m: float = 0.010
    clear_m: float = 0.025
    known_bonus: float = 6.0


def assign(
    predicted_m: Array,
    points_m: Array,
    covariance: Callable[[BoolArray], Array],
    settings: AssignmentSettings,
    known: Callable[[], Indices | None] | None = None,
) -> Indices:
    """(M,) index of each marker's point, ``HIDDEN`` where it has none.

    Args:
        predicted_m: (M, 3) predicted markers.
        points_m: (N, 3) measured points, none of them missing, in any order.
        covariance: Gives S, (m, 3, 3) in m², of the markers chosen by a mask (M,); called only where points are near
            to several markers or far from all.
        settings: Gate, radius, ghosts.
        known: Gives the marker (N,) of each point's own track in the frame before, ``HIDDEN`` where none; None where no
            track is known. Called only where pairs are in dispute.
    """
    if not len(points_m) or not len(predicted_m):
        return np.full(len(predicted_m), HIDDEN, dtype=np.intp)
    squared = squared_distances(predicted_m, points_m)
    found = _all_clear(squared, settings)
    if found is not None:
        return found
    carried = None if known is None else known()
    found = _undisputed(squared, settings, carried)
    own = (found == HIDDEN).nonzero()[0]
    left = np.ones(len(points_m), dtype=bool)
    left[found[found != HIDDEN]] = False
    near = (squared[own] <= settings.radius_m**2) & left
    own = own[near.any(axis=1)]
    if not len(own):
        return found
    hard, free = np.zeros(len(found), dtype=bool), near.any(axis=0).nonzero()[0]
    hard[own] = True
    offsets = points_m[free] - predicted_m[own][:, None]
    cost = pair_costs(offsets, covariance(hard), settings)
    if carried is not None:
        cost -= settings.known_bonus * (carried[free] == own[:, None])
    pairs = cheapest_pairs(cost)
    paired = pairs != HIDDEN
    found[own[paired]] = free[pairs[paired]]
    return found


def squared_distances(predicted_m: Array, points_m: Array) -> Array:
    """(M, N) squared Euclidean distances of points from predicted markers (thesis eq. 4.6)."""
    return np.asarray(cdist(predicted_m, points_m, "sqeuclidean"))


def pair_costs(offsets_m: Array, covariance: Array, settings: AssignmentSettings) -> Array:
    """(m, n) costs of pairs; infinite outside gate or radius.

    Args:
        offsets_m: (m, n, 3) point minus predicted marker.
        covariance: (m, 3, 3) of the innovation.
        settings: Gate, radius, ghosts.
    """
    whitened = np.linalg.solve(covariance, offsets_m.transpose(0, 2, 1))
    distance = np.einsum("ijk,ikj->ij", offsets_m, whitened)
    squared = np.einsum("ijk,ijk->ij", offsets_m, offsets_m)
    volume = np.log(np.linalg.det(2.0 * np.pi * covariance)) + 2.0 * math.log(settings.ghosts_per_m3)
    inside = (distance <= settings.gate) & (squared <= settings.radius_m**2)
    return np.where(inside, distance + volume[:, None], np.inf)


def cheapest_pairs(cost: Array) -> Indices:
    """(m,) column of each row in the cheapest set of pairs; rows stay ``HIDDEN`` where no column costs less than 0."""
    from scipy.optimize import linear_sum_assignment  # loads slowly

    found = np.full(len(cost), HIDDEN, dtype=np.intp)
    rows, columns = linear_sum_assignment(np.minimum(cost, 0.0))
    chosen = cost[rows, columns] < 0.0
    found[rows[chosen]] = columns[chosen]
    return found


def marker_of_point(labels: Indices, points: int) -> Indices:
    """(N,) the marker of each of N points, ``HIDDEN`` where none, from the point of every marker (M,)."""
    found = np.full(points, HIDDEN, dtype=np.intp)
    seen = labels != HIDDEN
    found[labels[seen]] = seen.nonzero()[0]
    return found


def _all_clear(squared: Array, settings: AssignmentSettings) -> Indices | None:
    """The labels where no pair is in dispute and no hidden marker may be a free point; else None.

    It runs in every frame, so it uses few calls; for the few hidden markers lists are quicker.
    """
    markers, points = squared.shape
    found = squared.argmin(axis=1)
    near = squared.ravel()[found + _row_starts(markers, points)] <= settings.near_m**2
    count = np.count_nonzero(near)
    if np.count_nonzero(squared <= settings.clear_m**2) != count:
        return None
    hidden = [] if count == markers else [i for i, found_near in enumerate(near.tolist()) if not found_near]
    for i in hidden:
        found[i] = HIDDEN
    taken = set(found.tolist())
    if len(taken) != min(count + 1, markers):
        return None
    farthest = settings.radius_m**2
    for i in hidden:
        for j, distance in enumerate(squared[i].tolist()):
            if distance <= farthest and j not in taken:
                return None
    return found


@cache
def _row_starts(rows: int, columns: int) -> Indices:
    """(rows,) first index of each row in the ravelled matrix."""
    return np.arange(rows) * columns


def _undisputed(squared: Array, settings: AssignmentSettings, known: Indices | None) -> Indices:
    """(M,) points of markers with one point near, no other point and, at that point, no other marker near."""
    every = squared.ravel()
    pairs = (every <= settings.clear_m**2).nonzero()[0]
    markers = pairs // squared.shape[1]
    points = pairs - squared.shape[1] * markers
    alone = every[pairs] <= settings.near_m**2
    alone &= (np.bincount(markers) == 1)[markers]
    alone &= (np.bincount(points) == 1)[points]
    if known is not None:
        carried = known[points]
        alone &= (carried == HIDDEN) | (carried == markers)
    found = np.full(len(squared), HIDDEN, dtype=np.intp)
    found[markers[alone]] = points[alone]
    return found
