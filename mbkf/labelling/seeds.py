"""Candidate poses of the root among unlabelled points: upright by two of its markers, in any attitude by three."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.beam import matching_triples
from mbkf.labelling.placing import LENGTH_TOLERANCE_M, MATCH_M
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

TILT_M = 0.06
"""Greatest difference of a height between two markers of an upright root from that in the neutral posture."""

LEAST_SPAN_M = 0.05
"""Two markers nearer than this in the horizontal plane do not determine a heading."""

Seeds = tuple[Array, Array]
"""(n, 3, 3) orientations and (n, 3) origins of the root."""


def upright_seeds(root: Cluster, points_m: Array) -> Seeds:
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
        rotation = np.zeros((len(yaw), 3, 3))
        rotation[:, 0, 0] = rotation[:, 1, 1] = np.cos(yaw)
        rotation[:, 1, 0], rotation[:, 0, 1] = np.sin(yaw), -np.sin(yaw)
        rotation[:, 2, 2] = 1.0
        middle = 0.5 * (points_m[first] + points_m[second])
        turns.append(rotation)
        origins.append(middle - rotation @ (0.5 * (root.local_m[i] + root.local_m[j])))
    return np.concatenate(turns), np.concatenate(origins)


def seeds_in_any_attitude(root: Cluster, points_m: Array) -> Seeds:
    """All poses that take three markers of the root to three points at the same distances."""
    length = np.linalg.norm(points_m[None] - points_m[:, None], axis=2)
    turns, origins = [np.zeros((0, 3, 3))], [np.zeros((0, 3))]
    for three, chosen in matching_triples(root.local_m, length, LENGTH_TOLERANCE_M):
        own, found = root.local_m[three], points_m[chosen]
        middle, own_middle = found.mean(axis=1), own.mean(axis=0)
        attitude = np.einsum("nki,kj->nij", found - middle[:, None], own - own_middle)
        rotation = nearest_rotations(attitude)
        misfit = found - middle[:, None] - np.einsum("nij,kj->nki", rotation, own - own_middle)
        good = np.einsum("nki,nki->n", misfit, misfit) <= len(own) * MATCH_M**2 / 4.0
        turns.append(rotation[good])
        origins.append((middle - rotation @ own_middle)[good])
    return np.concatenate(turns), np.concatenate(origins)
