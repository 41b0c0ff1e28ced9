"""Standing still for a static capture: close to the neutral posture, as well as a person manages."""

from __future__ import annotations

import numpy as np

from mbkf.model.body import Body
from mbkf.synthesis.curves import Curve, added, sinusoid
from mbkf.synthesis.plan import JOINTS, MotionPlan
from mbkf.synthesis.standing import planted, standing_load

DEVIATION_DEG = 2.5
"""Deviation from straight of a joint of a person asked to stand straight (1 sd)."""


def stand_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Standing with the feet 0.2 m apart and nearly parallel.

    Args:
        model: The body that stands.
        seconds: Duration, s.
        rng: Source of the differences between persons.
    """
    size = float(model.scale.mean())
    lean = {
        "right_upper_arm": (-6.0, 0.0, 0.0),
        "left_upper_arm": (6.0, 0.0, 0.0),
        "right_forearm": (0.0, -6.0, 0.0),
        "left_forearm": (0.0, -6.0, 0.0),
    }
    angles: dict[str, tuple[Curve, Curve, Curve]] = {}
    for joint in ("pelvis", *JOINTS):
        spread = DEVIATION_DEG if joint not in ("pelvis", "right_shank", "left_shank") else 1.0
        axes = [
            _still(lean.get(joint, (0.0, 0.0, 0.0))[axis] + np.clip(rng.normal(0, spread), -5, 5), rng)
            for axis in range(3)
        ]
        angles[joint] = (axes[0], axes[1], axes[2])
    feet = planted(model, 0.10, rng.uniform(0, 6), rng)
    sway = sinusoid(0.0005, 0.3, rng.uniform(0, 6.28), 0.95 * size)
    return MotionPlan(
        0.0,
        seconds,
        angles,
        feet,
        sway,
        standing_load(feet, 0.045 * size, rng),
        np.deg2rad(rng.uniform(4, 6)),
    )


def _still(angle_deg: float, rng: np.random.Generator) -> Curve:
    return added(
        sinusoid(np.deg2rad(0.1), rng.uniform(0.2, 0.5), rng.uniform(0, 6.28), np.deg2rad(angle_deg))
    )
