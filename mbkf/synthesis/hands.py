"""Hands that go from the hanging arm to a place in space, stay there and come back."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.curves import Curve
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES, HandPose, InverseKinematics
from mbkf.synthesis.plan import HandsPlan, resting


def held_hand(model: Body, side: int, held: Curve, wrist_m: Array, pitch_deg: float) -> HandsPlan:
    """One hand at a place in space.

    Args:
        model: The body.
        side: 0 right, 1 left.
        held: 1 where the hand is at its place, 0 where the arm hangs.
        wrist_m: (3,) place of the wrist.
        pitch_deg: Turn of the hand about y there; 0 points down, -90 forward.
    """
    name, base = SIDE_NAMES[SIDES[side]], resting()
    offset = InverseKinematics(model).offset
    upper, fore = (_rotation(base[f"{name}_{part}"]) for part in ("upper_arm", "forearm"))
    hanging = upper @ (offset[f"{name}_forearm"] + fore @ offset[f"{name}_hand"])
    elbow_deg = base[f"{name}_forearm"][1]
    outward = base[f"{name}_upper_arm"][0]

    def hands(times: Array) -> dict[str, HandPose]:
        there = held(times)
        away = 1.0 - there
        pitch = (there * pitch_deg + away * elbow_deg) * float(np.deg2rad(1.0))
        roll = away * float(np.deg2rad(outward))
        rotation = dual_numbers.rotation(1, pitch) @ dual_numbers.rotation(0, roll)
        wrist = Dual.constant(np.tile(wrist_m, (len(times), 1)))
        return {SIDES[side]: HandPose(wrist, there, hanging, rotation)}

    return hands


def palm(size: float, wrist_m: Array, pitch_deg: float, reach_m: float) -> Array:
    """(3,) point of a held hand, m.

    Args:
        size: Mean scale factor of the body.
        wrist_m: (3,) place of the wrist.
        pitch_deg: Turn of the hand about y.
        reach_m: Distance from the wrist on a body of the reference size, m.
    """
    pitch = np.deg2rad(pitch_deg)
    return wrist_m - reach_m * size * np.array([np.sin(pitch), 0.0, np.cos(pitch)])


def shoulder(model: Body, side: int) -> Array:
    """(3,) shoulder over the lumbar joint with the trunk upright, and its height over the floor as z, m.

    Args:
        model: The body, standing with straight legs.
        side: 0 right, 1 left.
    """
    offset, name = InverseKinematics(model).offset, SIDE_NAMES[SIDES[side]]
    below = sum(offset[f"{name}_{part}"][2] for part in ("thigh", "shank", "foot"))
    sole = model.axis_scale(model.description.segment(f"{name}_foot"))[2] * model.description.sole.height_m
    return offset[f"{name}_upper_arm"] - np.array([0.0, 0.0, below + sole])


def _rotation(angles_deg: tuple[float, float, float]) -> Array:
    """(3, 3) rotation of a joint."""
    parts = (Dual.constant(np.array([np.deg2rad(angle)])) for angle in angles_deg)
    return np.asarray(dual_numbers.euler(parts).value[0])
