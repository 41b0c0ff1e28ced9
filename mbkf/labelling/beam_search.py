"""Beam search of a body on the unlabelled points of one frame, from candidate poses of the root."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.beam import PartialBody, Placing, distinct_rows, extended_beam
from mbkf.labelling.placing import FramePlacings, match, match_log_ratios
from mbkf.labelling.seeds import Seeds
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

ROOTS = 120
"""Greatest number of poses of the root that the search begins with."""


def search_bodies(body: tuple[Cluster, ...], points_m: Array, seeds: Seeds, most: int) -> list[PartialBody]:
    """The bodies that explain the points best, best first, at most ``most`` of them.

    Args:
        body: Its segments, root first.
        points_m: (N, 3) measured points.
        seeds: Candidate poses of the root.
        most: Greatest number of bodies.
    """
    roots = _roots(body, points_m, seeds)
    return extended_beam(roots, body[1:], len(points_m), FramePlacings(points_m))[:most]


def search_limb(points_m: Array, whole: PartialBody, limb: Sequence[Cluster], most: int) -> list[PartialBody]:
    """The best bodies with one limb searched again among the points that the rest of the body leaves.

    Args:
        points_m: (N, 3) measured points.
        whole: A whole body.
        limb: The limb's segments, from the proximal one on.
        most: Greatest number of bodies.
    """
    labels = whole.labels.copy()
    labels[np.concatenate([cluster.markers for cluster in limb])] = HIDDEN
    beam = [replace(whole, labels=labels, score=0.0)]
    return extended_beam(beam, limb, len(points_m), FramePlacings(points_m))[:most]


def _roots(body: tuple[Cluster, ...], points_m: Array, seeds: Seeds) -> list[PartialBody]:
    """Bodies of the root alone; those whose seed matches most of its markers."""
    root, (rotations, origins) = body[0], seeds
    if not len(rotations):
        return []
    placed = origins[:, None] + np.einsum("nij,kj->nki", rotations, root.local_m)
    matched, squared = match(placed, points_m)
    ratios = match_log_ratios(root, matched, squared)
    found = []
    for n in distinct_rows(matched, ratios, ROOTS):
        pose = _pose_by_all(root.local_m, matched[n], points_m, rotations[n], origins[n])
        found.append(PartialBody.of_root(body, Placing(*pose, matched[n], float(ratios[n]))))
    return found


def _pose_by_all(
    local_m: Array, matched: Indices, points_m: Array, rotation: Array, origin: Array
) -> tuple[Array, Array]:
    """The root's pose by all of its matched markers, where there are three; else its seed."""
    seen = matched != HIDDEN
    if seen.sum() < 3:
        return rotation, origin
    own, found = local_m[seen], points_m[matched[seen]]
    attitude = (found - found.mean(axis=0)).T @ (own - own.mean(axis=0))
    # Markers in one line leave the turn about it open; the seed decides it.
    turned = nearest_rotations((attitude + 1e-4 * rotation)[None])[0]
    return turned, found.mean(axis=0) - turned @ own.mean(axis=0)
