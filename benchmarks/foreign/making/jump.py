"""A jump on the spot with both arms: down, up, flight, and a landing that knees and hips take up.

Between standing, the lowest point, take-off, landing and the next lowest point the pelvis follows polynomials of fifth
degree whose acceleration is that of free fall at take-off and landing, so that no force is cut off. Times and ways grow
with the legs, so that all persons bear the same multiples of their weight.
"""

from __future__ import annotations

import numpy as np

from benchmarks.foreign.making.legs import RATE_HZ, Stance
from benchmarks.foreign.making.paths import between, minimum_jerk
from mbkf.conventions import GRAVITY_M_S2, Array

LEGS_M = 0.85
"""Length of the legs that the times below are for."""

DOWN_S, LOWEST_S, OFF_S, FLIGHT_S, SOFT_S, UP_S = 0.35, 0.85, 1.15, 0.40, 0.22, 0.9
"""Beginning of the downward movement, lowest point, take-off; durations of flight, of the landing and of getting up."""

DEPTH, SOFT_DEPTH, BENT = 0.32, 0.26, 0.04
"""Depth of the pelvis below straight legs before the flight, after it, and in the whole movement, in leg lengths."""

PUSH, CATCH = 0.4, 0.5
"""Acceleration at both lowest points, in g."""

HEEL, LIFT = 0.13, 0.22
"""Rise of the heels at take-off and of the feet in flight, in leg lengths."""


def jump(legs_m: float, height_m: float, feet_m: Array) -> tuple[Stance, dict[str, Array]]:
    """Task of the legs, and degrees that other joints move by from standing.

    Args:
        legs_m: Length of the legs.
        height_m: Height of the standing pelvis.
        feet_m: (2, 3) middle of both feet.
    """
    slow = np.sqrt(legs_m / LEGS_M)
    off, land = OFF_S * slow, (OFF_S + FLIGHT_S) * slow
    soft, end = land + SOFT_S * slow, land + (SOFT_S + UP_S) * slow
    t = np.arange(round((end + 0.2) * RATE_HZ) + 1) / RATE_HZ
    speed, g = 0.5 * GRAVITY_M_S2 * FLIGHT_S * slow, GRAVITY_M_S2
    knots = [
        (DOWN_S * slow, 0.0, 0.0, 0.0),
        (LOWEST_S * slow, -DEPTH * legs_m, 0.0, PUSH * g),
        (off, 0.0, speed, -g),
        (land, 0.0, -speed, -g),
        (soft, -SOFT_DEPTH * legs_m, 0.0, CATCH * g),
        (end, 0.0, 0.0, 0.0),
    ]
    flight = (t > off - 1.0 / RATE_HZ) & (t < land)
    heels = [(off - 0.15 * slow, 0.0), (off + 0.06, 1.0), (land - 0.1, 0.7), (land + 0.1, 0.0)]
    rise = HEEL * legs_m * minimum_jerk(t, heels)
    lift = LIFT * legs_m * minimum_jerk(t, [(off, 0.0), (0.5 * (off + land), 1.0), (land, 0.0)])
    paths = np.repeat(feet_m[None], len(t), axis=0)
    paths[:, :, 1] += (0.5 * rise + lift)[:, None]
    contacts = np.repeat(~flight[:, None], 2, axis=1)
    height = height_m - BENT * legs_m + between(t, knots)
    stance = Stance(height, paths, contacts, np.zeros((len(t), 2)), np.full(len(t), 0.5), rise)
    down, low = DOWN_S * slow, LOWEST_S * slow
    lean = minimum_jerk(t, [(down, 0.0), (low, 1.0), (off, 0.1), (land, 0.15), (soft, 0.8), (end, 0.0)])
    swing = [(down, 0.0), (low, -35.0), (off, 95.0), (land, 60.0), (soft, 20.0), (end, 0.0)]
    arms = minimum_jerk(t, swing)
    trunk = {"pelvis_tilt": -32.0 * lean, "lumbar_extension": -10.0 * lean}
    return stance, trunk | {"arm_flex_r": arms, "arm_flex_l": 0.9 * arms}
