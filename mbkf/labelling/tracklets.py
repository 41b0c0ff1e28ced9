"""Points linked over time without names: the same reflection in successive frames, by place and velocity alone.

Columns of the file do not count. Two points are linked where one lies near the other's place at steady velocity, and no
other point is half as near; where this is ambiguous the tracklet ends and a new one begins.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.distance import cdist

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices

STEADY_M = 0.025
"""Greatest distance of a point from its place at steady velocity."""

NEW_M = 0.040
"""The same where its velocity is unknown and that of its neighbour is used."""

SURE = 0.5
"""Greatest length of a link as a share of any other link to the same points."""


@dataclass(frozen=True)
class Tracklets:
    """Points linked over time.

    Attributes:
        number: (T, C) tracklet of every point, ``HIDDEN`` where a column is empty.
        count: Number n of tracklets; each spans successive frames.
    """

    number: Indices
    count: int

    @cached_property
    def pieces(self) -> tuple[tuple[Indices, Indices], ...]:
        """Frames and columns of every tracklet's points, in order."""
        if not self.count:
            return ()
        frames, columns = np.nonzero(self.number != HIDDEN)
        own = self.number[frames, columns]
        order = np.argsort(own, kind="stable")
        cuts = np.searchsorted(own[order], np.arange(1, self.count))
        return tuple(zip(np.split(frames[order], cuts), np.split(columns[order], cuts), strict=True))

    @cached_property
    def spans(self) -> Indices:
        """(n, 2) first frame of every tracklet, and the frame after its last."""
        return np.array([(f[0], f[-1] + 1) for f, _ in self.pieces], dtype=np.intp).reshape(-1, 2)

    def points(self, label: Indices) -> Indices:
        """(T, C) label of every point, from those of the tracklets (n,)."""
        if not self.count:
            return np.full(self.number.shape, HIDDEN, dtype=np.intp)
        return np.where(self.number == HIDDEN, HIDDEN, label[self.number])


def link_points(positions_m: Array) -> Tracklets:
    """Links the points (T, C, 3), NaN where a column is empty; their columns may be shuffled in every frame.

    Velocities are found forwards and, for points without one, backwards.
    """
    frames = [_shown(frame) for frame in positions_m]
    ahead = _links(frames)
    back = _links(frames[::-1])[::-1]
    number = np.full(positions_m.shape[:2], HIDDEN, dtype=np.intp)
    count, before = 0, np.zeros(0, dtype=np.intp)
    for t, (columns, _) in enumerate(frames):
        own = np.full(len(columns), HIDDEN, dtype=np.intp)
        if t:
            earlier, later = _agreed(ahead[t - 1], back[t - 1][::-1], len(before), len(columns))
            own[later] = before[earlier]
        fresh = own == HIDDEN
        new = int(np.count_nonzero(fresh))
        own[fresh] = count + np.arange(new)
        count += new
        number[t, columns] = before = own
    return Tracklets(number, count)


def _shown(frame_m: Array) -> tuple[Indices, Array]:
    """Columns (N,) that are not empty, and their points (N, 3)."""
    columns = np.flatnonzero(~np.isnan(frame_m).any(axis=1))
    return columns, frame_m[columns]


def _agreed(one: Indices, other: Indices, before: int, now: int) -> tuple[Indices, Indices]:
    """The first set of links (2, k), and those of the second set whose points are still free."""
    taken_before, taken_now = np.zeros(before, dtype=bool), np.zeros(now, dtype=bool)
    taken_before[one[0]], taken_now[one[1]] = True, True
    free = ~taken_before[other[0]] & ~taken_now[other[1]]
    return np.concatenate([one[0], other[0][free]]), np.concatenate([one[1], other[1][free]])


def _links(frames: list[tuple[Indices, Array]]) -> list[Indices]:
    """For every frame but the last: points (2, k) of it and of the next one that are linked."""
    links = []
    points = frames[0][1] if frames else np.zeros((0, 3))
    steps, moving = np.zeros_like(points), np.zeros(len(points), dtype=bool)
    for _, now in frames[1:]:
        rows, columns = _pairs(points, _borrowed_steps(points, steps, moving), moving, now)
        fresh, known = np.zeros_like(now), np.zeros(len(now), dtype=bool)
        fresh[columns], known[columns] = now[columns] - points[rows], True
        links.append(np.array([rows, columns]))
        points, steps, moving = now, fresh, known
    return links


def _pairs(points_m: Array, steps_m: Array, moving: BoolArray, now_m: Array) -> tuple[Indices, Indices]:
    """Points of a frame (N, 3) and the next (N', 3) that are unambiguously the same."""
    from scipy.optimize import linear_sum_assignment  # loads slowly

    if not len(points_m) or not len(now_m):
        nothing = np.zeros(0, dtype=np.intp)
        return nothing, nothing
    distance = cdist(points_m + steps_m, now_m)
    rows, columns = linear_sum_assignment(distance)
    chosen = distance[rows, columns]
    distance[rows, columns] = np.inf
    other = np.minimum(distance[rows].min(axis=1), distance[:, columns].min(axis=0))
    sure = (chosen < np.where(moving[rows], STEADY_M, NEW_M)) & (chosen < SURE * other)
    return rows[sure], columns[sure]


def _borrowed_steps(points_m: Array, steps_m: Array, moving: BoolArray) -> Array:
    """(N, 3) steps; a point seen for the first time moves like its nearest neighbour."""
    if moving.all() or not moving.any():
        return steps_m
    steps = steps_m.copy()
    nearest = cdist(points_m[~moving], points_m[moving]).argmin(axis=1)
    steps[~moving] = steps_m[moving][nearest]
    return steps
