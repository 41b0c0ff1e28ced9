"""Standing with a hand on a rail for a while: it takes hold, bears a part of the weight, and lets go."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput
from mbkf.model.body import Body
from mbkf.synthesis.curves import added, path, scaled, sinusoid
from mbkf.synthesis.hands import held_hand, palm, shoulder
from mbkf.synthesis.plan import MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import planted, posture, shifted, standing_load
from mbkf.synthesis.support import Support

REACH_S, LOAD_S = 0.7, 0.4
"""Time in which the hand goes to the rail, and least time in which it takes its load."""

LEAST_S = 3.0

RAIL_M = (0.29, 0.10, -0.37)
"""Wrist at the rail from the shoulder: ahead, outward, up; of a body of the reference size."""

PALM_M, PITCH_DEG = 0.07, -50.0
"""Wrist to the rail of a body of the reference size, and the hand's turn on it (0 points down, -90 forward)."""

FORCE = (0.10, 0.20)
"""Range of the greatest force on the hand, as part of the weight."""

UP, AHEAD, OUTWARD = (0.80, 0.95), (-0.5, 0.3), (-0.3, 0.3)
"""Ranges of the direction of the force on the hand, before it is made a unit vector."""


def rail_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Standing; the right or left hand takes a rail beside and ahead of the body and lets go of it again.

    Args:
        model: The body.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    if seconds < LEAST_S:
        raise InvalidInput(f"holding a rail takes {LEAST_S:g} s, got {seconds:g} s")
    size, side = float(model.scale.mean()), int(rng.integers(2))
    outward = -1.0 if side == 0 else 1.0
    begin, end = REACH_S + rng.uniform(0.1, 0.25), seconds - REACH_S - rng.uniform(0.1, 0.25)
    feet = planted(model, rng.uniform(0.09, 0.12), rng.uniform(5, 12), rng)
    held = path([(begin - REACH_S, 0.0), (begin, 1.0), (end, 1.0), (end + REACH_S, 0.0)], smooth=3)
    ahead_m = 0.045 * size
    wrist = shoulder(model, side) + size * np.array(RAIL_M) * [1.0, outward, 1.0] + [ahead_m, 0.0, 0.0]
    point = palm(size, wrist, PITCH_DEG, PALM_M)
    direction = np.array([rng.uniform(*AHEAD), outward * rng.uniform(*OUTWARD), rng.uniform(*UP)])
    most = rng.uniform(*FORCE) * model.mass_kg * GRAVITY_M_S2 * direction / np.linalg.norm(direction)
    middle, eased = 0.5 * (begin + end) + rng.uniform(-0.1, 0.1), rng.uniform(0.5, 0.8)
    bears = path([(begin, 0.0), (begin + LOAD_S, 1.0), (middle, eased), (end - LOAD_S, 0.9), (end, 0.0)])
    lean = {
        "pelvis": (-1.0 * outward, 2.0, 0.0),
        "torso": (-3.0 * outward, 6.0, 4.0 * outward),
        "head": (0.0, -3.0, 0.0),
    }

    def force(times: Array) -> Array:
        inside = (times > begin) & (times < end)
        return np.outer(np.where(inside, bears(times).value, 0.0), most)

    load = standing_load(feet, ahead_m, rng)
    return MotionPlan(
        start_s=0.0,
        end_s=seconds,
        angles=with_oscillation(posture(resting(), [(held, lean)], rng), rng),
        feet=feet,
        height=added(sinusoid(0.004 * size, rng.uniform(0.3, 0.6), rng.uniform(0, 6.28), 0.95 * size)),
        load=shifted(load, scaled(rng.uniform(-0.01, 0.02) * size, held)),
        straightest_rad=np.deg2rad(8.0),
        supports=(
            Support(
                ("right_hand", "left_hand")[side],
                lambda times: np.zeros(len(times)),
                lambda times: np.tile(point, (len(times), 1)),
                force,
                held=True,
            ),
        ),
        hands=held_hand(model, side, held, wrist, PITCH_DEG),
    )
