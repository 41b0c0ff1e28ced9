"""Paths of one or two feet in one frame: x along the first stride, z up, the origin where the feet first stand.

Every foot's filter starts with a heading and a place of its own. Since both feet go the same way at the same time, the
rotation about the vertical that brings their paths closest together makes one heading of two; how far apart the feet
are side by side, no foot's sensor knows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import multiply


@dataclass(frozen=True)
class Placement:
    """A rotation about the vertical by ``heading_rad``, then a shift by ``offset_m`` (3,)."""

    heading_rad: float
    offset_m: Array

    def of_points(self, points_m: Array) -> Array:
        """(T, 3) points in the new frame."""
        return self.of_vectors(points_m) + self.offset_m

    def of_vectors(self, vectors: Array) -> Array:
        """(T, 3) velocities and the like in the new frame."""
        return vectors @ _about_vertical(self.heading_rad).T

    def of_orientations(self, orientations: Array) -> Array:
        """(T, 4) sensor → world in the new frame."""
        half = 0.5 * self.heading_rad
        return multiply(np.array([0.0, 0.0, np.sin(half), np.cos(half)]), orientations)


def placements(
    times_s: Sequence[Array], paths_m: Sequence[Array], first_ways_m: Sequence[Array]
) -> list[Placement]:
    """Motion that brings the paths of one or several feet into one frame.

    Args:
        times_s: Per foot (T,) times on one clock.
        paths_m: Per foot (T, 3) positions, NaN where unknown.
        first_ways_m: Per foot (3,) displacement of its first stride, zero without strides.
    """
    headings = [0.0]
    offsets = [-_first_known(paths_m[0])]
    for t, path in zip(times_s[1:], paths_m[1:], strict=True):
        heading, offset = _closest(times_s[0], paths_m[0] + offsets[0], t, path)
        offset[2] = -_first_known(path)[2]
        headings.append(heading)
        offsets.append(offset)
    way = sum(
        (_about_vertical(heading) @ first for heading, first in zip(headings, first_ways_m, strict=True)),
        np.zeros(3),
    )
    turn = -float(np.arctan2(way[1], way[0]))
    back = _about_vertical(turn)
    return [
        Placement(heading + turn, back @ offset) for heading, offset in zip(headings, offsets, strict=True)
    ]


def _closest(t_one: Array, one: Array, t_two: Array, two: Array) -> tuple[float, Array]:
    """Heading and offset (3,) that bring the second path closest to the first, horizontally, over their common time."""
    known = np.isfinite(one).all(axis=1)
    own = np.isfinite(two).all(axis=1)
    begin, end = max(t_one[known][0], t_two[own][0]), min(t_one[known][-1], t_two[own][-1])
    shared = own & (t_two >= begin) & (t_two <= end)
    if not shared.any():
        return 0.0, _first_known(one) - _first_known(two)
    a = np.stack([np.interp(t_two[shared], t_one[known], one[known, k]) for k in (0, 1)], axis=1)
    b = two[shared, :2]
    da, db = a - a.mean(axis=0), b - b.mean(axis=0)
    cross = float((db[:, 0] * da[:, 1] - db[:, 1] * da[:, 0]).sum())
    heading = float(np.arctan2(cross, float((da * db).sum())))
    offset = np.zeros(3)
    offset[:2] = a.mean(axis=0) - (_about_vertical(heading)[:2, :2] @ b.mean(axis=0))
    return heading, offset


def _first_known(path_m: Array) -> Array:
    return np.array(path_m[int(np.isfinite(path_m).all(axis=1).argmax())])


def _about_vertical(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
