"""Feet and pelvis of the body in a capture, found from the markers alone, whatever their names.

Feet are the low markers that keep their distances among each other; the pelvis carries the markers half-way up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import MarkerTrajectories

LEAST_SEEN = 0.3
"""Markers that are seen in a smaller share of the frames are left out."""

LOW, MIDDLE, KNEES = 0.25, (0.45, 0.7), (0.15, 0.35)
"""Heights of the markers of feet, pelvis and knees, in shares of the highest one's."""

LOWEST_PERCENT = 10.0
"""Of the frames so many count as the body's lowest ones, and as many as its highest."""

RIGID_M = 0.03
"""Markers of a foot whose distance varies by less (a standard deviation) belong together."""


@dataclass(frozen=True)
class BodyPoints:
    """The body as a few points.

    Attributes:
        feet_m: (T, 2, 3) centres of the feet's markers.
        lifts_m: (T, 2) lowest marker of each foot above its lowest height.
        pelvis_m: (T, 3) centre of the markers half-way up.
        yaw_rad: (T,) rotation of the pelvis's markers about the vertical against their mean shape, continuous.
        knee_travel: Horizontal way of the markers near the knees between the body's highest and lowest frames, over
            the way by which its middle sinks; NaN where either is not shown.
    """

    feet_m: Array
    lifts_m: Array
    pelvis_m: Array
    yaw_rad: Array
    knee_travel: float = float("nan")


def body_points(markers: MarkerTrajectories) -> BodyPoints | None:
    """The points of a capture; None: two feet are not found."""
    seen = markers.present.mean(axis=0) >= LEAST_SEEN
    positions = markers.positions_m[:, seen]
    if not positions.size:
        return None
    heights = np.nanmedian(positions[..., 2], axis=0)
    floor = float(np.nanmin(positions[..., 2]))
    share = (heights - floor) / max(float(heights.max()) - floor, 1e-6)
    low = positions[:, share < LOW]
    feet = _two_groups(low) or _two_sides(low, positions)
    middle = positions[:, (share > MIDDLE[0]) & (share < MIDDLE[1])]
    if feet is None or not middle.size:
        return None
    pelvis = _steadiest([middle[:, group] for group in _groups(middle)], _centre(positions))
    lows = np.stack([_lowest(foot) for foot in feet], axis=1)
    return BodyPoints(
        np.stack([_centre(foot) for foot in feet], axis=1),
        lows - np.nanmin(lows, axis=0),
        _centre(pelvis),
        _yaw(pelvis),
        _knee_travel(positions),
    )


def _knee_travel(positions: Array) -> float:
    """Way of the knees over that of the body's middle, as :attr:`BodyPoints.knee_travel`.

    Markers are of the knees or of the middle by their heights in the body's highest frames.
    """
    height = _centre(positions)[:, 2]
    low, high = np.nanpercentile(height, [LOWEST_PERCENT, 100.0 - LOWEST_PERCENT])
    sunk, risen = positions[height <= low], positions[height >= high]
    shown = (~np.isnan(sunk).any(axis=2)).any(axis=0) & (~np.isnan(risen).any(axis=2)).any(axis=0)
    if not shown.any():
        return float("nan")
    upright = np.nanmedian(risen[:, shown], axis=0)
    way = np.nanmedian(sunk[:, shown], axis=0) - upright
    floor = float(np.nanmin(positions[..., 2]))
    share = (upright[:, 2] - floor) / max(float(upright[:, 2].max()) - floor, 1e-6)
    knees = way[(share > KNEES[0]) & (share < KNEES[1])]
    middle = way[(share > MIDDLE[0]) & (share < MIDDLE[1])]
    if not len(knees) or not len(middle):
        return float("nan")
    sinks = max(-float(np.median(middle[:, 2])), 1e-6)
    return float(np.median(np.linalg.norm(knees[:, :2], axis=1))) / sinks


def _steadiest(groups: list[Array], body: Array) -> Array:
    """The group that stays nearest to its place in the body: of the markers half-way up the pelvis, and not a hand."""
    several = [group for group in groups if group.shape[1] > 1] or groups
    spreads = [np.nanstd(_centre(group) - body, axis=0).sum() for group in several]
    return several[int(np.argmin(spreads))]


def _two_groups(positions: Array) -> list[Array] | None:
    """The markers of the two largest groups that keep their distances; None: fewer than two groups."""
    groups = _groups(positions)
    return [positions[:, group] for group in groups[:2]] if len(groups) > 1 else None


def _groups(positions: Array) -> list[list[int]]:
    """Markers that keep their distances from one another, the largest group first."""
    left, groups = set(range(positions.shape[1])), []
    while left:
        group, frontier = set(), {min(left)}
        while frontier:
            group |= frontier
            frontier = {
                other
                for other in left - group
                for one in frontier
                if _keeps_distance(positions[:, one], positions[:, other])
            }
        left -= group
        groups.append(sorted(group))
    return sorted(groups, key=len, reverse=True)


def _two_sides(low: Array, positions: Array) -> list[Array] | None:
    """The low markers of either side, of feet that never move apart: a standing body is broader than it is deep."""
    places, body = np.nanmean(low, axis=0)[:, :2], np.nanmedian(positions, axis=0)[:, :2]
    if len(places) < 2:
        return None
    middle = body.mean(axis=0)
    across = np.linalg.svd(body - middle, full_matrices=False)[2][0]
    side = (places - middle) @ across > 0.0
    return [low[:, side], low[:, ~side]] if side.any() and not side.all() else None


def _keeps_distance(a: Array, b: Array) -> bool:
    distance = np.linalg.norm(a - b, axis=1)
    known = distance[~np.isnan(distance)]
    return len(known) > 1 and float(known.std()) < RIGID_M


def _centre(positions: Array) -> Array:
    """(T, 3) mean of the markers, each taken about its own place so that a missing one does not shift it."""
    own = np.nanmean(positions, axis=0)
    moved = positions - own
    known: BoolArray = ~np.isnan(moved)
    counts = known.sum(axis=1)
    total = np.where(known, moved, 0.0).sum(axis=1)
    return np.where(counts > 0, total / np.maximum(counts, 1), np.nan) + own.mean(axis=0)


def _lowest(positions: Array) -> Array:
    """(T,) height of the lowest marker above its own lowest height."""
    lifts = positions[..., 2] - np.nanmin(positions[..., 2], axis=0)
    known = ~np.isnan(lifts)
    lowest = np.where(known, lifts, np.inf).min(axis=1)
    return np.where(np.isfinite(lowest), lowest, np.nan)


def _yaw(positions: Array) -> Array:
    """(T,) rotation about the vertical of markers (T, M, 3) against those of the first frame that shows the most.

    The rotation that fits best in the plane (G. Wahba's problem in two dimensions); NaN where fewer than two of the
    markers are seen.
    """
    plane = positions[:, :, 0] + 1j * positions[:, :, 1]
    counts = (~np.isnan(plane)).sum(axis=1)
    shape = plane[int(counts.argmax())]
    both = ~np.isnan(plane) & ~np.isnan(shape)
    number = np.maximum(both.sum(axis=1), 1)
    shapes, places = np.where(both, shape, 0.0), np.where(both, plane, 0.0)
    across = (places * np.conj(shapes)).sum(axis=1)
    across -= places.sum(axis=1) * np.conj(shapes).sum(axis=1) / number
    known = both.sum(axis=1) > 1
    yaw = np.full(len(plane), np.nan)
    yaw[known] = np.unwrap(np.angle(across[known]))
    return yaw
