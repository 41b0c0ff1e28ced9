"""Standing on one foot and then on the other, the free leg bent."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.synthesis.course import Course, spare
from mbkf.synthesis.curves import path
from mbkf.synthesis.footwork import Swing
from mbkf.synthesis.plan import MotionPlan

SHIFT_S, RAISE_S, CHANGE_S, RELOAD_S = 0.65, 0.4, 0.8, 0.12
"""Handing all load to one foot, raising the other, changing feet, and loading a foot that is put down firmly."""

HOLD_S, REST_S = 0.6, 0.5


def one_foot_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Standing on each foot for about 1.3 s, again and again where there is time.

    Args:
        model: The body that stands.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    once = one_foot_seconds(HOLD_S) + RELOAD_S
    count = max(1, int(seconds / (once + REST_S)))
    course = Course(model, rng)
    rest = spare(seconds, count * once, "standing on each foot") / (count + 1)
    first = int(rng.integers(2))
    for _ in range(count):
        course.now_s += rest
        add_one_foot(course, first, HOLD_S)
        course.now_s += RELOAD_S
    return course.plan(seconds)


def one_foot_seconds(hold_s: float) -> float:
    """Duration of :func:`add_one_foot`, s."""
    return SHIFT_S + 2 * (2 * RAISE_S + hold_s) + CHANGE_S


def add_one_foot(course: Course, first: int, hold_s: float) -> None:
    """Raises one foot and then the other, beginning and ending on both.

    Args:
        course: The motion it is added to.
        first: Foot that stands first, 0 right, 1 left.
        hold_s: How long each foot is held at its highest.
    """
    rng, size = course.rng, course.size
    lift = course.now_s + SHIFT_S
    for standing in (first, 1 - first):
        up, down = lift + RAISE_S, lift + RAISE_S + hold_s
        land = down + RAISE_S
        held = (up, down, rng.uniform(0.02, 0.10) * size, rng.uniform(5.0, 20.0))
        raised = course.feet.spot(1 - standing)
        course.feet.swings.append(
            Swing(
                1 - standing,
                lift,
                land,
                raised,
                rng.uniform(0.12, 0.18) * size,
                10.0,
                held,
                SHIFT_S,
                RELOAD_S,
            )
        )
        sign, free = (1.0, "left") if standing == 0 else (-1.0, "right")
        course.bend(
            path([(lift - 0.3, 0.0), (up, 1.0), (down, 1.0), (land + 0.2, 0.0)]),
            {
                "pelvis": (-2.0 * sign, -2.0, 0.0),
                "torso": (3.0 * sign, 2.0, 0.0),
                "right_upper_arm": (-rng.uniform(4, 14), 0.0, 0.0),
                "left_upper_arm": (rng.uniform(4, 14), 0.0, 0.0),
                f"{free}_forearm": (0.0, -8.0, 0.0),
            },
        )
        lift = land + CHANGE_S
    course.now_s = lift - CHANGE_S
