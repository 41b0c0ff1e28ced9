"""Kind of movement in a capture, recognised from the markers alone, whatever their names.

Where the feet pass each other again and again there is gait: with flights of both feet a run, with a new direction a
turn. Where a foot comes to stand higher and lifts the pelvis there are stairs; where both feet leave the floor together
and the body rises, a jump; where they stay and the pelvis sinks, a squat. Sitting shows in the load of a seat, which
markers alone do not show (:mod:`mbkf.study.session.gather`).
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.records import MarkerTrajectories
from mbkf.io.session import TrialKind
from mbkf.numerics.runs import stretches
from mbkf.study.survey.body_points import BodyPoints, body_points
from mbkf.trial.protocol.standing import stands_still

STILL_SHARE = 0.9
"""Of a standing person so many markers stay; of one who moves a leg or an arm fewer."""

LIFTED_M, FLIGHT_S, JUMP_S = 0.04, 0.05, 0.12
"""A foot is off the floor when its lowest marker is so much above its lowest height. Flights shorter than the second
number are noise; flights longer than the third, outside a run, are those of a jump."""

STEP_M = 0.015
"""In gait the lowest marker of either foot rises by this."""

FALLING = 0.5
"""In flight the pelvis falls with this share of gravity at least; on a step it does not."""

PASSING_M = 0.2
"""Feet that are in turns so far before each other walk."""

RUN_SHARE, FLOWN_SHARE = 0.05, 0.01
"""Gait is a run from the first share of frames with both feet lifted, if the pelvis falls freely in the second."""

TURNED_DEG, STRIDE_S = 45.0, 1.2
"""A turn changes the direction of the pelvis, averaged over about a stride, by this."""

STANDS_M_S, STANDS_S = 0.1, 0.1
"""A foot stands whose centre is slower than this, for so long in all."""

TRAVELS_M, BELT_STANDS = 0.5, 0.3
"""A pelvis that moves by less than the first, over a foot that stands in more than this share, does not walk."""

STAIR_M, ROSE_SHARE = 0.08, 0.5
"""Heights of a standing foot that differ by the first are a stair if the pelvis rises by this share of it."""

RISEN_M, STAYED_M = 0.08, 0.15
"""By how much a pelvis rises in a jump, and how far feet that stay may move."""

SUNK_M = 0.08
"""By how much a pelvis sinks in a squat or onto a seat."""

KNEES_TRAVEL = 0.15
"""In a squat knees go forward by more than this share of the way that the body's middle sinks; who stoops over straight
legs keeps them (three lifts of one person: 0.10 to 0.12; 45 squats and rises, 44 of made persons: 0.18 or more)."""

LOWEST_SHARE = 0.47
"""Who sinks by more of the pelvis's height over the feet kneels or lies."""


def kind_of_markers(markers: MarkerTrajectories) -> TrialKind:
    """Kind of movement of the person in a capture; unknown where the markers leave it open."""
    if not markers.present.any():
        return TrialKind.UNKNOWN
    if stands_still(markers, STILL_SHARE):
        return TrialKind.STATIC
    body = body_points(markers)
    return TrialKind.UNKNOWN if body is None else kind_of_movement(body, markers.rate_hz)


def kind_of_movement(body: BodyPoints, rate_hz: float) -> TrialKind:
    """Kind of movement from the paths of feet and pelvis.

    Args:
        body: Feet and pelvis.
        rate_hz: Frame rate, Hz.
    """
    flights, stairs = flights_of(body, rate_hz), climbs(body, rate_hz)
    if not stairs and _steps(body, rate_hz):
        lifted = float((np.nan_to_num(body.lifts_m).min(axis=1) > LIFTED_M).mean())
        flown = sum(len(run) for run in flights) / len(body.lifts_m)
        if lifted > RUN_SHARE and flown > FLOWN_SHARE:
            return TrialKind.RUN
        return TrialKind.TURN if turned_deg(body, rate_hz) > TURNED_DEG else TrialKind.WALK
    height = body.pelvis_m[:, 2]
    longest = max((len(run) for run in flights), default=0) / rate_hz
    if longest >= JUMP_S and np.nanmax(height) - np.nanmedian(height) > RISEN_M:
        return TrialKind.JUMP
    if stairs:
        return TrialKind.STAIRS
    if _lies_down(body):
        return TrialKind.UNKNOWN
    if (np.nanmax(body.lifts_m, axis=0) > STEP_M).all() and turned_deg(body, rate_hz) > TURNED_DEG:
        return TrialKind.TURN
    stayed = np.nanmax(np.ptp(_known(body.feet_m[:, :, :2]), axis=0)) < STAYED_M
    upright = float(np.nanpercentile(height, 90))
    stoops = body.knee_travel < KNEES_TRAVEL
    if stayed and not flights and not stoops and upright - np.nanmin(height) > SUNK_M:
        return TrialKind.SQUAT
    return TrialKind.UNKNOWN


