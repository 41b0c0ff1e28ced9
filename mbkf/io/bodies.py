"""Bodies among the points of a capture, without names: points of one body stay at their distances, those of two do not.

A normalised cut (Shi 2000) parts the points where few of them keep near each other: with weights

    w_ij = exp(−(m_ij² + (2 s_ij)²) / ℓ²),

m the median distance of two points and s the width of the distances' middle nine tenths, it is the smallest sum of
w over both parts' total weights. Parts are bodies where they are person-sized, stand beside each other, and the cut is
far smaller than any cut through one body.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.percentiles import known_percentiles
from mbkf.numerics.runs import spread_indices

Indices = NDArray[np.intp]

FRAMES, LEAST_SEEN = 60, 0.3
"""Frames that are looked at, and the least share of them in which a point is seen that takes part in the cut."""

LINK_M = 0.25
"""Length ℓ of the weights."""

SPREAD = 2.0
"""Weight of a change of distance against a distance."""

MOST_CUT, MOST_CUT_TALL = 0.003, 0.03
"""Greatest normalised cut between two bodies, and between two that are both tall. Pairs of moving persons have up to
0.001, persons who stand still 0.8 m apart 0.03; cuts through one person have 0.004 and more."""

FEWEST_POINTS = 10
"""Least number of points of a body."""

APART_M, ACROSS_M, TALL_M = 0.45, 0.6, 1.0
"""Least distance of the middles of two bodies, least extent of each across the line between them, and that of a tall
one: parts of one person with a small cut between them extend by up to 0.8 m."""

VECTORS = 3
"""Eigenvectors that are tried: of standing bodies the first may part upper from lower halves."""


class _Cut(NamedTuple):
    """A cut in two.

    Attributes:
        value: Its normalised weight.
        first: (M,) points of the first part.
    """

    value: float
    first: BoolArray


def bodies_of(positions_m: Array) -> tuple[Indices, ...]:
    """The points of each body, bodies in the order of their first points; one body where no cut shows two.

    Args:
        positions_m: (T, M, 3) points, each a column through time; NaN where not seen.
    """
    shown = _frames(positions_m)
    if not len(shown):
        return (np.arange(positions_m.shape[1]),)
    seen = (~np.isnan(shown[:, :, 0])).mean(axis=0)
    often = np.flatnonzero(seen >= LEAST_SEEN)
    parts = _parted(shown.tobytes(), shown.shape[1], tuple(often.tolist()))
    owner = np.full(len(seen), -1)
    for number, part in enumerate(parts):
        owner[part] = number
    if len(parts) > 1:
        for column in np.flatnonzero(owner < 0):
            owner[column] = nearest_body(positions_m, int(column), parts)
    else:
        owner[:] = 0
    found = [np.flatnonzero(owner == number) for number in range(len(parts))]
    return tuple(sorted(found, key=lambda part: int(part[0])))


def _frames(positions_m: Array) -> Array:
    """(F, M, 3) frames spread over those in which at least half as many points are seen as in the fullest one."""
    seen = (~np.isnan(positions_m[:, :, 0])).sum(axis=1)
    good = np.flatnonzero((seen >= 0.5 * seen.max(initial=0)) & (seen > 0))
    return positions_m[good[spread_indices(len(good), FRAMES)]]


@lru_cache(maxsize=4)
def _parted(frames: bytes, points: int, columns: tuple[int, ...]) -> tuple[Indices, ...]:
    """The columns of each body among some, by repeated cuts; cached, since several stages ask.

    Args:
        frames: (F, M, 3) positions.
        points: Their number M.
        columns: Those to part.
    """
    shown = np.frombuffer(frames).reshape(-1, points, 3)
    bodies, open_parts = [], [np.array(columns, dtype=np.intp)]
    while open_parts:  # every cut leaves fewer columns in each part
        part = open_parts.pop()
        first = _two_bodies(shown[:, part])
        if first is None:
            bodies.append(part)
        else:
            open_parts += [part[~first], part[first]]
    return tuple(bodies)


def _two_bodies(shown: Array) -> BoolArray | None:
    """(M,) the points of the first of two bodies, or None where the points are one."""
    if shown.shape[1] < 2 * FEWEST_POINTS:
        return None
    apart = np.linalg.norm(shown[:, :, None] - shown[:, None], axis=-1)
    low, middle, high = known_percentiles(apart, (5.0, 50.0, 95.0))
    weight = np.nan_to_num(np.exp(-(middle**2 + (SPREAD * (high - low)) ** 2) / LINK_M**2))
    np.fill_diagonal(weight, 0.0)
    cuts = [cut for cut in _cuts(weight) if cut.value <= _most_cut(_across_m(shown, cut.first))]
    return min(cuts, key=lambda cut: cut.value).first if cuts else None


def _cuts(weight: Array) -> Iterator[_Cut]:
    """The least cut along each of the first eigenvectors of the normalised Laplacian."""
    total = weight.sum(axis=1) + 1e-9
    laplacian = np.eye(len(weight)) - weight / np.sqrt(total[:, None] * total)
    _, vectors = np.linalg.eigh(laplacian)
    for vector in vectors[:, 1 : 1 + VECTORS].T:
        order = np.argsort(vector / np.sqrt(total), kind="stable")
        within, volume = weight[np.ix_(order, order)], total[order].cumsum()
        inner = np.array([within[:c, :c].sum() for c in range(len(order) + 1)])
        sizes = np.arange(FEWEST_POINTS, len(order) - FEWEST_POINTS + 1)
        cut = volume[sizes - 1] - inner[sizes]
        value = cut / volume[sizes - 1] + cut / (volume[-1] - volume[sizes - 1])
        best = int(value.argmin())
        first = np.zeros(len(order), dtype=bool)
        first[order[: sizes[best]]] = True
        yield _Cut(float(value[best]), first)


def _most_cut(across_m: float) -> float:
    """Greatest cut between bodies of which the smaller extends so far across the line between them."""
    if across_m >= TALL_M:
        return MOST_CUT_TALL
    return MOST_CUT if across_m >= ACROSS_M else -1.0


def _across_m(shown: Array, first: BoolArray) -> float:
    """Smaller extent of two parts across the line between their middles; 0 where these are too near.

    Frames with points of both count; where these are few, one part may be the other under new names.
    """
    seen = ~np.isnan(shown[:, :, 0])
    both = seen[:, first].any(axis=1) & seen[:, ~first].any(axis=1)
    if both.mean() < LEAST_SEEN:
        return 0.0
    parts = shown[both][:, first], shown[both][:, ~first]
    middles = [np.nanmedian(part, axis=1) for part in parts]
    between = middles[1] - middles[0]
    far = np.linalg.norm(between, axis=1)
    if not np.median(far) >= APART_M:
        return 0.0
    along = between / np.maximum(far, 1e-9)[:, None]
    extents = []
    for part in parts:
        across = part - (part @ along[:, :, None]) * along[:, None]
        sides = np.nanmax(across, axis=1) - np.nanmin(across, axis=1)
        extents.append(float(np.median(np.linalg.norm(sides, axis=1))))
    return min(extents)


def nearest_body(positions_m: Array, column: int, parts: Sequence[Indices]) -> int:
    """Number of the body whose points are nearest to those of another column, in the frames in which it is seen.

    Args:
        positions_m: (T, M, 3) all points; NaN where not seen.
        column: The column.
        parts: Columns of each body.
    """
    own = positions_m[:, column]
    times = np.flatnonzero(~np.isnan(own[:, 0]))
    times = times[spread_indices(len(times), FRAMES)]
    if not len(times):
        return 0
    apart = [np.linalg.norm(positions_m[np.ix_(times, part)] - own[times, None], axis=2) for part in parts]
    nearest = [float(np.median(np.where(np.isnan(one), np.inf, one).min(axis=1))) for one in apart]
    return int(np.argmin(nearest))
