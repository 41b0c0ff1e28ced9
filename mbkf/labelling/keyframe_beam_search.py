"""Beam search of a body of roughly known geometry on tracks, in any attitude and at several keyframes at once."""

from __future__ import annotations

import numpy as np

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.beam import PartialBody, Placing, best_bodies, extended_beam, matching_triples
from mbkf.labelling.keyframe_placing import LENGTH_M, REACH_M, KeyframePlacing
from mbkf.labelling.keyframes import Keyframes
from mbkf.labelling.skeleton import Cluster

ROOTS = 400
"""Greatest number of poses of the root that the search begins with."""


def search_keyframes(body: tuple[Cluster, ...], seen: Keyframes, most: int) -> list[PartialBody]:
    """The bodies that explain the tracks best, best first, at most ``most`` of them.

    A label is a marker's place among the keyframes' tracks.

    Args:
        body: Its segments, root first.
        seen: The tracks.
        most: Greatest number of bodies.
    """
    placing = KeyframePlacing(seen)
    return extended_beam(_roots(body, placing), body[1:], len(seen.tracks), placing.placings)[:most]


def _roots(body: tuple[Cluster, ...], placing: KeyframePlacing) -> list[PartialBody]:
    """Bodies of the root alone: three of its markers on tracks at the same distances, and all others that then fit."""
    root, seen = body[0], placing.seen
    every, nowhere = np.arange(len(seen.tracks)), np.zeros((len(seen.frames), 3))
    reach = np.full(len(root.markers), REACH_M)
    found: list[PartialBody] = []
    for three, chosen in matching_triples(root.local_m, seen.length_m, LENGTH_M, placing.together):
        tracks = np.full((len(chosen), len(root.markers)), HIDDEN, dtype=np.intp)
        tracks[:, three] = chosen
        allowed = np.asarray(placing.together[chosen].all(axis=1))
        for _ in range(2):
            rotations, origins = placing.settle(root.local_m, tracks, nowhere, None)
            tracks, ratios = placing.rate(root, rotations, origins, every, allowed, reach)
        ways = map(Placing, rotations, origins, tracks, ratios.tolist())
        found += [PartialBody.of_root(body, way) for way in ways if (way.labels != HIDDEN).sum() >= 3]
    return best_bodies(found, ROOTS)
