"""Beam search of a body on unlabelled points: partial bodies, extended by one segment after the other.

The search begins with candidate poses of the root. Every partial body is extended by the likeliest placements of the
next segment, and the best of the extended bodies (the beam) are kept.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.placing import match, placings, worths
from mbkf.labelling.seeds import Seeds
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

BEAM = 40
"""Beam width: how many partial bodies are kept after every segment."""

LIMBS = 10
"""How many are kept at the end of a limb: its alternatives must not crowd out those of the next limb."""

BRANCHES = 8
"""How many placements of a segment extend each partial body."""

ROOTS = 120
"""How many poses of the root the search begins with."""


@dataclass(frozen=True)
class PartialBody:
    """A body whose first segments are placed.

    Attributes:
        rotations: (S, 3, 3) orientation of the segments, in the order of the clusters; NaN where not placed.
        origins_m: (S, 3) their joints.
        points: (M,) point of every marker, ``HIDDEN`` where none.
        score: Worth of its matches.
    """

    rotations: Array
    origins_m: Array
    points: Indices
    score: float


def search_bodies(body: tuple[Cluster, ...], points_m: Array, seeds: Seeds, most: int) -> list[PartialBody]:
    """The best bodies that explain the points, best first, at most ``most`` of them.

    Args:
        body: Its segments, root first.
        points_m: (N, 3) measured points.
        seeds: Where the root may be.
        most: How many to return.
    """
    return _extended(_roots(body, points_m, seeds), body, range(1, len(body)), points_m)[:most]


def search_limb(
    body: tuple[Cluster, ...], points_m: Array, whole: PartialBody, limb: Sequence[int], most: int
) -> list[PartialBody]:
    """The best bodies with one limb searched again among the points that the rest of the body leaves.

    Args:
        body: Its segments, root first.
        points_m: (N, 3) measured points.
        whole: A whole body.
        limb: Numbers of the limb's segments, from the proximal one on.
        most: How many to return.
    """
    points = whole.points.copy()
    for number in limb:
        points[body[number].markers] = HIDDEN
    return _extended([replace(whole, points=points, score=0.0)], body, limb, points_m)[:most]


def _extended(
    beam: list[PartialBody], body: tuple[Cluster, ...], numbers: Iterable[int], points_m: Array
) -> list[PartialBody]:
    for number in numbers:
        extended = [bigger for one in beam for bigger in _with(one, body, number, points_m)]
        ends = all(cluster.parent != number for cluster in body)
        beam = _best(extended, LIMBS if ends else BEAM)
    return beam


def _roots(body: tuple[Cluster, ...], points_m: Array, seeds: Seeds) -> list[PartialBody]:
    """Bodies of the root alone; those whose seed matches most of its markers."""
    root, (rotations, origins) = body[0], seeds
    if not len(rotations):
        return []
    markers = sum(len(cluster.markers) for cluster in body)
    placed = origins[:, None] + np.einsum("nij,kj->nki", rotations, root.local_m)
    matched, squared = match(placed, points_m)
    worth = worths(root, matched, squared)
    found: dict[bytes, PartialBody] = {}
    for n in np.argsort(-worth):
        key = matched[n].tobytes()
        if key in found:
            continue
        rotation, origin = _settled(root.local_m, matched[n], points_m, rotations[n], origins[n])
        points = np.full(markers, HIDDEN, dtype=np.intp)
        points[root.markers] = matched[n]
        turns, joints = np.full((len(body), 3, 3), np.nan), np.full((len(body), 3), np.nan)
        turns[0], joints[0] = rotation, origin
        found[key] = PartialBody(turns, joints, points, float(worth[n]))
        if len(found) == ROOTS:
            break
    return list(found.values())


def _settled(
    local_m: Array, matched: Indices, points_m: Array, rotation: Array, origin: Array
) -> tuple[Array, Array]:
    """The root's pose by all of its matched markers, where there are three."""
    seen = matched != HIDDEN
    if seen.sum() < 3:
        return rotation, origin
    own, found = local_m[seen], points_m[matched[seen]]
    attitude = (found - found.mean(axis=0)).T @ (own - own.mean(axis=0))
    # Markers in one line leave the turn about it open; the seed decides it.
    turned = nearest_rotations((attitude + 1e-4 * rotation)[None])[0]
    return turned, found.mean(axis=0) - turned @ own.mean(axis=0)


def _with(one: PartialBody, body: tuple[Cluster, ...], number: int, points_m: Array) -> list[PartialBody]:
    cluster = body[number]
    parent = one.rotations[cluster.parent]
    origin = one.origins_m[cluster.parent] + parent @ cluster.origin_m
    untaken = np.ones(len(points_m), dtype=bool)
    untaken[one.points[one.points != HIDDEN]] = False
    free = np.flatnonzero(untaken)
    bigger = []
    for way in placings(cluster, origin, parent, points_m, free, BRANCHES):
        points = one.points.copy()
        points[cluster.markers] = way.points
        rotations, origins = one.rotations.copy(), one.origins_m.copy()
        rotations[number], origins[number] = way.rotation, origin
        bigger.append(PartialBody(rotations, origins, points, one.score + way.score))
    return bigger


def _best(bodies: Iterable[PartialBody], most: int) -> list[PartialBody]:
    """The best of them, each labelling once."""
    found: dict[bytes, PartialBody] = {}
    for one in sorted(bodies, key=lambda body: -body.score):
        found.setdefault(one.points.tobytes(), one)
        if len(found) == most:
            break
    return list(found.values())
