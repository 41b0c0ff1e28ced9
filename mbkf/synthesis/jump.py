"""A countermovement jump: crouch, push-off over the toes, flight, landing on the balls of the feet, recovery."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, SIDES, Array
from mbkf.errors import InvalidInput
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.contact import Load, LoadPlan, sole_outline
from mbkf.synthesis.curves import path, sinusoid
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES, FootPose, InverseKinematics
from mbkf.synthesis.plan import FeetPlan, Flight, MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import constant, posture

CROUCH_S, PUSH_S, FLIGHT_S, ABSORB_S, RECOVER_S = 0.55, 0.32, 0.34, 0.31, 0.85
HEEL_OFF_S, HEEL_DOWN_S = 0.15, 0.10
CROUCH_M, TAKE_OFF_M, TOUCH_DOWN_M, ABSORB_M = -0.230, 0.047, 0.035, -0.225
"""Height of the centre of mass against standing, for a body of the reference size."""

TAKE_OFF_PITCH = (32.0, 450.0, -5000.0)
TOUCH_DOWN_PITCH = (29.0, -425.0, -5000.0)
"""Pitch of the foot (heel up), deg, deg/s, deg/s²."""

CLEARANCE_M = 0.150
STEEPNESS = 0.36
"""Rise of the balls of the feet (times 0.53 in the middle), and its smoothness; 0.36 keeps hip torques small."""

CROUCH_DEG = {
    "torso": (0.0, 16.0, 0.0),
    "neck": (0.0, -8.0, 0.0),
    "head": (0.0, -10.0, 0.0),
    "right_hand": (0.0, 6.0, 2.0),
    "left_hand": (0.0, 6.0, -2.0),
}
SWING_DEG = {
    "right_upper_arm": (-3.0, -100.0, 0.0),
    "left_upper_arm": (3.0, -100.0, 0.0),
    "right_forearm": (0.0, -30.0, 12.0),
    "left_forearm": (0.0, -30.0, -12.0),
}
"""Change of the joint angles (x, y, z) in the crouch, and with the arms swung up."""


def jump_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """One jump of about 0.14 m, standing before and after.

    Args:
        model: The body that jumps.
        seconds: Duration with the standing, s.
        rng: Source of the differences between persons.

    Raises:
        InvalidInput: The time is too short for a jump.
    """
    needed = CROUCH_S + PUSH_S + FLIGHT_S + ABSORB_S + RECOVER_S
    if seconds < needed:
        raise InvalidInput(f"a jump takes {needed:.2f} s, got {seconds:g} s")
    size = float(model.scale.mean())
    begin = 0.4 * (seconds - needed)
    bottom = begin + CROUCH_S
    off = bottom + PUSH_S
    flight_s = FLIGHT_S * np.sqrt(size) * rng.uniform(0.95, 1.05)
    down = off + flight_s
    absorbed = down + ABSORB_S
    end = absorbed + RECOVER_S
    speed = (TOUCH_DOWN_M - TAKE_OFF_M) * size / flight_s + GRAVITY_M_S2 * flight_s / 2
    fall = speed - GRAVITY_M_S2 * flight_s
    height = path(
        [
            (begin, 0.95 * size),
            (bottom, (0.95 + CROUCH_M) * size, 0.0, 4.5),
            (off, (0.95 + TAKE_OFF_M) * size, speed, -GRAVITY_M_S2),
            (down, (0.95 + TOUCH_DOWN_M) * size, fall, -GRAVITY_M_S2),
            (absorbed, (0.95 + ABSORB_M) * size, 0.0, 4.0),
            (end, 0.95 * size),
        ]
    )
    crouch = path(
        [(begin, 0.0), (bottom, 1.0), (off, 0.12, -2.0), (down, 0.15, 1.5), (absorbed, 0.8), (end, 0.0)]
    )
    swing = path(
        [
            (begin, 0.0),
            (bottom - 0.08, -0.45),
            (off, 0.85, 2.0),
            (down, 0.8, -1.5),
            (absorbed + 0.1, 0.25),
            (end, 0.0),
        ]
    )
    angles = with_oscillation(posture(resting(), [(crouch, CROUCH_DEG), (swing, SWING_DEG)], rng), rng)
    del angles["pelvis"]
    pelvis = Flight(off, down, *_pelvis(begin, bottom, off, down, absorbed, end, rng))
    half_width, toe_out = rng.uniform(0.10, 0.13) * size, np.deg2rad(rng.uniform(4, 9))
    feet = _feet(model, half_width, toe_out, off, down)
    return MotionPlan(
        0.0,
        seconds,
        angles,
        feet,
        height,
        _load(model, feet, pelvis, begin, absorbed, rng),
        np.deg2rad(10.0),
        flight=pelvis,
    )


def _pelvis(
    begin: float,
    bottom: float,
    off: float,
    down: float,
    absorbed: float,
    end: float,
    rng: np.random.Generator,
) -> tuple[tuple[list, ...], tuple[list, ...]]:
    """Knots of the pelvis's angles before and after flight."""
    stand, lean = np.deg2rad(rng.normal(2.0, 1.0)), np.deg2rad(rng.uniform(26, 32))
    rise, land = np.deg2rad(rng.uniform(5, 9)), np.deg2rad(rng.uniform(8, 12))
    aside = np.deg2rad(rng.normal(0.0, 0.7, (2, 3)))
    before: list[list] = []
    after: list[list] = []
    for axis in (0, 2):
        a = aside[axis // 2]
        before.append([(begin, a[0]), (bottom, a[1]), (off, a[2])])
        after.append([(down, a[2]), (absorbed, a[1]), (end, a[0])])
    before.insert(1, [(begin, stand), (bottom, lean), (off, rise)])
    after.insert(1, [(down, land), (absorbed, 0.85 * lean), (end, stand)])
    return tuple(before), tuple(after)


def _feet(model: Body, half_width: float, toe_out: float, off: float, down: float) -> FeetPlan:
    """Feet that turn over the balls of the feet before take-off and after touch-down, and lift in between."""
    pitch = path(
        [
            (off - HEEL_OFF_S, 0.0),
            (off, *np.deg2rad(TAKE_OFF_PITCH)),
            (down, *np.deg2rad(TOUCH_DOWN_PITCH)),
            (down + HEEL_DOWN_S, 0.0),
        ]
    )
    size = float(model.scale.mean())
    kinematics = InverseKinematics(model)

    def lift(times: Array) -> Dual:
        part = Dual((times - off) / (down - off), np.full_like(times, 1 / (down - off)), np.zeros_like(times))
        part = dual_numbers.where((part.value > 0) & (part.value < 1), part, constant(times, 0.0))
        return _rise(part) * _rise(1.0 - part) * (CLEARANCE_M * size)

    def feet(times: Array) -> dict[str, FootPose]:
        poses = {}
        angle, up = pitch(times), lift(times)
        for side, sign in zip(SIDES, (-1.0, 1.0), strict=True):
            outline = sole_outline(model, side)
            toes = kinematics.offset[f"{SIDE_NAMES[side]}_toes"] * [1.0, 0.0, 1.0]
            yaw = constant(times, sign * toe_out)
            turned = dual_numbers.rotation(1, angle).apply(-toes) + toes
            ankle = dual_numbers.rotation(2, yaw).apply(turned) + np.array(
                [0.0, sign * half_width, -outline.height]
            )
            poses[side] = FootPose(ankle + up[:, None] * np.array([0.0, 0.0, 1.0]), yaw, angle, -angle)
        return poses

    return feet


def _rise(part: Dual) -> Dual:
    """From 0 with no speed or acceleration towards 1: u³ / (u³ + c³)."""
    cube = part * part * part
    return cube / (cube + STEEPNESS**3)


def _load(
    model: Body, feet: FeetPlan, flight: Flight, begin: float, absorbed: float, rng: np.random.Generator
) -> LoadPlan:
    """Pressure under the middle of the feet, moving under the toes while the heels are up."""
    size = float(model.scale.mean())
    ball = InverseKinematics(model).offset["right_toes"][0]
    off, down = flight.take_off_s, flight.touch_down_s
    forward = path(
        [
            (begin, 0.055 * size),
            (off - HEEL_OFF_S, ball + 0.012 * size),
            (off, ball + 0.030 * size),
            (down, ball + 0.030 * size),
            (down + HEEL_DOWN_S, ball - 0.005 * size),
            (absorbed, 0.06 * size),
            (absorbed + 0.4, 0.055 * size),
        ]
    )
    sway = sinusoid(0.03 * rng.uniform(0.5, 1), rng.uniform(0.2, 0.4), rng.uniform(0, 6.28), 0.5)
    flat = {side: pose for side, pose in feet(np.array([begin])).items()}

    def load(times: Array) -> Load:
        ahead = forward(times).value
        pressure = []
        for side in SIDES:
            c, s = np.cos(flat[side].yaw.value[0]), np.sin(flat[side].yaw.value[0])
            pressure.append(flat[side].ankle.value[0, :2] + ahead[:, None] * np.array([c, s]))
        return Load(sway(times).value, np.stack(pressure, axis=1), (times < off) | (times > down))

    return load
