"""A functional trial (star-arc): each leg in turn swings every way from the hip and bends, while the arms move.

A leg goes forwards, backwards and aside, around in a circle, and bends its knee with the thigh down and raised; the
ankle moves all the while (V. Camomilla et al., J. Biomech. 39 (2006) 1096-1106). Every large joint so turns about more
than one axis where it can, which shows where its centre and its axes lie.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis.contact import sole_outline
from mbkf.synthesis.course import Course, spare
from mbkf.synthesis.curves import path
from mbkf.synthesis.footwork import Swing, Waypoint
from mbkf.synthesis.inverse_kinematics import InverseKinematics
from mbkf.synthesis.plan import MotionPlan

SHIFT_S, RELOAD_S, CHANGE_S = 0.7, 0.3, 0.5
"""Handing all load to one foot, loading the other again, and a rest between."""

LEAST_S, RAISE_S = 0.45, 0.75
"""Shortest time from one direction of the leg to the next; raising the foot, and putting it down."""

HIP_ASIDE_M, HIP_HIGH = 0.10, 0.975
"""The free hip over the standing ankle: aside, m, and up, as part of the leg's length."""

Way = tuple[tuple[float, float, float, float], ...]

STAR: Way = (
    (35.0, 0.0, 30.0, 12.0),
    (-18.0, 4.0, 28.0, -15.0),
    (26.0, 22.0, 32.0, 10.0),
    (-12.0, 16.0, 28.0, -12.0),
    (2.0, 30.0, 30.0, 10.0),
    (6.0, 4.0, 34.0, -15.0),
)
"""Directions of the star: flexion and abduction of the hip–ankle line, flexion of the knee, dorsiflexion, degrees."""

ARC: Way = tuple(
    (
        8.0 + 20.0 * float(np.cos(turn)),
        15.0 + 11.0 * float(np.sin(turn)),
        30.0,
        12.0 * float(np.sin(2.0 * turn)),
    )
    for turn in np.deg2rad(np.arange(0.0, 361.0, 60.0))
)
BENDS: Way = (
    (-32.0, 4.0, 75.0, 10.0),
    (4.0, 4.0, 30.0, -15.0),
    (8.0, 4.0, 85.0, 15.0),
    (0.0, 4.0, 36.0, 0.0),
)
"""Knee bent with the thigh down, straight, bent with the thigh raised, straight; columns as of the star."""

PROGRAMMES: tuple[tuple[int, Way], ...] = ((2, (*STAR, *ARC, *BENDS)), (1, (*STAR, *ARC, *BENDS)), (1, STAR))
"""Legs and way, the first that there is time for."""

ARMS = (
    {"right_upper_arm": (0.0, -75.0, 0.0), "left_upper_arm": (0.0, -75.0, 0.0)},
    {"right_upper_arm": (-55.0, -20.0, 0.0), "left_upper_arm": (55.0, -20.0, 0.0)},
    {"right_forearm": (0.0, -85.0, 0.0), "left_forearm": (0.0, -85.0, 0.0)},
    {"right_upper_arm": (-25.0, 30.0, 0.0), "left_upper_arm": (25.0, 30.0, 0.0)},
    {"right_forearm": (0.0, -70.0, 55.0), "left_forearm": (0.0, -70.0, -55.0)},
    {"right_upper_arm": (-12.0, -35.0, 25.0), "left_upper_arm": (12.0, -35.0, -25.0)},
)
"""Changes of the arms' angles, each overlapping the next: shoulders go around, elbows bend and turn."""


def star_arc_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Star-arc of one leg, then of the other; where time is short, of one leg only, or its star alone.

    Args:
        model: The body that moves.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    course = Course(model, rng)
    fits = [plan for plan in PROGRAMMES if _least_s(*plan) <= seconds]
    legs, way = (fits or PROGRAMMES[-1:])[0]
    left = spare(seconds, _least_s(legs, way), "the star of one leg")
    each = LEAST_S + left / (legs * (len(way) - 1))
    first = int(rng.integers(2))
    for standing in (first, 1 - first)[:legs]:
        course.now_s += CHANGE_S
        _add_star_arc(course, standing, way, each)
    return course.plan(seconds)


def _least_s(legs: int, way: Way) -> float:
    """Shortest time for so many legs to go a way, s."""
    alone = 2.0 * RAISE_S + (len(way) - 1) * LEAST_S
    return legs * (SHIFT_S + alone + RELOAD_S + CHANGE_S) + CHANGE_S


def _add_star_arc(course: Course, standing: int, way: Way, each_s: float) -> None:
    """Star-arc of one leg, beginning and ending on both feet.

    Args:
        course: The motion it is added to.
        standing: Foot that stands, 0 right, 1 left.
        way: Where the other leg goes.
        each_s: Time from one direction to the next, s.
    """
    rng, free = course.rng, 1 - standing
    lift = course.now_s + SHIFT_S
    passed, at = [], lift + RAISE_S
    for angles_deg in way:
        wide = rng.uniform(0.88, 1.08, 4)
        passed.append(_waypoint(course, standing, at, np.array(angles_deg) * wide))
        at += each_s
    land = at - each_s + RAISE_S
    spot = course.feet.spot(free)
    course.feet.swings.append(Swing(free, lift, land, spot, 0.0, 8.0, None, SHIFT_S, RELOAD_S, tuple(passed)))
    _move_arms(course, lift, land)
    course.now_s = land + RELOAD_S


def _waypoint(course: Course, standing: int, at_s: float, angles_deg: Array) -> Waypoint:
    """The free foot where hip and knee have these angles.

    Args:
        course: The motion, for its body and its feet.
        standing: Foot that stands.
        at_s: When it is there.
        angles_deg: (4,) flexion and abduction of the hip–ankle line, flexion of the knee, dorsiflexion.
    """
    flexion, abduction, knee, ankle = np.deg2rad(angles_deg)
    side, outward = SIDES[1 - standing], 1.0 if standing == 0 else -1.0
    length = InverseKinematics(course.model).leg_length(side)
    below = sole_outline(course.model, side).height
    hip = np.array([0.0, outward * HIP_ASIDE_M * course.size, HIP_HIGH * length - below])
    hip[:2] += course.feet.spot(standing).ankle_m
    reach = length * np.cos(0.5 * knee)
    direction = np.array(
        [np.sin(flexion), outward * np.cos(flexion) * np.sin(abduction), -np.cos(flexion) * np.cos(abduction)]
    )
    shank = flexion - 0.5 * knee
    return Waypoint(at_s, hip + reach * direction, -shank - ankle, outward * abduction)


def _move_arms(course: Course, start_s: float, end_s: float) -> None:
    """Both arms through all of :data:`ARMS` between two times, s."""
    step = (end_s - start_s) / (len(ARMS) + 1)
    for k, change in enumerate(ARMS):
        begin = start_s + k * step
        pulse = path([(begin, 0.0), (begin + step, course.rng.uniform(0.85, 1.1)), (begin + 2.0 * step, 0.0)])
        course.bend(pulse, change)
