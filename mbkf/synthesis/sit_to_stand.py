"""Standing up from a chair, and sitting down again where there is time."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.errors import InvalidInput
from mbkf.model.body import Body
from mbkf.synthesis.contact import sole_outline
from mbkf.synthesis.curves import Curve, added, path, scaled, sinusoid
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.holding import Hold
from mbkf.synthesis.inverse_kinematics import InverseKinematics, Pose
from mbkf.synthesis.plan import MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import planted, posture, shifted, standing_load
from mbkf.synthesis.support import Support

SEAT_M = (0.43, 0.47)
"""Range of the height of the seat."""

BUTTOCK_M, GIVE_M = 0.09, 0.02
"""Hip centre over the seat of a body of the reference size, and how much it rises while it is unloaded."""

UNLOAD_S, RISE_S = 0.6, 1.25
"""Times in which the seat is unloaded, and in which the body then rises."""

HEEL_M = 0.04
"""Backward shift of the pressure under the feet while the body leaves the seat, its centre of mass still behind."""

ALONE_S, BOTH_S = 2.6, 5.6
"""Shortest times for standing up, and for sitting down as well."""

LEAN_DEG = {
    "pelvis": (0.0, 28.0, 0.0),
    "torso": (0.0, 20.0, 0.0),
    "neck": (0.0, -8.0, 0.0),
    "head": (0.0, -18.0, 0.0),
    "right_upper_arm": (0.0, -38.0, 0.0),
    "left_upper_arm": (0.0, -38.0, 0.0),
}
"""Change of the joint angles (x, y, z) from upright to leaving the seat."""

SEATED_DEG = {
    "pelvis": (0.0, -6.0, 0.0),
    "torso": (0.0, 6.0, 0.0),
    "right_upper_arm": (0.0, -26.0, 0.0),
    "left_upper_arm": (0.0, -26.0, 0.0),
    "right_forearm": (0.0, -50.0, 12.0),
    "left_forearm": (0.0, -50.0, -12.0),
}
"""Change from standing to sitting upright, the hands on the thighs."""


def sit_to_stand_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """From a chair of 0.43 to 0.47 m to standing; from 5.6 s on, down onto it again.

    Args:
        model: The body.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    if seconds < ALONE_S:
        raise InvalidInput(f"standing up takes {ALONE_S:g} s, got {seconds:g} s")
    size, back = float(model.scale.mean()), seconds >= BOTH_S
    off = rng.uniform(1.1, 1.3) + 0.1 * (seconds - (BOTH_S if back else ALONE_S))
    on = seconds - off if back else np.inf
    seat = rng.uniform(*SEAT_M)
    feet = planted(model, rng.uniform(0.10, 0.13), rng.uniform(5, 12), rng)
    hip = _hip(model, seat, np.deg2rad(rng.uniform(21.0, 25.0)))
    bears = _mirrored(path([(off - UNLOAD_S, 1.0), (off, 0.0)]), off, on)
    sitting = _mirrored(path([(off - 0.2, 1.0), (off + 0.7 * RISE_S, 0.0)], smooth=3), off, on)
    leaning = path([(off - UNLOAD_S - 0.15, 0.0), (off, 1.0), (off + RISE_S, 0.0)], smooth=3)
    leaving = _mirrored(path([(off - UNLOAD_S, 0.0), (off, 1.0), (off + 0.8, 0.0)], smooth=3), off, on)
    low = path([(off - 0.1, 1.0), (off + RISE_S, 0.0)], smooth=3)
    gains = [(sitting, SEATED_DEG), (_mirrored(leaning, off, on), LEAN_DEG)]
    largest = rng.uniform(0.76, 0.82)
    sway = sinusoid(0.004, rng.uniform(0.3, 0.6), rng.uniform(0, 6.28), hip[0] - 0.01)

    def missed(times: Array, pose: Pose) -> Array:
        middle = 0.5 * (pose.origins["right_thigh"].value + pose.origins["left_thigh"].value)
        given = hip[1] + GIVE_M * size * (1.0 - bears(times).value)
        return np.column_stack([middle[:, 0] - hip[0], middle[:, 2] - given])

    def point(times: Array) -> Array:
        return np.column_stack([sway(times).value, np.zeros(len(times)), np.full(len(times), seat)])

    return MotionPlan(
        start_s=0.0,
        end_s=seconds,
        angles=with_oscillation(posture(resting(), gains, rng), rng, 0.6),
        feet=feet,
        height=added(sinusoid(0.0, 1.0, 0.0, 0.95 * size), scaled(-0.24 * size, _mirrored(low, off, on))),
        load=shifted(standing_load(feet, 0.045 * size, rng), scaled(-HEEL_M * size, leaving)),
        straightest_rad=np.deg2rad(10.0),
        supports=(Support("pelvis", lambda times: largest * bears(times).value, point),),
        hold=Hold(
            missed,
            lambda times: np.minimum(1.0, 5.0 * bears(times).value),
            lambda times: ((times > off + 0.5) & (times < on - 0.5)).astype(float),
            {"pelvis": (0.0, 0.5, 0.0), "torso": (0.0, 0.5, 0.0), "head": (0.0, -0.5, 0.0)},
        ),
    )


def _mirrored(curve: Curve, off_s: float, on_s: float) -> Curve:
    """A curve around leaving the seat, and backwards around meeting it again."""
    if not np.isfinite(on_s):
        return curve
    middle = 0.5 * (off_s + on_s)

    def whole(times: Array) -> Dual:
        later = times > middle
        there = curve(np.where(later, off_s + on_s - times, times))
        sign = np.where(later, -1.0, 1.0)
        return Dual(there.value, sign * there.first, there.second)

    return whole


def _hip(model: Body, seat_m: float, shank_rad: float) -> tuple[float, float]:
    """Hips (x and z) of a seated person whose shanks lean forward, m; the ankles are at x = 0."""
    kinematics, size = InverseKinematics(model), float(model.scale.mean())
    thigh = float(np.linalg.norm(kinematics.offset["right_shank"]))
    shank = float(np.linalg.norm(kinematics.offset["right_foot"]))
    ankle = -sole_outline(model, SIDES[0]).height
    height = seat_m + BUTTOCK_M * size
    knee_x, knee_z = shank * np.sin(shank_rad), ankle + shank * np.cos(shank_rad)
    return knee_x - float(np.sqrt(thigh**2 - (knee_z - height) ** 2)), height
