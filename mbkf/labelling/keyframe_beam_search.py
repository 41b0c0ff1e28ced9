"""Beam search of a body of roughly known geometry on tracks, in any attitude and at several keyframes at once.

The search of :mod:`mbkf.labelling.beam_search`, with whole tracks in the place of the points of one frame.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.keyframe_placing import LENGTH_M, REACH_M, KeyframePlacing
from mbkf.labelling.keyframes import Keyframes
from mbkf.labelling.skeleton import Cluster

BEAM, LIMBS, BRANCHES = 40, 10, 8
"""Partial bodies kept after a segment and at the end of a limb; placements of a segment that extend each of them."""

ROOTS = 400
"""How many poses of the root the search begins with."""

TRIPLES = 6
"""How many triples of the root's markers are tried."""

LEAST_AREA_M2 = 0.0025
"""Three markers that span less are nearly in line."""


@dataclass(frozen=True)
class KeyframeBody:
    """A body whose first segments are placed on tracks.

    Attributes:
        rotations: (K, S, 3, 3) orientation of the segments, in the order of the clusters; NaN where not placed.
        origins_m: (K, S, 3) their joints.
        tracks: (M,) place among the keyframes' tracks of every marker's own, ``HIDDEN`` where none.
        score: Worth of its matches.
    """

    rotations: Array
    origins_m: Array
    tracks: Indices
    score: float


def search_keyframes(body: tuple[Cluster, ...], seen: Keyframes, most: int) -> list[KeyframeBody]:
    """The bodies that explain the tracks best, best first, at most ``most`` of them.

    Args:
        body: Its segments, root first.
        seen: The tracks.
        most: How many to return.
    """
    placing = KeyframePlacing(seen)
    beam = _roots(body, placing)
    for number in range(1, len(body)):
        extended = [bigger for one in beam for bigger in _with(one, body, number, placing)]
        ends = all(cluster.parent != number for cluster in body)
        beam = _best(extended, LIMBS if ends else BEAM)
    return beam[:most]


def _roots(body: tuple[Cluster, ...], placing: KeyframePlacing) -> list[KeyframeBody]:
    """Bodies of the root alone: three of its markers on tracks at the same distances, and all others that fit then."""
    root, count = body[0], len(placing.seen.tracks)
    every, nowhere = np.arange(count), np.zeros((len(placing.seen.frames), 3))
    reach = np.full(len(root.markers), REACH_M)
    found: list[KeyframeBody] = []
    for three in _triples(root.local_m):
        own = root.local_m[list(three)]
        near = [
            (np.abs(placing.seen.length_m - np.linalg.norm(own[b] - own[a])) <= LENGTH_M) & placing.together
            for a, b in ((0, 1), (1, 2), (0, 2))
        ]
        chosen = np.argwhere(near[0][:, :, None] & near[1][None] & near[2][:, None, :])
        chosen = chosen[(np.diff(np.sort(chosen, axis=1), axis=1) > 0).all(axis=1)]
        if not len(chosen):
            continue
        tracks = np.full((len(chosen), len(root.markers)), HIDDEN, dtype=np.intp)
        tracks[:, list(three)] = chosen
        allowed = np.asarray(placing.together[chosen].all(axis=1))
        for _ in range(2):
            rotations, origins = placing.settle(root.local_m, tracks, nowhere, None)
            tracks, worth = placing.rate(root, rotations, origins, every, allowed, reach)
        markers = sum(len(cluster.markers) for cluster in body)
        for n in np.flatnonzero((tracks != HIDDEN).sum(axis=1) >= 3):
            whole = np.full(markers, HIDDEN, dtype=np.intp)
            whole[root.markers] = tracks[n]
            turns = np.full((len(nowhere), len(body), 3, 3), np.nan)
            joints = np.full((len(nowhere), len(body), 3), np.nan)
            turns[:, 0], joints[:, 0] = rotations[n], origins[n]
            found.append(KeyframeBody(turns, joints, whole, float(worth[n])))
    return _best(found, ROOTS)


def _triples(local_m: Array) -> list[tuple[int, int, int]]:
    """Triples of markers that are not in line; those that span most area first."""

    def area(three: tuple[int, int, int]) -> float:
        a, b, c = local_m[list(three)]
        return float(np.linalg.norm(np.cross(b - a, c - a)))

    every = sorted(combinations(range(len(local_m)), 3), key=area, reverse=True)
    return [three for three in every if area(three) > LEAST_AREA_M2][:TRIPLES]


def _with(
    one: KeyframeBody, body: tuple[Cluster, ...], number: int, placing: KeyframePlacing
) -> Iterable[KeyframeBody]:
    cluster = body[number]
    parents = one.rotations[:, cluster.parent]
    origins = one.origins_m[:, cluster.parent] + parents @ cluster.origin_m
    free = np.setdiff1d(np.arange(len(placing.seen.tracks)), one.tracks)
    for way in placing.placings(cluster, origins, parents, free, BRANCHES):
        tracks, rotations, joints = one.tracks.copy(), one.rotations.copy(), one.origins_m.copy()
        tracks[cluster.markers] = way.tracks
        rotations[:, number], joints[:, number] = way.rotations, way.origins_m
        yield replace(one, rotations=rotations, origins_m=joints, tracks=tracks, score=one.score + way.score)


def _best(bodies: Iterable[KeyframeBody], most: int) -> list[KeyframeBody]:
    """The best of them, each set of tracks once."""
    found: dict[bytes, KeyframeBody] = {}
    for one in sorted(bodies, key=lambda body: -body.score):
        found.setdefault(one.tracks.tobytes(), one)
        if len(found) == most:
            break
    return list(found.values())
