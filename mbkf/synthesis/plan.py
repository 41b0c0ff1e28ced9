"""Plan of a motion before balance: joint angles, feet, height and load over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.synthesis.contact import LoadPlan
from mbkf.synthesis.curves import Curve, added, path, sinusoid
from mbkf.synthesis.holding import Hold
from mbkf.synthesis.inverse_kinematics import FootPose, HandPose
from mbkf.synthesis.support import Support

FeetPlan = Callable[[Array], dict[str, FootPose]]
"""(T,) times in s to the feet by side."""

HandsPlan = Callable[[Array], dict[str, HandPose]]
"""(T,) times in s to the hands whose place is given, by side."""

JOINTS = (
    "torso",
    "neck",
    "head",
    "right_upper_arm",
    "right_forearm",
    "right_hand",
    "left_upper_arm",
    "left_forearm",
    "left_hand",
    "right_shank",
    "left_shank",
)
"""Joints whose angles (x, y, z) are given; of the shanks only x and z, as the knee's flexion follows from the leg."""


@dataclass(frozen=True)
class Flight:
    """A spell in the air: take-off and touch-down times in s, and the pelvis's angles around it.

    ``before`` and ``after`` hold, per axis x, y, z, the knots (time, angle) of the pelvis on the ground.
    """

    take_off_s: float
    touch_down_s: float
    before: tuple[list[tuple], ...]
    after: tuple[list[tuple], ...]


@dataclass(frozen=True)
class MotionPlan:
    """A motion before balance.

    Attributes:
        start_s, end_s: Time over which balance is solved (a margin around the recorded time, if any).
        angles: Curves (x, y, z) by joint, and of the pelvis (without a flight), rad.
        feet: Poses of the feet.
        height: Height of the centre of mass over the floor, m; shifted as a whole until the legs fit.
        load: Load sharing and pressure.
        straightest_rad: Knee flexion at the straightest moment of the recorded time.
        recorded_s: The time that is recorded; None: all of it.
        flight: The spell in the air, if any.
        supports: Supports besides the feet; not together with a flight.
        hold: The part that stays in place on its support, if any.
        hands: Hands whose place is given, if any.
        belts: Belts under the feet that move uniformly, the plan standing in the laboratory: 1 for both feet, 2 for one
            each; 0 on the floor.
    """

    start_s: float
    end_s: float
    angles: dict[str, tuple[Curve, Curve, Curve]]
    feet: FeetPlan
    height: Curve
    load: LoadPlan
    straightest_rad: float
    recorded_s: tuple[float, float] | None = None
    flight: Flight | None = None
    supports: tuple[Support, ...] = ()
    hold: Hold | None = None
    hands: HandsPlan | None = None
    belts: int = 0


def held(plan: MotionPlan, habit_deg: Mapping[str, float]) -> MotionPlan:
    """The plan of a person who holds joints otherwise.

    Args:
        plan: The plan.
        habit_deg: Constant angle by joint and axis (``"torso_y"``), degrees.
    """
    angles = dict(plan.angles)
    for name, angle_deg in habit_deg.items():
        joint, _, axis = name.rpartition("_")
        if joint in angles:
            curves, k = list(angles[joint]), "xyz".index(axis)
            curves[k] = added(curves[k], sinusoid(0.0, 1.0, 0.0, float(np.deg2rad(angle_deg))))
            angles[joint] = (curves[0], curves[1], curves[2])
    return replace(plan, angles=angles)


def degrees(*knots: tuple[float, ...]) -> Curve:
    """A path whose knots (time, angle, rate, acceleration) are in degrees."""
    return path([(knot[0], *np.deg2rad(knot[1:])) for knot in knots])


def with_oscillation(
    curves: dict[str, tuple[Curve, Curve, Curve]], rng: np.random.Generator, amplitude_deg: float = 1.0
) -> dict[str, tuple[Curve, Curve, Curve]]:
    """The angles with a slow sinusoid added, so that no joint is ever quite still.

    Args:
        curves: Angles (x, y, z) by joint, rad.
        rng: Source of amplitudes, frequencies and phases.
        amplitude_deg: Typical amplitude of the sinusoid, deg.
    """
    moving = {}
    for joint in ("pelvis", *JOINTS):
        if joint not in curves:
            continue
        small = 0.5 if joint.endswith("shank") or joint == "pelvis" else 1.0
        axes = [
            added(
                curve,
                sinusoid(
                    np.deg2rad(small * amplitude_deg * rng.uniform(0.5, 1.0)),
                    rng.uniform(0.3, 0.8),
                    rng.uniform(0, 2 * np.pi),
                ),
            )
            for curve in curves[joint]
        ]
        moving[joint] = (axes[0], axes[1], axes[2])
    return moving


def resting(**changes: tuple[float, float, float]) -> dict[str, tuple[float, float, float]]:
    """Joint angles (x, y, z) in degrees of a relaxed standing person, with changes."""
    posture = {
        "torso": (0.0, 0.0, 0.0),
        "neck": (0.0, 8.0, 0.0),
        "head": (0.0, -8.0, 0.0),
        "right_upper_arm": (-8.0, 0.0, 8.0),
        "left_upper_arm": (8.0, 0.0, -8.0),
        "right_forearm": (0.0, -14.0, 10.0),
        "left_forearm": (0.0, -14.0, -10.0),
        "right_hand": (2.0, -3.0, 0.0),
        "left_hand": (-2.0, -3.0, 0.0),
        "right_shank": (0.5, 0.0, -1.5),
        "left_shank": (-0.5, 0.0, 1.5),
    }
    return {**posture, **changes}
