"""Candidate poses of the root among unlabelled points: upright by two of its markers, in any attitude by three."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.placing import LENGTH_TOLERANCE_M, MATCH_M
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

TILT_M = 0.06
"""How much higher one marker of an upright root may stand than in the neutral posture."""

LEAST_SPAN_M = 0.05
"""Two markers nearer than this do not determine which way a body faces."""

Seeds = tuple[Array, Array]
"""(n, 3, 3) orientations and (n, 3) origins of the root."""


def upright(root: Cluster, points_m: Array) -> Seeds:
    """All turns about the vertical that take two markers of the root to two points."""
    apart = points_m[None] - points_m[:, None]
    length = np.linalg.norm(apart, axis=2)
    turns, origins = [np.zeros((0, 3, 3))], [np.zeros((0, 3))]
    for i, j in combinations(range(len(root.local_m)), 2):
        own = root.local_m[j] - root.local_m[i]
        span = np.hypot(own[0], own[1])
        if span < LEAST_SPAN_M:
            continue
        same = np.abs(length - np.linalg.norm(own)) <= LENGTH_TOLERANCE_M
        first, second = np.nonzero(same & (np.abs(apart[:, :, 2] - own[2]) <= TILT_M))
        far = first != second
        first, second = first[far], second[far]
        found = apart[first, second]
        yaw = np.arctan2(found[:, 1], found[:, 0]) - np.arctan2(own[1], own[0])
        rotation = _about_vertical(yaw)
        middle = 0.5 * (points_m[first] + points_m[second])
        turns.append(rotation)
        origins.append(middle - rotation @ (0.5 * (root.local_m[i] + root.local_m[j])))
    return np.concatenate(turns), np.concatenate(origins)


def any_attitude(root: Cluster, points_m: Array) -> Seeds:
    """All poses that take three markers of the root to three points at the same distances."""
    length = np.linalg.norm(points_m[None] - points_m[:, None], axis=2)
    turns, origins = [np.zeros((0, 3, 3))], [np.zeros((0, 3))]
    for three in _triples(root.local_m):
        own = root.local_m[list(three)]
        sides = [np.linalg.norm(own[b] - own[a]) for a, b in ((0, 1), (1, 2), (0, 2))]
        near = [np.abs(length - side) <= LENGTH_TOLERANCE_M for side in sides]
        chosen = np.argwhere(near[0][:, :, None] & near[1][None] & near[2][:, None, :])
        chosen = chosen[(np.diff(np.sort(chosen, axis=1), axis=1) > 0).all(axis=1)]
        if not len(chosen):
            continue
        found = points_m[chosen]
        middle, own_middle = found.mean(axis=1), own.mean(axis=0)
        attitude = np.einsum("nki,kj->nij", found - middle[:, None], own - own_middle)
        rotation = nearest_rotations(attitude)
        misfit = found - middle[:, None] - np.einsum("nij,kj->nki", rotation, own - own_middle)
        good = np.einsum("nki,nki->n", misfit, misfit) <= len(own) * MATCH_M**2 / 4.0
        turns.append(rotation[good])
        origins.append((middle - rotation @ own_middle)[good])
    return np.concatenate(turns), np.concatenate(origins)


def _triples(local_m: Array) -> list[tuple[int, int, int]]:
    """Triples of markers that are not in line; those that span most area first, at most six."""

    def area(three: tuple[int, int, int]) -> float:
        a, b, c = local_m[list(three)]
        return float(np.linalg.norm(np.cross(b - a, c - a)))

    every = sorted(combinations(range(len(local_m)), 3), key=area, reverse=True)
    return [three for three in every if area(three) > LEAST_SPAN_M**2][:6]


def _about_vertical(yaw: Array) -> Array:
    turn = np.zeros((len(yaw), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(yaw)
    turn[:, 1, 0], turn[:, 0, 1] = np.sin(yaw), -np.sin(yaw)
    turn[:, 2, 2] = 1.0
    return turn
