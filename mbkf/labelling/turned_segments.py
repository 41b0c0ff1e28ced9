"""Names permuted within a segment for a whole trial, where the markers then fit the segment turned about.

Four markers near the corners of a rectangle fit it as well turned by 180°, and their distances to a marker on the axis
of that turn stay as they are: neither distances nor the fit of one segment show that names are permuted. The neighbour
does: R_p and R are rotations of a proximal segment and the segment itself since a posture in which the places of all
markers are known (Kabsch, Acta Cryst. A32, 1976, 922-923), and R_pᵀ R would be a joint turned by more than people can.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.exchanges import Exchange, undo_exchanges
from mbkf.numerics.runs import spread_indices

LOOKS = 20
"""Frames, spread over the trial, in which segments are fitted."""

LEAST_MARKERS = 3
"""Least number of markers of a segment and of its proximal one."""

TURNED_RAD, STRAIGHT_RAD = np.radians(100.0), np.radians(60.0)
"""Rotation of a joint above which it is suspect, and below which names must bring it."""

SHARE = 0.8
"""Share of the frames in which either must hold."""

MOST_TRIED = 5000
"""Greatest number of permutations that are tried: one or two exchanged pairs of 14 markers."""


def find_turned(
    positions_m: Array, places_m: Array, segments: Sequence[str], proximal: Mapping[str, str]
) -> tuple[Exchange, ...]:
    """Exchanges of one or two pairs of names on a segment, in all frames, that undo an impossible turn of it.

    Args:
        positions_m: (T, M, 3) named trajectories, NaN where hidden.
        places_m: (M, 3) places of the markers in a known posture; NaN where unknown.
        segments: (M,) segment of each marker.
        proximal: Proximal segment by segment.
    """
    found: list[Exchange] = []
    for segment in dict.fromkeys(segments):
        own, other = (
            [m for m, name in enumerate(segments) if name == one and np.isfinite(places_m[m]).all()]
            for one in (segment, proximal.get(segment))
        )
        if min(len(own), len(other)) < LEAST_MARKERS:
            continue
        seen = np.isfinite(positions_m[:, [*own, *other]]).all(axis=(1, 2))
        frames = undo_exchanges(positions_m, found)[seen][spread_indices(int(seen.sum()), LOOKS)]
        if len(frames):
            base, _ = _fitted(frames[:, other], places_m[other])
            pairs = _permuted(frames[:, own], places_m[own], base)
            every = np.ones(len(positions_m), dtype=bool)
            found += [Exchange(own[a], own[b], every) for a, b in pairs]
    return tuple(found)


def _permuted(frames_m: Array, places_m: Array, base: Array) -> Sequence[tuple[int, int]]:
    """Pairs of the markers (F, n, 3) whose exchange straightens the joint and fits at least as well; empty without."""
    turned, cost = _fitted(frames_m, places_m)
    if not _most(_angles(base, turned) > TURNED_RAD):
        return ()
    best: Sequence[tuple[int, int]] = ()
    for pairs in _tried(len(places_m)):
        order = np.arange(len(places_m))
        for a, b in pairs:
            order[a], order[b] = b, a
        turned, other = _fitted(frames_m[:, order], places_m)
        if other <= cost and _most(_angles(base, turned) < STRAIGHT_RAD):
            best, cost = pairs, other
    return best


def _tried(count: int) -> Iterator[Sequence[tuple[int, int]]]:
    """One and two disjoint pairs of so many markers."""
    pairs = list(combinations(range(count), 2))
    yield from ((one,) for one in pairs)
    if len(pairs) ** 2 / 2 <= MOST_TRIED:
        yield from (two for two in combinations(pairs, 2) if not set(two[0]) & set(two[1]))


def _fitted(frames_m: Array, places_m: Array) -> tuple[Array, float]:
    """(F, 3, 3) rotations that fit places (n, 3) to frames (F, n, 3), and the median of squared distances, m²."""
    x, p = frames_m - frames_m.mean(axis=1, keepdims=True), places_m - places_m.mean(axis=0)
    u, s, vt = np.linalg.svd(np.einsum("fni,nj->fij", x, p))
    flip = np.sign(np.linalg.det(u @ vt))
    u, s = u.copy(), s.copy()
    u[:, :, 2] *= flip[:, None]
    s[:, 2] *= flip
    return u @ vt, float(np.median((x**2).sum(axis=(1, 2)) + (p**2).sum() - 2.0 * s.sum(axis=1)))


def _angles(base: Array, turned: Array) -> Array:
    """(F,) angles of baseᵀ turned, rad."""
    trace = np.einsum("fij,fij->f", base, turned)
    return np.asarray(np.arccos(np.clip(0.5 * (trace - 1.0), -1.0, 1.0)))


def _most(held: BoolArray) -> bool:
    return bool(held.mean() >= SHARE)