def turned_deg(body: BodyPoints, rate_hz: float) -> float:
    """Range of the pelvis's direction over the trial, averaged over about a stride, degrees; 0 where it is not seen.

    Args:
        body: The points of the body.
        rate_hz: Frame rate, Hz.
    """
    from scipy.ndimage import uniform_filter1d

    known = np.flatnonzero(~np.isnan(body.yaw_rad))
    if len(known) < 2:
        return 0.0
    yaw = np.interp(np.arange(len(body.yaw_rad)), known, body.yaw_rad[known])
    window = min(round(STRIDE_S * rate_hz), len(yaw) // 2)
    smooth = uniform_filter1d(yaw, max(window, 1))[window // 2 : len(yaw) - window // 2]
    return float(np.rad2deg(np.ptp(smooth)))


def climbs(body: BodyPoints, rate_hz: float) -> bool:
    """True where a foot stands at two heights and the pelvis rises with it by at least :data:`ROSE_SHARE` of the step.

    Args:
        body: The points of the body.
        rate_hz: Frame rate, Hz.
    """
    for foot in range(2):
        place = body.feet_m[:, foot]
        if len(place) < 2:
            return False
        speed = np.linalg.norm(np.gradient(place, axis=0), axis=1) * rate_hz
        seen = ~np.isnan(body.pelvis_m[:, 2]) & ~np.isnan(body.lifts_m[:, foot])
        stands = np.flatnonzero((speed < STANDS_M_S) & seen)
        if len(stands) < 2.0 * STANDS_S * rate_hz:
            continue
        heights, pelvis = body.lifts_m[stands, foot], body.pelvis_m[stands, 2]
        high = heights > 0.5 * (heights.max() + heights.min())
        if high.sum() < STANDS_S * rate_hz or (~high).sum() < STANDS_S * rate_hz:
            continue
        rise = float(np.median(heights[high]) - np.median(heights[~high]))
        rose = float(np.percentile(pelvis[high], 95) - np.percentile(pelvis[~high], 95))
        if rise > STAIR_M and rose > ROSE_SHARE * rise:
            return True
    return False


def _lies_down(body: BodyPoints) -> bool:
    """The pelvis sinks lower than squatting or sitting brings it: the person kneels or lies."""
    above = body.pelvis_m[:, 2] - float(np.nanmin(body.feet_m[:, :, 2]))
    high, low = np.nanpercentile(above, [95, 2])
    return bool(high - low > LOWEST_SHARE * high)


def _steps(body: BodyPoints, rate_hz: float) -> bool:
    """Feet pass each other, both are lifted, and the body gets on: over the floor, or on a belt that moves the feet."""
    if passes(body) < 2 or not (np.nanmax(body.lifts_m, axis=0) > STEP_M).all():
        return False
    travels = float(np.nanmax(np.ptp(_known(body.pelvis_m[:, :2]), axis=0))) > TRAVELS_M
    speed = np.linalg.norm(np.gradient(body.feet_m, axis=0), axis=2) * rate_hz
    stands = float(np.nanmax((speed < STANDS_M_S).mean(axis=0)))
    return travels or stands < BELT_STANDS


def flights_of(body: BodyPoints, rate_hz: float) -> list[Array]:
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


def passes(body: BodyPoints) -> int:
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


def _known(values: Array) -> Array:
    return values[~np.isnan(values).reshape(len(values), -1).any(axis=1)]
