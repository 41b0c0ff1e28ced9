"""Kind of movement in a capture, recognised from the markers alone, whatever their names.

Feet are the low markers that keep their distances among each other; the pelvis carries the markers half-way up. Where
the feet pass each other again and again there is gait, with flights of both feet a run; where both leave the floor
together and the body rises, a jump; where they stay and the pelvis sinks, a squat.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.io.session import TrialKind
from mbkf.numerics.runs import stretches
from mbkf.trial.protocol.standing import stands_still

LEAST_SEEN = 0.3
"""Markers that are seen in a smaller share of the frames are left out."""

STILL_SHARE = 0.9
"""Of a standing person so many markers stay; of one who moves a leg or an arm fewer."""

LOW, MIDDLE = 0.25, (0.45, 0.7)
"""Heights of the feet's and the pelvis's markers, in shares of the highest one's."""

RIGID_M = 0.03
"""Markers of a foot whose distance varies by less (a standard deviation) belong together."""

LIFTED_M, FLIGHT_S, JUMP_S = 0.04, 0.05, 0.12
"""A foot is off the floor when its lowest marker is so much above its lowest height. Flights shorter than the second
number are noise; flights longer than the third, outside a run, are those of a jump."""

STEP_M = 0.015
"""In gait the lowest marker of either foot rises by this."""

FALLING = 0.5
"""In flight the pelvis falls with this share of gravity at least; on a step it does not."""

PASSING_M = 0.2
"""Feet that are in turns so far before each other walk."""

RUN_SHARE = 0.05
"""Share of the frames in flight from which gait is a run."""

RISEN_M, SUNK_M, STAYED_M = 0.08, 0.08, 0.15
"""By how much a pelvis rises in a jump and sinks in a squat, and how far feet that stay may move."""


@dataclass(frozen=True)
class FeetAndPelvis:
    """The body as three points.

    Attributes:
        feet_m: (T, 2, 3) centres of the feet's markers.
        lifts_m: (T, 2) lowest marker of each foot above its lowest height.
        pelvis_m: (T, 3) centre of the markers half-way up.
    """

    feet_m: Array
    lifts_m: Array
    pelvis_m: Array


def kind_of_markers(markers: MarkerTrajectories) -> TrialKind:
    """Kind of movement of the person in a capture; unknown where the markers leave it open."""
    if not markers.present.any():
        return TrialKind.UNKNOWN
    if stands_still(markers, STILL_SHARE):
        return TrialKind.STATIC
    body = feet_and_pelvis(markers)
    return TrialKind.UNKNOWN if body is None else kind_of_movement(body, markers.rate_hz)


def kind_of_movement(body: FeetAndPelvis, rate_hz: float) -> TrialKind:
    """Kind of movement from the paths of feet and pelvis.

    Args:
        body: Feet and pelvis.
        rate_hz: Frame rate, Hz.
    """
    flights = flights_of(body, rate_hz)
    if passes(body) >= 2 and (np.nanmax(body.lifts_m, axis=0) > STEP_M).all():
        in_flight = sum(len(run) for run in flights)
        return TrialKind.RUN if in_flight > RUN_SHARE * len(body.lifts_m) else TrialKind.WALK
    height = body.pelvis_m[:, 2]
    longest = max((len(run) for run in flights), default=0) / rate_hz
    if longest >= JUMP_S and np.nanmax(height) - np.nanmedian(height) > RISEN_M:
        return TrialKind.JUMP
    stayed = np.nanmax(np.ptp(_known(body.feet_m[:, :, :2]), axis=0)) < STAYED_M
    upright = float(np.nanpercentile(height, 90))
    if stayed and not flights and upright - np.nanmin(height) > SUNK_M:
        return TrialKind.SQUAT
    return TrialKind.UNKNOWN


def flights_of(body: FeetAndPelvis, rate_hz: float) -> list[Array]:
    """Frames of each flight: both feet are off the floor and the pelvis falls freely.

    Args:
        body: Feet and pelvis.
        rate_hz: Frame rate, Hz.
    """
    lifted = np.nan_to_num(body.lifts_m, nan=0.0).min(axis=1) > LIFTED_M
    found = []
    for run in stretches(lifted):
        height = body.pelvis_m[run, 2]
        if len(run) < max(FLIGHT_S * rate_hz, 4) or np.isnan(height).any():
            continue
        acceleration = 2.0 * np.polyfit((run - run[0]) / rate_hz, height, 2)[0]
        if acceleration < -FALLING * GRAVITY_M_S2:
            found.append(run)
    return found


def passes(body: FeetAndPelvis) -> int:
    """Number of times that one foot passes the other, from clearly behind to clearly before it."""
    apart = body.feet_m[:, 0, :2] - body.feet_m[:, 1, :2]
    known = apart[~np.isnan(apart).any(axis=1)]
    if len(known) < 3:
        return 0
    moving = known - known.mean(axis=0)
    along = moving @ np.linalg.svd(moving, full_matrices=False)[2][0]
    side = np.where(along > PASSING_M, 1, np.where(along < -PASSING_M, -1, 0))
    turns = side[side != 0]
    return int(np.count_nonzero(np.diff(turns)))


def feet_and_pelvis(markers: MarkerTrajectories) -> FeetAndPelvis | None:
    """Feet and pelvis of a capture; None: two feet are not found."""
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
    return FeetAndPelvis(
        np.stack([_centre(foot) for foot in feet], axis=1), lows - np.nanmin(lows, axis=0), _centre(pelvis)
    )


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


def _known(values: Array) -> Array:
    return values[~np.isnan(values).reshape(len(values), -1).any(axis=1)]
