"""Loads that a motion needs, given to the feet: sharing in double support, and flight without loads.

Wrenches are about the ground's origin, in OpenSim's axes (y up): force, then moment.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array, BoolArray

LEAST_FORCE_N = 20.0
"""Vertical force below which a foot has no centre of pressure, and nothing is given to it."""

REACH_M = np.array([0.07, 0.0, 0.035])
"""Greatest distance of the centre of pressure from the place of its foot."""

FARTHEST_M = 0.3
"""Beyond this a centre of pressure is that of a hardly loaded foot."""

SMOOTHNESS, SIZE = 1e-5, 10.0
"""Weights of the third derivative (s²) and of the size (s⁻⁴) beside that of a wrong acceleration in flight."""


def shares(contacts: BoolArray) -> Array:
    """(T, 2) shares of the load by foot: 1 in single support, from 1 to 0 as a smooth step in double support.

    Before the first single support and after the last one the feet share alike. In flight both shares are 0.

    Args:
        contacts: (T, 2) feet on the ground.
    """
    alone = np.where(
        contacts[:, 0] & ~contacts[:, 1], 1.0, np.where(contacts[:, 1] & ~contacts[:, 0], 0.0, np.nan)
    )
    both = contacts.all(axis=1)
    right = np.where(both, np.nan, alone)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], both.astype(int), [0]])))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        before = right[start - 1] if start > 0 else 0.5
        after = right[stop] if stop < len(right) else 0.5
        before, after = (0.5 if np.isnan(side) else side for side in (before, after))
        x = (np.arange(start, stop) - start + 1.0) / (stop - start + 1.0)
        right[start:stop] = before + (after - before) * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    known = np.where(np.isnan(right), 0.0, right)
    return np.column_stack([known, np.where(np.isnan(right), 0.0, 1.0 - known)])


def projected_shares(total: Array, points: Array) -> Array:
    """(T, 2) shares of feet that stand all the time, by where the centre of pressure lies between them.

    Args:
        total: (T, 6) wrench that the motion needs.
        points: (T, 2, 3) where each foot stands.
    """
    middle = points.mean(axis=1)
    x, z = pressure(total, middle[:, 1])
    line = points[:, 0] - points[:, 1]
    away = (x - points[:, 1, 0]) * line[:, 0] + (z - points[:, 1, 2]) * line[:, 2]
    share = np.nan_to_num(away / (line[:, 0] ** 2 + line[:, 2] ** 2), nan=0.5)  # hardly loaded
    right = np.clip(share, 0.02, 0.98)
    return np.column_stack([right, 1.0 - right])


def pressure(wrench: Array, height_m: Array) -> tuple[Array, Array]:
    """(T,) x and z of the centre of pressure at a height; NaN where hardly loaded.

    Args:
        wrench: (T, 6) wrench.
        height_m: (T,) height of the plane.
    """
    vertical = np.where(wrench[:, 1] > LEAST_FORCE_N, wrench[:, 1], np.nan)
    x = (wrench[:, 5] + height_m * wrench[:, 0]) / vertical
    z = (height_m * wrench[:, 2] - wrench[:, 3]) / vertical
    return x, z


def feet_wrenches(total: Array, share: Array, points: Array) -> Array:
    """(T, 2, 6) wrenches of the feet, whose sum is the total.

    Each foot bears its share of the force. Its centre of pressure is where it stands, moved by the same way for both
    feet, so that the moments about the horizontal axes add up; the rest of the moment, about the vertical except where
    hardly loaded, is shared, too.

    Args:
        total: (T, 6) wrench that the motion needs.
        share: (T, 2) shares.
        points: (T, 2, 3) where each foot stands.
    """
    height = (share * points[:, :, 1]).sum(axis=1)
    x, z = pressure(total, height)
    middle = (share[:, :, None] * points).sum(axis=1)
    moved = np.nan_to_num(np.column_stack([x - middle[:, 0], np.zeros(len(x)), z - middle[:, 2]]))
    force = share[:, :, None] * total[:, None, :3]
    moment = np.cross(points + moved[:, None], force)
    rest = total[:, 3:] - moment.sum(axis=1)
    return np.concatenate([force, moment + share[:, :, None] * rest[:, None]], axis=2)


def beyond_feet(total: Array, share: Array, points: Array) -> Array:
    """(T, 3) moment of a load whose centre of pressure lies farther from where the feet stand than :data:`REACH_M`.

    Args:
        total: (T, 6) wrench that the motion needs.
        share: (T, 2) shares of the feet.
        points: (T, 2, 3) where each foot stands.
    """
    middle = (share[:, :, None] * points).sum(axis=1)
    x, z = pressure(total, middle[:, 1])
    away = np.clip(np.nan_to_num(np.column_stack([x, middle[:, 1], z]) - middle), -FARTHEST_M, FARTHEST_M)
    return np.asarray(np.cross(away - np.clip(away, -REACH_M, REACH_M), total[:, :3]))


def motion_correction(wrong: Array, weight: Array, dt_s: float) -> Array:
    """(T, 3) smooth and small displacement whose second derivative is minus the wrong acceleration.

    Least squares of the acceleration's error, of the third derivative, and of the size.

    Args:
        wrong: (T, 3) acceleration that no load explains.
        weight: (T,) weights of the frames.
        dt_s: Time between frames.
    """
    count = len(wrong)
    second = np.diff(np.eye(count), n=2, axis=0) / dt_s**2
    third = np.diff(np.eye(count), n=3, axis=0) / dt_s**3
    weighed = second.T * weight[1:-1]
    normal = weighed @ second + SMOOTHNESS * third.T @ third + SIZE * np.eye(count)
    return np.asarray(np.linalg.solve(normal, -weighed @ wrong[1:-1]))


def distal(side: str) -> Sequence[str]:
    """The bodies below a knee.

    Args:
        side: "r" or "l".
    """
    return [f"{body}_{side}" for body in ("tibia", "talus", "calcn", "toes")]
