"""Soles of the body: heel, ball and toe end of each foot, and distances of the floor's points from them."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, nan

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.motion_frames import motion_frames
from mbkf.model.soles import sole_locals

Sole = Sequence[Sequence[float]]
"""World positions of heel, ball and toe end of one sole, m."""


def sole_points(model: Body, q: Array) -> Array:
    """(T, 2, 3, 3) world positions of heel, ball and toe end of right and left sole; NaN where q (T, nq) is NaN."""
    segments, local_m = sole_locals(model)
    feet = motion_frames(model, q)[0][:, [model.joint(segment).joint_id for segment in segments]]
    points = np.einsum("tkij,ki->tkj", feet, np.insert(local_m, 3, 1.0, axis=1))
    return np.asarray(points.reshape(len(q), 2, 3, 3))


def share_along(x: float, y: float, sole: Sole) -> float:
    """Share of a sole's length at which a point of the floor lies, seen from above: 0 at the heel, 1 at the toe end.

    NaN for a sole without length: that of a lost body, so far away that floating point no longer resolves it.

    Args:
        x: World coordinate of the point, m.
        y: Its other coordinate.
        sole: The sole.
    """
    (hx, hy, _), (tx, ty, _) = sole[0], sole[2]
    ax, ay = tx - hx, ty - hy
    length = ax * ax + ay * ay
    return ((x - hx) * ax + (y - hy) * ay) / length if length else nan


def distance_to_sole(x: float, y: float, sole: Sole) -> float:
    """Horizontal distance of a point of the floor from the line between heel and toe end, m; NaN without length.

    Args:
        x: World coordinate of the point, m.
        y: Its other coordinate.
        sole: The sole.
    """
    along = min(max(share_along(x, y, sole), 0.0), 1.0)
    (hx, hy, _), (tx, ty, _) = sole[0], sole[2]
    return hypot(x - hx - along * (tx - hx), y - hy - along * (ty - hy))


def distances_to_soles(points_m: Array, soles: Array) -> Array:
    """(T, 2) :func:`distance_to_sole` of points (T, 3) from soles (T, 2, 3, 3); NaN where not known."""
    heels = soles[:, :, 0, :2]
    lengths, from_heels = soles[:, :, 2, :2] - heels, points_m[:, None, :2] - heels
    with np.errstate(invalid="ignore"):  # soles without length
        along = (from_heels * lengths).sum(axis=2) / (lengths**2).sum(axis=2)
    apart = from_heels - np.clip(along, 0.0, 1.0)[:, :, None] * lengths
    return np.asarray(np.hypot(apart[:, :, 0], apart[:, :, 1]))
