"""Squats: down and up on flat feet, trunk leaning forward and arms raised."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.synthesis.curves import Curve, added, path, scaled, sinusoid
from mbkf.synthesis.plan import MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import planted, posture, standing_load

PERIOD_S = 2.4
COMFORTABLE_S = 1.9
"""Shorter squats are shallower."""

DROP_M = 0.27
"""Fall of the centre of mass of a body of the reference size."""

BOTTOM_DEG = {
    "pelvis": (0.0, 26.0, 0.0),
    "torso": (0.0, 14.0, 0.0),
    "neck": (0.0, -10.0, 0.0),
    "head": (0.0, -12.0, 0.0),
    "right_upper_arm": (2.0, -85.0, 0.0),
    "left_upper_arm": (-2.0, -85.0, 0.0),
    "right_forearm": (0.0, -8.0, 15.0),
    "left_forearm": (0.0, -8.0, -15.0),
    "right_hand": (0.0, 6.0, 0.0),
    "left_hand": (0.0, 6.0, 0.0),
}
"""Change of the joint angles (x, y, z) from standing to the bottom of the squat."""


def squat_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Repeated squats, one about every 2.4 s, to a knee flexion of about 100°.

    Args:
        model: The body that squats.
        seconds: Duration, s.
        rng: Source of the differences between persons.
    """
    depth = _depth(seconds, max(1, round(seconds / PERIOD_S)), rng)
    size = float(model.scale.mean())
    feet = planted(model, rng.uniform(0.12, 0.15), rng.uniform(8, 16), rng)
    return MotionPlan(
        start_s=0.0,
        end_s=seconds,
        angles=with_oscillation(posture(resting(), [(depth, BOTTOM_DEG)], rng), rng),
        feet=feet,
        height=added(sinusoid(0.0, 1.0, 0.0, 0.95 * size), scaled(-DROP_M * size, depth)),
        load=standing_load(feet, 0.05 * size, rng),
        straightest_rad=np.deg2rad(10.0),
    )


def _depth(seconds: float, repetitions: int, rng: np.random.Generator) -> Curve:
    """0 standing … 1 at the bottom, with a short rest at both."""
    period = seconds / repetitions
    knots: list[tuple[float, float]] = [(0.0, 0.0)]
    for k in range(repetitions):
        deep = rng.uniform(0.93, 1.05) * min(1.0, (period / COMFORTABLE_S) ** 2)
        for part, value in ((0.03, 0.0), (0.48, deep), (0.52, deep), (0.97, 0.0)):
            knots.append(((k + part) * period, value))
    knots.append((seconds, 0.0))
    return path(knots, smooth=3)
