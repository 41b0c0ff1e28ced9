"""Tracks of physical points: from frame to frame, and through the gaps of a whole capture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices, squared_distances
from mbkf.labelling.tracklets import SURE, link_points
from mbkf.numerics.runs import spread_indices

GAP_S, GAP_M = 0.25, 0.030
"""Greatest gap in time, and greatest distance from the way it was heading, over which a tracklet is continued."""

COLUMN_GAP_S, COLUMN_GAP_M = 1.0, 0.10
"""The same for a tracklet that begins in the same column, where columns are tracks."""

COLUMNS_ARE_TRACKS = 0.9
"""Least share of continuing points (:func:`continuing_columns`) with which columns are tracks."""

HEADING = 4
"""Frames at a tracklet's end from which its velocity is taken."""

LOOKS = 50
"""Frames by which columns are judged."""


@dataclass(frozen=True)
class Tracks:
    """Points linked through a capture, gaps included.

    Attributes:
        number: (T, C) track of the point in every column, ``HIDDEN`` where the column is empty.
        count: Number of tracks.
    """

    number: Indices
    count: int

    def positions(self, points_m: Array, frames: Indices) -> Array:
        """(F, count, 3) the tracks in some frames (F,) of a capture (T, C, 3), NaN where not seen."""
        found = np.full((len(frames), self.count, 3), np.nan)
        rows, columns = np.nonzero(self.number[frames] != HIDDEN)
        at = frames[rows]
        found[rows, self.number[at, columns]] = points_m[at, columns]
        return found

    def visible(self) -> BoolArray:
        """(count, T) True where a track is seen."""
        seen = np.zeros((self.count, len(self.number)), dtype=bool)
        frames, columns = np.nonzero(self.number != HIDDEN)
        seen[self.number[frames, columns], frames] = True
        return seen


def continuing_columns(before_m: Array, now_m: Array) -> BoolArray:
    """(C,) True for columns that hold the same physical point as in the frame before.

    A column continues where its point lies nearer to its own place before than to any other point's, and vice versa.
    Points shuffled in every frame fail this test.

    Args:
        before_m: (C, 3) the frame before, NaN where a column is empty.
        now_m: (C, 3) this frame.
    """
    there = np.asarray(~np.isnan(before_m).any(axis=1))
    here = np.asarray(~np.isnan(now_m).any(axis=1))
    same = np.asarray(there & here)
    if same.any():
        squared = squared_distances(now_m[here], before_m[there])
        rows, columns = (np.cumsum(here) - 1)[same], (np.cumsum(there) - 1)[same]
        own = squared[rows, columns]
        same[same] = (own <= squared[rows].min(axis=1)) & (own <= squared[:, columns].min(axis=0))
    return same


def link_tracks(points_m: Array, rate_hz: float) -> Tracks:
    """Tracks through a capture whose columns may be tracks or may be shuffled in every frame.

    Tracklets are joined over short gaps along the way they were heading, and over longer ones within a column, where
    no other tracklet is half as near.

    Args:
        points_m: (T, C, 3) points, NaN where a column is empty.
        rate_hz: Frames per second.
    """
    pieces = link_points(points_m)
    ends = [_end(points_m, frames, columns, rate_hz) for frames, columns in pieces.pieces]
    columned = columns_are_tracks(points_m)
    wait = round((COLUMN_GAP_S if columned else GAP_S) * rate_hz) + 1
    track = np.full(pieces.count, HIDDEN, dtype=np.intp)
    loose: list[int] = []
    count = 0
    firsts = pieces.spans[:, 0]
    for t in np.unique(firsts):
        new = np.flatnonzero(firsts == t)
        begun = [int(columns[0]) for _, columns in (pieces.pieces[k] for k in new)]
        known = track != HIDDEN
        ended = np.flatnonzero(known & (pieces.spans[:, 1] <= t) & (pieces.spans[:, 1] > t - wait))
        before = [int(k) for k in ended if int(k) not in loose]
        cost = _joining(
            [ends[k] for k in before], points_m[t, begun], begun if columned else None, int(t), rate_hz
        )
        for row, one in enumerate(_sure(cost)):
            if one == HIDDEN:
                track[new[row]] = count
                count += 1
            else:
                track[new[row]] = track[before[one]]
                loose.append(before[one])
    number = np.where(pieces.number == HIDDEN, HIDDEN, track[pieces.number]) if count else pieces.number
    return Tracks(number, count)


def columns_are_tracks(points_m: Array, columns: Indices | slice = slice(None), looks: int = LOOKS) -> bool:
    """True where columns hold the same physical points from frame to frame.

    Args:
        points_m: (T, C, 3) points of the capture.
        columns: The columns judged.
        looks: Number of frames by which they are judged.
    """
    same = stay = 0
    for t in spread_indices(len(points_m), looks, first=1):
        both = ~np.isnan(points_m[t - 1 : t + 1, columns]).any(axis=(0, 2))
        stay += int(both.sum())
        same += int(continuing_columns(points_m[t - 1], points_m[t])[columns][both].sum())
    return same >= COLUMNS_ARE_TRACKS * stay


@dataclass(frozen=True)
class _End:
    """End of a tracklet: frame, column, place (3,) and velocity (3,)."""

    frame: int
    column: int
    place_m: Array
    velocity_m_s: Array


def _end(points_m: Array, frames: Indices, columns: Indices, rate_hz: float) -> _End:
    last = points_m[frames[-HEADING:], columns[-HEADING:]]
    velocity = (last[-1] - last[0]) * rate_hz / max(1, len(last) - 1)
    return _End(int(frames[-1]), int(columns[-1]), last[-1], velocity)


def _joining(ends: list[_End], points_m: Array, columns: list[int] | None, t: int, rate_hz: float) -> Array:
    """(n, m) distances of points (n, 3) of frame t from the ways of m tracklets; infinite where too far."""
    cost = np.full((len(points_m), len(ends)), np.inf)
    for j, end in enumerate(ends):
        gap = (t - end.frame) / rate_hz
        away, way = points_m - end.place_m, end.velocity_m_s * gap
        share = np.clip(away @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
        distance = np.linalg.norm(away - share[:, None] * way, axis=1)
        limit = np.full(len(points_m), GAP_M if gap <= GAP_S + 1.0 / rate_hz else 0.0)
        if columns is not None:
            own = np.array(columns) == end.column
            distance[own] *= GAP_M / COLUMN_GAP_M
            limit[own] = GAP_M
        cost[:, j] = np.where(distance <= limit, distance, np.inf)
    return cost


def _sure(cost: Array) -> Indices:
    """(n,) the column of each row in the cheapest pairing, ``HIDDEN`` without one or where another is also near."""
    from scipy.optimize import linear_sum_assignment  # loads slowly

    found = np.full(len(cost), HIDDEN, dtype=np.intp)
    if not cost.size:
        return found
    rows, columns = linear_sum_assignment(np.where(np.isfinite(cost), cost, 1.0))
    for row, column in zip(rows, columns, strict=True):
        own = cost[row, column]
        others = min(
            np.delete(cost[row], column).min(initial=np.inf),
            np.delete(cost[:, column], row).min(initial=np.inf),
        )
        if np.isfinite(own) and own < SURE * others:
            found[row] = column
    return found
