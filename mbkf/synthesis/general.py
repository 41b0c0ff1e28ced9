"""A general movement: reaching, standing on each foot, turning and stepping up in one trial, in any order."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.synthesis.course import Course, spare
from mbkf.synthesis.one_foot import add_one_foot, one_foot_seconds
from mbkf.synthesis.plan import MotionPlan
from mbkf.synthesis.reach import REACHES, add_reach
from mbkf.synthesis.step_up import SETTLE_S, STEP_UP_S, add_step_up
from mbkf.synthesis.turn import add_turn, turn_seconds

REACH_S, HOLD_S = 1.4, 0.3
TURN_RADIUS_M = 0.30


def general_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Different kinds of support: both feet, one foot, changing feet, and surfaces of different heights.

    Args:
        model: The body that moves.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    course = Course(model, rng)

    def reach() -> None:
        add_reach(course, int(rng.integers(len(REACHES))), REACH_S)

    def one_foot() -> None:
        add_one_foot(course, int(rng.integers(2)), HOLD_S)

    def turn() -> None:
        add_turn(course, int(rng.integers(2)), np.deg2rad(rng.uniform(60.0, 80.0)), 1, TURN_RADIUS_M)

    def step_up() -> None:
        add_step_up(course, int(rng.integers(2)), rng.uniform(0.15, 0.20))

    parts = (reach, one_foot, turn, step_up)
    needed = REACH_S + one_foot_seconds(HOLD_S) + turn_seconds(1) + STEP_UP_S
    rest = spare(seconds, needed + SETTLE_S, "a general movement") / len(parts)
    for k in rng.permutation(len(parts)):
        course.now_s += rest
        parts[k]()
    return course.plan(seconds)
