"""Orientation of sensors on their segments: from standing, and from movements in which the legs swing fore and aft."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.frames import conjugate, multiply, rotate

LEAST_SWING_RAD_S = 0.5
"""Legs that turn less than this (root mean square) do not show where forward is."""


def facing(
    segments: Sequence[str],
    orientation: Array,
    gyro: Array,
    standing: Array,
    knees: Sequence[tuple[str, str]],
) -> float | None:
    """Heading of forward while standing, rad about the vertical from the world's x axis; None: legs hardly swing.

    Thighs and shanks swing about the side-to-side axis, the first principal axis of their angular velocities
    seen from above; of its two senses it is the left one about which shanks have turned against thighs, for knees bend
    one way only. How the first segment, usually the pelvis, has turned since standing is taken off, so that people may
    walk about, and stand in another direction than they walk.

    Args:
        segments: S names, one whose turning about the vertical is the person's first.
        orientation: (T, S, 4) sensor → one world, z up, with one common heading.
        gyro: (T, S, 3) rad/s in sensor axes.
        standing: (S, 4) sensor → world while standing.
        knees: Thigh and shank of each leg (:class:`~mbkf.model.description.Roles`).
    """
    swinging = {name for pair in knees for name in pair}
    legs = [k for k, name in enumerate(segments) if name in swinging]
    orientation = heading_from_standing(orientation, standing[0])
    left = swing_axis(orientation[:, legs], gyro[:, legs]) if legs else None
    if left is None:
        return None
    bend = 0.0
    for pair in knees:
        if set(pair) <= set(segments):
            thigh, shank = (segments.index(name) for name in pair)
            bend += turn_about(orientation[:, shank], standing[shank], left)
            bend -= turn_about(orientation[:, thigh], standing[thigh], left)
    if bend < 0.0:
        left = -left
    return float(np.arctan2(-left[0], left[1]))


def heading_from_standing(orientation: Array, standing: Array) -> Array:
    """(T, S, 4) orientations, less how the pelvis, the first segment, has turned about the vertical since standing.

    Args:
        orientation: (T, S, 4) sensor → world, z up.
        standing: (4,) the pelvis's sensor while standing.
    """
    since = multiply(orientation[:, 0], conjugate(standing))
    twist = 2.0 * np.arctan2(since[:, 2], since[:, 3])
    back = np.stack([0.0 * twist, 0.0 * twist, -np.sin(0.5 * twist), np.cos(0.5 * twist)], axis=-1)
    return multiply(back[:, None], orientation)


def swing_axis(orientation: Array, gyro: Array) -> Array | None:
    """(2,) level axis about which segments swing, of either sense; None: they hardly swing.

    Args:
        orientation: (T, S, 4) sensor → world, z up.
        gyro: (T, S, 3) rad/s in sensor axes.
    """
    world = np.nan_to_num(rotate(orientation, gyro))[..., :2].reshape(-1, 2)
    values, vectors = np.linalg.eigh(world.T @ world / len(world))
    if values[1] < LEAST_SWING_RAD_S**2 or values[1] < 2.0 * values[0]:
        return None
    return np.asarray(vectors[:, 1])


def turn_about(orientation: Array, standing: Array, axis: Array) -> float:
    """Mean turn, rad, since standing about a level axis.

    Args:
        orientation: (T, 4) sensor → world, z up.
        standing: (4,) the same while standing.
        axis: (2,) the axis.
    """
    since = multiply(orientation, conjugate(standing))
    since = np.where(since[:, 3:] < 0.0, -since, since)
    angle = 2.0 * np.arctan2(since[:, :2] @ axis, since[:, 3])
    return float(np.nanmean(angle))


def alignments(standing: Array, posture: Array, heading_rad: float) -> Array:
    """(S, 4) sensor → segment.

    Args:
        standing: (S, 4) sensor → world while standing.
        posture: (S, 4) segment → world of the same posture when facing the world's x axis.
        heading_rad: Where the person faced.
    """
    turn = np.array([0.0, 0.0, np.sin(0.5 * heading_rad), np.cos(0.5 * heading_rad)])
    return multiply(conjugate(multiply(turn, posture)), standing)


def mean_orientation(orientation: Array) -> Array:
    """(S, 4) mean of orientations (T, S, 4): the largest eigenvector of Σ q qᵀ (Markley et al. 2007).

    Raises:
        InvalidInput: A sensor has no sample.
    """
    there = np.all(np.isfinite(orientation), axis=-1)
    if not there.any(axis=0).all():
        raise InvalidInput("a sensor has no reading while standing; choose another time with --standing")
    q = np.where(there[..., None], orientation, 0.0)
    _, vectors = np.linalg.eigh(np.einsum("tsi,tsj->sij", q, q))
    mean = vectors[:, :, -1]
    return np.where(mean[:, 3:] < 0.0, -mean, mean)
