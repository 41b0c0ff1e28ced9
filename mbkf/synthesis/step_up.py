"""Stepping from the floor onto a step, one foot after the other, and standing there."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.synthesis.course import Course, spare
from mbkf.synthesis.curves import path
from mbkf.synthesis.footwork import Spot, Swing
from mbkf.synthesis.plan import MotionPlan

SHIFT_S, LEAD_S, DOUBLE_S, TRAIL_S, SETTLE_S = 0.55, 0.62, 0.62, 0.75, 0.5
STEP_UP_S = SHIFT_S + LEAD_S + DOUBLE_S + TRAIL_S

LENGTH_M = 0.34
"""Length of the step of a body of the reference size."""


def step_up_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Onto a step of 0.15 to 0.20 m, either foot first.

    Args:
        model: The body that steps.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    course = Course(model, rng)
    course.now_s = 0.4 * spare(seconds, STEP_UP_S + SETTLE_S, "stepping up")
    add_step_up(course, int(rng.integers(2)), rng.uniform(0.15, 0.20))
    return course.plan(seconds)


def add_step_up(course: Course, first: int, rise_m: float) -> None:
    """Both feet onto a step in front of the body.

    Args:
        course: The motion it is added to.
        first: Foot that steps first, 0 right, 1 left.
        rise_m: Height of the step, m.
    """
    rng, feet, size = course.rng, course.feet, course.size
    heading = course.heading()
    way = LENGTH_M * size * np.array([np.cos(heading), np.sin(heading)])
    lift = course.now_s + SHIFT_S
    landed, leaves = lift + LEAD_S, lift + LEAD_S + DOUBLE_S
    for foot, at, lasts, heel_deg, unload in (
        (first, lift, LEAD_S, 10.0, SHIFT_S),
        (1 - first, leaves, TRAIL_S, 30.0, DOUBLE_S),
    ):
        spot = feet.spot(foot)
        over = Spot(spot.ankle_m + way, spot.yaw, spot.surface_m + rise_m)
        clearance = rng.uniform(0.05, 0.07) * size
        feet.swings.append(
            Swing(foot, at, at + lasts, over, clearance, heel_deg, unload_s=unload, reload_s=SETTLE_S)
        )
    lean = path([(lift - 0.2, 0.0), (landed + 0.1, 1.0), (leaves, 1.0), (leaves + TRAIL_S, 0.0)])
    arm = "left" if first == 0 else "right"
    course.bend(
        lean,
        {
            "pelvis": (0.0, 13.0, 0.0),
            "torso": (0.0, 10.0, 0.0),
            "neck": (0.0, -6.0, 0.0),
            "head": (0.0, -4.0, 0.0),
            f"{arm}_upper_arm": (0.0, -22.0, 0.0),
            f"{arm}_forearm": (0.0, -14.0, 0.0),
        },
    )
    course.now_s = leaves + TRAIL_S
