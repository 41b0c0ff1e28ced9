"""Starts of a limb's fit: poses it may have by its markers, by people's posture, or turned over, and other names.

A segment turned by 180° about its long axis, with the next one turned back, carries all that follows where it was: few
markers tell both poses apart, and a fit that begins in one of them does not find the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body, SegmentJoint
from mbkf.model.limbs import Limb
from mbkf.model.sides import mirrored
from mbkf.numerics.rotations import nearest_rotations
from mbkf.sensors.limb_fit import LimbFits
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import joint_by_joint

Order = NDArray[np.intp]
"""(M,) place in the capture of each marker that the filter reads."""

MOST_PERMUTED, KEPT_ORDERS = 9, 3
"""Most markers of a segment whose names are permuted, and number of its likeliest orders that are fitted."""

LOOSE = 1.5
"""A permuted segment may fit its markers worse than the names as they are by this, in squares ..."""

RIGID_M = 0.015
"""... or its markers may err by this."""

MIRROR_M = 0.06
"""Markers of both sides correspond where their places on the segments mirror each other within this."""


def pose_starts(fits: LimbFits, limb: Limb, q: Array, measured_m: Array) -> Iterator[Array]:
    """Starts (nq,) of a limb's fit: as it is, by its markers, neutral, and each segment turned over.

    Args:
        fits: Markers and body.
        limb: The limb.
        q: (nq,) pose in doubt.
        measured_m: (M, 3) measured positions of the frame, NaN where missing.
    """
    model = fits.sensor.model
    yield q
    yield joint_by_joint(fits.sensor, measured_m, q, limb.joints)
    neutral = q.copy()
    for joint in limb.joints:
        neutral[joint.q] = model.neutral()[joint.q]
    yield neutral
    for joint in limb.joints:
        after = next_joint(model, limb, joint)
        if after is not None:
            yield turned_over(model, q, joint, after)


def next_joint(model: Body, limb: Limb, joint: SegmentJoint) -> SegmentJoint | None:
    """The ball joint that hangs on a ball joint's segment; None without one, or for other joints.

    Args:
        model: The body.
        limb: The limb.
        joint: One of its joints.
    """
    if joint.kind != "spherical":
        return None
    parents = {one.name: one.parent for one in model.description.segments}
    follows = [
        one for one in limb.joints if one.kind == "spherical" and parents[one.segment] == joint.segment
    ]
    return follows[0] if follows else None


def turned_over(model: Body, q: Array, joint: SegmentJoint, after: SegmentJoint) -> Array:
    """(nq,) the pose with a segment turned by 180° about its long axis and the next one turned back.

    Args:
        model: The body.
        q: (nq,) the pose.
        joint: Ball joint of the segment.
        after: Ball joint of the next one, at the end of the long axis.
    """
    axes, origins = model.placements(q)
    along = axes[joint.joint_id].T @ (origins[after.joint_id] - origins[joint.joint_id])
    along /= np.linalg.norm(along)
    step = np.zeros(model.nv)
    step[joint.v] = np.pi * along
    turned = model.integrate(q, step)
    # The next segment keeps its attitude A: its joint turns by Aᵀ T A, T the half turn about the axis in the world.
    step = np.zeros(model.nv)
    step[after.v] = np.pi * (axes[after.joint_id].T @ axes[joint.joint_id] @ along)
    return model.integrate(turned, step)


def order_starts(fits: LimbFits, limb: Limb, measured_m: Array, misplaced: BoolArray) -> Iterator[Order]:
    """Orders in which the limb's markers may have been named: permuted on a segment, or exchanged with the other side.

    Args:
        fits: Markers and body.
        limb: The limb.
        measured_m: (M, 3) measured positions of the frame, NaN where missing.
        misplaced: (M,) markers far from the pose in doubt.
    """
    names = np.array(fits.sensor.segments, dtype=object)
    for joint in limb.joints:
        own = np.flatnonzero(names == joint.segment)
        if len(own) == 2 and not misplaced[own].any():  # exchanged or not, they fit alike
            continue
        if 2 <= len(own) <= MOST_PERMUTED and np.count_nonzero(~np.isnan(measured_m[own, 0])) >= 2:
            for pairs in likely_pairs(fits.sensor.local_m[own], measured_m[own]):
                yield _exchanged(len(names), [(own[a], own[b]) for a, b in pairs])
    opposite = opposite_markers(fits.sensor)
    of_limb = fits.on_limb[fits.limbs.index(limb)]
    whole = [(m, other) for m, other in opposite.items() if of_limb[m]]
    far = [(m, other) for m, other in whole if misplaced[m] and misplaced[other]]
    for pairs_of_sides in (whole, far) if far != whole else (whole,):
        if pairs_of_sides:
            yield _exchanged(len(names), pairs_of_sides)


def _exchanged(count: int, pairs: Sequence[tuple[int, int]]) -> Order:
    order = np.arange(count)
    for a, b in pairs:
        order[a], order[b] = b, a
    return order


def likely_pairs(local_m: Array, measured_m: Array) -> list[tuple[tuple[int, int], ...]]:
    """Exchanges of one or two pairs of a segment's markers with which it fits about as well or better, the best first.

    Args:
        local_m: (n, 3) places on the segment.
        measured_m: (n, 3) measured positions, NaN where missing; at least one is seen.
    """
    pairs = list(combinations(range(len(local_m)), 2))
    tried: list[tuple[tuple[int, int], ...]] = [(), *((one,) for one in pairs)]
    tried += [two for two in combinations(pairs, 2) if not set(two[0]) & set(two[1])]
    orders = np.array([_exchanged(len(local_m), one) for one in tried])
    moved = measured_m[orders]
    seen = ~np.isnan(moved[..., :1])
    moved, count = np.where(seen, moved, 0.0), seen.sum(axis=1, keepdims=True)
    moved = seen * (moved - moved.sum(axis=1, keepdims=True) / count)
    placed = seen * (local_m - (seen * local_m).sum(axis=1, keepdims=True) / count)
    turns = nearest_rotations(np.einsum("kni,knj->kij", moved, placed))
    cost = ((moved - np.einsum("kij,knj->kni", turns, placed)) ** 2).sum(axis=(1, 2))
    allowed = max(LOOSE * cost[0], len(local_m) * RIGID_M**2)
    best = [k for k in np.argsort(cost) if k and cost[k] <= allowed]
    return [tried[k] for k in best[:KEPT_ORDERS]]


def opposite_markers(sensor: MarkerSensor) -> dict[int, int]:
    """Marker of the other side by marker, where both have the same place on mirrored segments."""
    found: dict[int, int] = {}
    names = np.array(sensor.segments, dtype=object)
    for m, segment in enumerate(sensor.segments):
        others = np.flatnonzero(names == mirrored(segment))
        if mirrored(segment) != segment and len(others):
            apart = np.linalg.norm(sensor.local_m[others] - sensor.local_m[m] * [1.0, -1.0, 1.0], axis=1)
            if apart.min() < MIRROR_M:
                found[m] = int(others[apart.argmin()])
    return {m: other for m, other in found.items() if found.get(other) == m}
