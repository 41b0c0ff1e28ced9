"""Parts of the beam searches on one frame's points and on tracks at several keyframes.

A partial body is extended by one segment after the other, and the best of the extended bodies (the beam) are kept.
A label is the number of a marker's point, or of its track.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.skeleton import Cluster

BEAM = 40
"""Beam width: partial bodies that are kept after every segment."""

LIMBS = 10
"""Partial bodies kept at the end of a limb: its alternatives must not crowd out those of the next limb."""

BRANCHES = 8
"""Placements of a segment that extend each partial body."""

TRIPLES, LEAST_AREA_M2 = 6, 0.0025
"""Greatest number of triples of the root's markers, and the least area that each spans: others are nearly in line."""


@dataclass(frozen=True)
class Placing:
    """One way to place a segment, in one frame or at K keyframes (first axis).

    Attributes:
        rotation: (…, 3, 3) its orientation in the world.
        origin_m: (…, 3) its joint.
        labels: (k,) label of each of its markers, ``HIDDEN`` where none.
        score: Log-likelihood ratio of its matches, less the cost of its joint.
    """

    rotation: Array
    origin_m: Array
    labels: Indices
    score: float


@dataclass(frozen=True)
class PartialBody:
    """A body whose first segments are placed.

    Attributes:
        rotations: (…, S, 3, 3) orientation of the segments, in the order of the clusters; NaN where not placed.
        origins_m: (…, S, 3) their joints.
        labels: (M,) label of every marker, ``HIDDEN`` where none.
        score: Sum of its segments' scores.
    """

    rotations: Array
    origins_m: Array
    labels: Indices
    score: float

    @classmethod
    def of_root(cls, body: tuple[Cluster, ...], root: Placing) -> PartialBody:
        """A body whose root alone is placed."""
        lead, markers = root.origin_m.shape[:-1], sum(len(cluster.markers) for cluster in body)
        rotations, origins = np.full((*lead, len(body), 3, 3), np.nan), np.full((*lead, len(body), 3), np.nan)
        return cls(rotations, origins, np.full(markers, HIDDEN, dtype=np.intp), 0.0).extended(body[0], root)

    def extended(self, cluster: Cluster, way: Placing) -> PartialBody:
        """The body with one more segment."""
        rotations, origins, labels = self.rotations.copy(), self.origins_m.copy(), self.labels.copy()
        rotations[..., cluster.number, :, :], origins[..., cluster.number, :] = way.rotation, way.origin_m
        labels[cluster.markers] = way.labels
        return PartialBody(rotations, origins, labels, self.score + way.score)


def extended_beam(
    beam: list[PartialBody],
    clusters: Iterable[Cluster],
    count: int,
    placings: Callable[[Cluster, Array, Array, Indices], Iterable[Placing]],
) -> list[PartialBody]:
    """The best bodies after some segments were added, best first.

    Args:
        beam: Partial bodies to begin with.
        clusters: The segments to add, in their order.
        count: Number of points or tracks.
        placings: Gives the ways to place a segment, from its joint, its parent's orientation and the free labels.
    """
    for cluster in clusters:
        grown = []
        for one in beam:
            parent = one.rotations[..., cluster.parent, :, :]
            origin = one.origins_m[..., cluster.parent, :] + parent @ cluster.origin_m
            free = np.ones(count, dtype=bool)
            free[one.labels[one.labels != HIDDEN]] = False
            grown += [(one, way) for way in placings(cluster, origin, parent, np.flatnonzero(free))]
        beam = _best_grown(cluster, grown, LIMBS if cluster.ends else BEAM)
    return beam


def _best_grown(cluster: Cluster, grown: list[tuple[PartialBody, Placing]], most: int) -> list[PartialBody]:
    """The best bodies with one more segment, each labelling once; only these are made."""
    found: dict[tuple[bytes, bytes], PartialBody] = {}
    for one, way in sorted(grown, key=lambda pair: -(pair[0].score + pair[1].score)):
        labels = one.labels.tobytes(), way.labels.tobytes()
        if labels not in found:
            found[labels] = one.extended(cluster, way)
            if len(found) == most:
                break
    return list(found.values())


def best_bodies(bodies: list[PartialBody], most: int) -> list[PartialBody]:
    """The best of them, each labelling once."""
    found: dict[bytes, PartialBody] = {}
    for one in sorted(bodies, key=lambda body: -body.score):
        found.setdefault(one.labels.tobytes(), one)
    return list(found.values())[:most]


def distinct_rows(labels: Indices, score: Array, most: int) -> list[int]:
    """The best rows, best first, each labelling once.

    Args:
        labels: (n, k) labels.
        score: (n,) scores.
        most: Greatest number of rows.
    """
    found: dict[bytes, int] = {}
    for row in np.argsort(-score).tolist():
        found.setdefault(labels[row].tobytes(), row)
        if len(found) == most:
            break
    return list(found.values())


def matching_triples(
    local_m: Array, length_m: Array, tolerance_m: float, allowed: BoolArray | None = None
) -> Iterator[tuple[list[int], Indices]]:
    """Triples of a root's markers that are not in line, each with all triples (n, 3) of points at the same distances.

    Args:
        local_m: (k, 3) the root's markers.
        length_m: (N, N) distances of the points.
        tolerance_m: Greatest difference of two distances.
        allowed: (N, N) pairs of points that may be on one segment; all where None.
    """

    def area(three: tuple[int, ...]) -> float:
        a, b, c = local_m[list(three)]
        return float(np.linalg.norm(np.cross(b - a, c - a)))

    wide = sorted(combinations(range(len(local_m)), 3), key=area, reverse=True)
    for three in [list(one) for one in wide if area(one) > LEAST_AREA_M2][:TRIPLES]:
        own = local_m[three]
        near = [
            np.abs(length_m - np.linalg.norm(own[j] - own[i])) <= tolerance_m
            for i, j in ((0, 1), (1, 2), (0, 2))
        ]
        if allowed is not None:
            near = [one & allowed for one in near]
        chosen = np.argwhere(near[0][:, :, None] & near[1][None] & near[2][:, None, :])
        chosen = chosen[(np.diff(np.sort(chosen, axis=1), axis=1) > 0).all(axis=1)]
        if len(chosen):
            yield three, chosen
