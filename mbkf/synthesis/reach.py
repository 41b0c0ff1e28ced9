"""Reaching on two feet: forwards, sideways and up, with one arm or both."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.synthesis.course import Course
from mbkf.synthesis.curves import path, scaled
from mbkf.synthesis.plan import MotionPlan
from mbkf.synthesis.standing import Angles

REACH_S, BETWEEN_S = 1.5, 0.25

Reach = tuple[dict[str, tuple[float, float, float]], float, float]
"""Change of joint angles in degrees, and how far the pressure moves forward (m) and to the right foot (share)."""


def reach_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """One reach after the other, in every direction in turn, beginning anywhere.

    Args:
        model: The body that reaches.
        seconds: Duration, s.
        rng: Source of the differences.
    """
    course = Course(model, rng)
    count = max(1, round((seconds - BETWEEN_S) / (REACH_S + BETWEEN_S)))
    each = (seconds - BETWEEN_S) / count - BETWEEN_S
    order = rng.permutation(len(REACHES))
    for k in range(count):
        course.now_s += BETWEEN_S
        add_reach(course, int(order[k % len(order)]), each)
    return course.plan(seconds)


def add_reach(course: Course, kind: int, seconds: float) -> None:
    """One reach and back.

    Args:
        course: The motion it is added to.
        kind: Which of :data:`REACHES`.
        seconds: How long it takes, s.
    """
    rng = course.rng
    side = int(rng.integers(2))
    angles, forward_m, share = REACHES[kind](side, rng)
    slow = min(1.0, (seconds / REACH_S) ** 2)
    begin, end = course.now_s, course.now_s + seconds
    there, back = begin + 0.42 * seconds, begin + 0.58 * seconds
    amount = path([(begin, 0.0), (there, slow), (back, slow), (end, 0.0)], smooth=3)
    course.bend(amount, angles)
    course.feet.nudges.append(
        (
            scaled(share if side == 0 else -share, amount),
            scaled(forward_m * course.size, amount),
            scaled(0.0, amount),
        )
    )
    course.now_s = end


def _mirrored(angles: Angles, side: int) -> dict[str, tuple[float, float, float]]:
    """Angles of a reach with the right arm, for the arm of a side."""
    if side == 0:
        return dict(angles)
    swap = {"right": "left", "left": "right"}
    found = {}
    for joint, (x, y, z) in angles.items():
        name, _, rest = joint.partition("_")
        found[f"{swap[name]}_{rest}" if name in swap else joint] = (-x, y, -z)
    return found


def _forward(side: int, rng: np.random.Generator) -> Reach:
    """Both arms forwards, the trunk bent."""
    deep = rng.uniform(0.85, 1.1)
    angles = {
        "pelvis": (0.0, 16.0 * deep, 0.0),
        "torso": (0.0, 22.0 * deep, 0.0),
        "neck": (0.0, -10.0, 0.0),
        "head": (0.0, -10.0, 0.0),
        "right_upper_arm": (0.0, -90.0 * deep, 0.0),
        "left_upper_arm": (0.0, -84.0 * deep, 0.0),
        "right_forearm": (0.0, 4.0, 0.0),
        "left_forearm": (0.0, 4.0, 0.0),
    }
    return _mirrored(angles, side), 0.045, 0.0


def _sideways(side: int, rng: np.random.Generator) -> Reach:
    """One arm sideways, the trunk bent and twisted to that side."""
    deep = rng.uniform(0.85, 1.1)
    angles = {
        "pelvis": (3.0 * deep, 3.0, -8.0 * deep),
        "torso": (12.0 * deep, 6.0, -20.0 * deep),
        "neck": (3.0, 0.0, 0.0),
        "head": (3.0, 0.0, -15.0),
        "right_upper_arm": (-68.0 * deep, -20.0, 0.0),
        "left_upper_arm": (12.0, 8.0, 0.0),
        "right_forearm": (0.0, 4.0, 0.0),
    }
    return _mirrored(angles, side), 0.01, 0.24


def _up(side: int, rng: np.random.Generator) -> Reach:
    """One arm up and forwards, the trunk long and leaning a little to the other side."""
    deep = rng.uniform(0.85, 1.1)
    angles = {
        "pelvis": (-2.0, -2.0, 3.0),
        "torso": (-5.0 * deep, -5.0 * deep, 6.0 * deep),
        "neck": (0.0, -8.0, 0.0),
        "head": (0.0, -10.0, 0.0),
        "right_upper_arm": (-6.0, -140.0 * deep, 0.0),
        "left_upper_arm": (4.0, 6.0, 0.0),
        "right_forearm": (0.0, 2.0, 0.0),
    }
    return _mirrored(angles, side), 0.025, 0.10


REACHES = (_forward, _sideways, _up)
