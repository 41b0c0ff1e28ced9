"""Turning to a side in small steps on a tight arc."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.synthesis.course import Course, spare
from mbkf.synthesis.footwork import Spot, Swing
from mbkf.synthesis.plan import MotionPlan

SWING_S, DOUBLE_S, SHIFT_S = 0.46, 0.26, 0.55
RADIUS_M = 0.38
"""Radius of the arc on which the middle between the feet moves."""


def turn_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Turning by 90 to 120 degrees in four steps, to either side.

    Args:
        model: The body that turns.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    course = Course(model, rng)
    course.now_s = 0.4 * spare(seconds, turn_seconds(2) + SHIFT_S, "turning")
    side = int(rng.integers(2))
    add_turn(course, side, np.deg2rad(rng.uniform(90.0, 120.0)), 2, RADIUS_M)
    return course.plan(seconds)


def turn_seconds(pairs: int) -> float:
    """Duration of :func:`add_turn`, s."""
    return SHIFT_S + 2 * pairs * SWING_S + (2 * pairs - 1) * DOUBLE_S


def add_turn(course: Course, side: int, angle: float, pairs: int, radius_m: float) -> None:
    """Steps around a point at one's side, the inner foot first, beginning and ending on both feet.

    Args:
        course: The motion it is added to.
        side: To which side, 0 right, 1 left.
        angle: By how much, rad.
        pairs: Steps of each foot.
        radius_m: Radius of the arc for a body of the reference size.
    """
    rng, feet, size = course.rng, course.feet, course.size
    sign = -1.0 if side == 0 else 1.0
    heading, middle = course.heading(), 0.5 * (feet.spot(0).ankle_m + feet.spot(1).ankle_m)
    centre = middle + sign * radius_m * size * np.array([-np.sin(heading), np.cos(heading)])
    lift, unload = course.now_s + SHIFT_S, SHIFT_S
    for _ in range(pairs):
        for foot in (side, 1 - side):
            spot = _around(feet.spot(foot), centre, sign * angle / pairs)
            swing = Swing(
                foot,
                lift,
                lift + SWING_S,
                spot,
                rng.uniform(0.05, 0.08) * size,
                unload_s=unload,
                reload_s=SHIFT_S,
            )
            feet.swings.append(swing)
            lift, unload = swing.land_s + DOUBLE_S, DOUBLE_S
    course.now_s = lift - DOUBLE_S


def _around(spot: Spot, centre: Array, angle: float) -> Spot:
    c, s = np.cos(angle), np.sin(angle)
    turned = centre + np.array([[c, -s], [s, c]]) @ (spot.ankle_m - centre)
    return Spot(turned, spot.yaw + angle, spot.surface_m)
