"""Points that are combinations of others in every frame: midpoints and centroids that software stored among markers.

A point p of a capture is a combination of n others a_i if

    p(t) = Σ_i w_i a_i(t),   Σ_i w_i = 1,   w_i > 0

with the same weights in all frames. Skin moves, and cameras have noise: the distances between the a_i vary, and a
marker keeps no such relation to the last digit. Where the a_i are rigid to the last digit themselves, as in captures
without noise, any marker between them keeps it, and nothing is concluded.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.numerics.runs import spread_indices

FRAMES = 40
"""Number of frames, spread over a capture."""

FEWEST_FRAMES = 5
"""Least number of frames with all points of a relation."""

EXACT_M = 0.08e-3
"""Greatest RMS distance of a combination from the point: files keep a tenth of a millimetre or better. Markers of
public captures are 0.65 mm and more from every line between two others."""

EXACT_SHARE = 0.1
"""Greatest RMS distance as a share of the standard deviation of the distances between the combined points."""

LEAST_WEIGHT = 0.02
"""Least weight: with less the point is beside one of the others."""

OPPOSITE = -1.0 + 1e-4
"""Cosine of the angle between the directions to two others below which a point may be between them: 179°."""

LARGEST, NEIGHBOURS = 4, 8
"""Greatest number of combined points, and the number of nearest ones among which three or more are sought."""


def combined_points(captures: Iterable[MarkerTrajectories]) -> dict[str, tuple[str, ...]]:
    """Names of the points that each point is a combination of, by the point's name.

    Args:
        captures: Markers of one person's captures; a relation in one of them suffices.
    """
    found: dict[str, tuple[str, ...]] = {}
    for markers in captures:
        found = _combined(markers) | found
    return found


def _combined(markers: MarkerTrajectories) -> dict[str, tuple[str, ...]]:
    points = markers.positions_m[spread_indices(markers.frames, FRAMES)]
    shown = np.flatnonzero(np.isfinite(points[:, :, 0]).sum(axis=0) >= FEWEST_FRAMES)
    points, names = points[:, shown], [markers.names[k] for k in shown]
    if len(points) < FEWEST_FRAMES or len(names) < 3:
        return {}
    found = {}
    for k, name in enumerate(names):
        others = next((some for some in _candidates(points, k) if _combines(points, k, some)), None)
        if others is not None:
            found[name] = tuple(names[j] for j in others)
    return found


def _candidates(points: Array, k: int) -> Iterator[tuple[int, ...]]:
    """Numbers of the points that point k combines in some frames, fewest first."""
    yield from _opposite(points, k)
    near = _nearest(points, k)
    complete = np.flatnonzero(np.isfinite(points[:, [k, *near]]).all(axis=(1, 2)))
    if len(complete) < FEWEST_FRAMES:
        return
    few = points[complete[spread_indices(len(complete), FEWEST_FRAMES)]]
    for count in range(3, min(LARGEST, len(near)) + 1):
        sets = np.array(list(combinations(near, count)))
        edges = few[:, sets[:, 1:]] - few[:, sets[:, :1]]  # (frames, sets, count - 1, 3)
        edges = edges.transpose(1, 0, 3, 2).reshape(len(sets), -1, count - 1)
        target = (few[:, k, None] - few[:, sets[:, 0]]).transpose(1, 0, 2).reshape(len(sets), -1, 1)
        off = target - edges @ (np.linalg.pinv(edges) @ target)
        close = np.sqrt(np.mean(off[:, :, 0] ** 2, axis=1) * 3.0) <= EXACT_M
        yield from (tuple(map(int, some)) for some in sets[close])


def _nearest(points: Array, k: int) -> list[int]:
    """Numbers of the points nearest to point k on average over the frames that show both."""
    away = np.linalg.norm(points - points[:, k : k + 1], axis=2)
    both = np.isfinite(away)
    mean = np.full(away.shape[1], np.inf)
    np.divide(np.where(both, away, 0.0).sum(axis=0), both.sum(axis=0), out=mean, where=both.any(axis=0))
    mean[k] = np.inf
    near = np.argsort(mean, kind="stable")[:NEIGHBOURS]
    return [int(j) for j in near if np.isfinite(mean[j])]


def _opposite(points: Array, k: int) -> list[tuple[int, int]]:
    """Pairs of points on opposite sides of point k in the frame that shows most of them."""
    away = points - points[:, k : k + 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        towards = away / np.linalg.norm(away, axis=2)[:, :, None]
        frame = towards[np.argmax(np.isfinite(towards).all(axis=2).sum(axis=1))]
        pairs = np.argwhere(np.triu(frame @ frame.T, 1) < OPPOSITE)
    return [(int(i), int(j)) for i, j in pairs[_on_line(points, k, pairs)]]


def _on_line(points: Array, k: int, pairs: NDArray[np.intp]) -> BoolArray:
    """(P,) True where point k stays close to one place on the line through the two of a pair (P, 2)."""
    edge = points[:, pairs[:, 1]] - points[:, pairs[:, 0]]
    target = points[:, k : k + 1] - points[:, pairs[:, 0]]
    there: BoolArray = np.asarray(np.isfinite(edge + target).all(axis=2))
    edge, target = (np.where(there[..., None], one, 0.0) for one in (edge, target))
    share = (edge * target).sum(axis=(0, 2)) / np.maximum((edge**2).sum(axis=(0, 2)), np.finfo(float).tiny)
    square = ((share[:, None] * edge - target) ** 2).sum(axis=(0, 2))
    return np.asarray(square <= (1.01 * EXACT_M) ** 2 * there.sum(axis=0))


def _combines(points: Array, k: int, others: Sequence[int]) -> bool:
    """True if point k is a combination of others in all frames (T, K, 3) that show them."""
    chosen = points[:, [k, *others]]
    chosen = chosen[np.isfinite(chosen).all(axis=(1, 2))]
    if len(chosen) < FEWEST_FRAMES:
        return False
    own, base = chosen[:, 0], chosen[:, 1:]
    edges = (base[:, 1:] - base[:, :1]).transpose(0, 2, 1).reshape(-1, len(others) - 1)
    target = (own - base[:, 0]).ravel()
    rest, *_ = np.linalg.lstsq(edges, target, rcond=None)
    weights = np.array([1.0 - rest.sum(), *rest])
    if weights.min() < LEAST_WEIGHT:
        return False
    off = float(np.sqrt(np.mean((edges @ rest - target) ** 2) * 3.0))
    if off > EXACT_M:
        return False
    pairs = combinations(range(len(others)), 2)
    spread = min(float(np.std(np.linalg.norm(base[:, i] - base[:, j], axis=1))) for i, j in pairs)
    return off <= EXACT_SHARE * spread
