"""Walking on a treadmill: level walking seen from a frame that moves with the walker, over one belt or one per foot.

Newton's law holds in every frame that moves uniformly, so forces and torques are those of the walk over ground.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.synthesis.contact import Load
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import FootPose
from mbkf.synthesis.plan import MotionPlan
from mbkf.synthesis.walk import walk_and_speed

APART_M = 0.08
"""Additional width of the steps on two belts, so that no sole reaches over the other belt."""


def treadmill_plan(model: Body, seconds: float, rng: np.random.Generator, belts: int) -> MotionPlan:
    """Walking in place along +x; the ground moves back at the walker's mean speed of about 1.2 m/s.

    Args:
        model: The body that walks.
        seconds: Duration, s.
        rng: Source of the differences between persons.
        belts: 1 belt under both feet, or 2, one each, of the same speed.
    """
    walk, speed_m_s = walk_and_speed(model, seconds, rng, APART_M if belts == 2 else 0.0)
    back = np.array([-speed_m_s, 0.0, 0.0])
    grid = np.linspace(0.0, seconds, 200)
    first = np.array([np.mean(walk.load(grid).total_pressure[:, 0] - speed_m_s * grid), 0.0, 0.0])

    def moved(times: Array) -> Dual:
        """(T, 3) way of the belt; its start puts the mean pressure over x = 0."""
        still = np.zeros((len(times), 3))
        return Dual(np.outer(times, back) - first, still + back, still)

    def feet(times: Array) -> dict[str, FootPose]:
        return {
            side: replace(foot, ankle=foot.ankle + moved(times)) for side, foot in walk.feet(times).items()
        }

    def load(times: Array) -> Load:
        planned = walk.load(times)
        return replace(planned, pressure=planned.pressure + moved(times).value[:, None, :2])

    return replace(walk, feet=feet, load=load, belts=belts)
