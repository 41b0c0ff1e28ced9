"""What laboratories do about a marker's gaps before the kinematic filter: a cubic spline, or rigid-body filling.

The spline runs in each coordinate through all samples of the marker alone. Rigid-body filling carries the marker with
three or more others, from where it was at the gap's edges; it falls back on the spline where there are fewer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from mbkf.conventions import Array, BoolArray
from mbkf.io.subject import Subject
from mbkf.model.human import reference_body
from mbkf.numerics.rotations import nearest_rotations

CARRIERS = 3
"""Markers that carry a lost one, at least; from its segment, then the nearest ones of the segments jointed to it."""

FLAT_M = 0.01
"""Carriers whose spread off a line is smaller than this do not fix a rotation."""


@dataclass(frozen=True)
class Gap:
    """Frames [first, end) in which a marker is not seen."""

    marker: int
    first: int
    end: int


def gaps(seen: BoolArray) -> Iterator[Gap]:
    """The gaps of all markers, among them those at the trial's ends.

    Args:
        seen: (T, M) samples that are there.
    """
    frames, markers = seen.shape
    for marker in range(markers):
        edges = np.diff(np.r_[0, ~seen[:, marker], 0].astype(int))
        for first, end in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
            if end - first < frames:
                yield Gap(marker, int(first), int(end))


def spline_filled(positions_m: Array) -> Array:
    """(T, M, 3) markers with their gaps bridged by cubic splines; gaps at the trial's ends have one edge and stay.

    Args:
        positions_m: (T, M, 3) samples, NaN where there is none.
    """
    found = positions_m.copy()
    frames = np.arange(len(positions_m))
    seen = np.asarray(~np.isnan(positions_m).any(axis=2))
    for marker in range(positions_m.shape[1]):
        known = np.flatnonzero(seen[:, marker])
        if len(known) < 2:
            continue
        curve = CubicSpline(known, positions_m[known, marker])
        inside = ~seen[:, marker] & (frames > known[0]) & (frames < known[-1])
        found[inside, marker] = curve(frames[inside])
    return found


def rigid_filled(
    positions_m: Array,
    segments: Sequence[str],
    subject: Subject,
    *,
    neighbours: bool = True,
    past_only: bool = False,
) -> Array:
    """(T, M, 3) markers with their gaps filled from others that move with them.

    At every frame of a gap the lost marker's carriers are the seen markers of its segment; where these are fewer than
    three, the nearest ones of the parent and child segments join them. The rigid movement that fits them best, from
    the frame at each edge of the gap to this one, carries the marker along. Both answers are weighted linearly in
    time, so that the path meets the measured marker at both edges. A gap at the trial's end has one edge and one
    answer. A frame without three carriers is filled by the spline, if that can be.

    Args:
        positions_m: (T, M, 3) samples, NaN where there is none.
        segments: Segments of the markers.
        subject: The person, for which segments are jointed.
        neighbours: Whether markers of the segments jointed to the marker's own may carry it.
        past_only: Whether only the edge before a gap is known, as while a capture runs; there is no spline then.
    """
    found = positions_m.copy() if past_only else spline_filled(positions_m)
    seen = np.asarray(~np.isnan(positions_m).any(axis=2))
    near = _near(segments, subject)
    farthest = 1 if neighbours else 0
    for gap in gaps(seen):
        before, after = gap.first - 1, gap.end
        edges = [edge for edge in (before, after)[: 1 if past_only else 2] if 0 <= edge < len(seen)]
        for frame in range(gap.first, gap.end) if edges else ():
            among = seen[frame] & (near[gap.marker] <= farthest)
            carried = [
                _carried(positions_m, among & seen[edge], near[gap.marker], gap.marker, edge, frame)
                for edge in edges
            ]
            if any(np.isnan(one).any() for one in carried):
                continue
            share = (frame - before) / (after - before) if len(edges) == 2 else 0.0
            found[frame, gap.marker] = (1.0 - share) * carried[0] + share * carried[-1]
    return found


def _near(segments: Sequence[str], subject: Subject) -> NDArray[np.int64]:
    """(M, M) 0 for two markers of a segment, 1 for those of segments with a joint between them, else 2."""
    parent = {one.name: one.parent for one in reference_body(subject).segments}
    joined = [
        [0 if a == b else 1 if b == parent[a] or a == parent[b] else 2 for b in segments] for a in segments
    ]
    return np.array(joined)


def _carried(
    positions_m: Array, among: BoolArray, near: NDArray[np.int64], marker: int, edge: int, frame: int
) -> Array:
    """(3,) where a marker's carriers take it from the edge's frame to another one, NaN where they are too few.

    Args:
        positions_m: (T, M, 3) samples.
        among: (M,) markers that may carry it, seen in both frames.
        near: (M,) 0 for markers of its segment, 1 for those of the segments jointed to it.
        marker: The lost marker.
        edge: A frame in which it is seen.
        frame: The frame wanted.
    """
    carriers = np.flatnonzero(among & (near == 0))
    if len(carriers) < CARRIERS:
        others = np.flatnonzero(among & (near == 1))
        distance = np.linalg.norm(positions_m[edge, others] - positions_m[edge, marker], axis=1)
        carriers = np.r_[carriers, others[np.argsort(distance)][: CARRIERS - len(carriers)]]
    if len(carriers) < CARRIERS:
        return np.full(3, np.nan)
    return moved_with(positions_m[edge, carriers], positions_m[frame, carriers], positions_m[edge, marker])


def moved_with(before_m: Array, now_m: Array, point_m: Array) -> Array:
    """(3,) a point after the rigid movement that takes some points nearest to where they are now (least squares).

    Args:
        before_m: (n, 3) the points before.
        now_m: (n, 3) the same points now.
        point_m: (3,) the point before.

    Returns:
        The point now; NaN where the points lie on a line and leave the rotation open.
    """
    middle, moved = before_m.mean(axis=0), now_m.mean(axis=0)
    if np.linalg.svd(before_m - middle, compute_uv=False)[1] < FLAT_M:
        return np.full(3, np.nan)
    (rotation,) = nearest_rotations(((now_m - moved).T @ (before_m - middle))[None])
    return np.asarray(moved + rotation @ (point_m - middle))
