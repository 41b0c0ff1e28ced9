"""Joint angles that drive the skin of each body, and the accelerations that shake it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.foreign.making.osim_body import OsimBody
from benchmarks.foreign.making.record import RATE_HZ
from benchmarks.foreign.making.skin import Driven
from mbkf.conventions import Array


class Drivers(NamedTuple):
    """Coordinates that drive the skin of a body; ``{s}`` is its side.

    Attributes:
        flexions: Flexion of neighbouring joints.
        others: Their other angles.
        turn: Turn about the body's long axis, "" for none.
    """

    flexions: tuple[str, ...]
    others: tuple[str, ...] = ()
    turn: str = ""


OF_BODY = {
    "pelvis": Drivers(
        ("hip_flexion_r", "hip_flexion_l", "lumbar_extension"),
        ("hip_adduction_r", "hip_adduction_l", "hip_rotation_r", "hip_rotation_l", "lumbar_bending", "lumbar_rotation"),
    ),
    "torso": Drivers(
        ("lumbar_extension", "arm_flex_r", "arm_flex_l"),
        ("lumbar_bending", "lumbar_rotation", "arm_add_r", "arm_add_l"),
    ),
    "femur": Drivers(
        ("hip_flexion_{s}", "knee_angle_{s}"), ("hip_adduction_{s}", "hip_rotation_{s}"), "hip_rotation_{s}"
    ),
    "tibia": Drivers(("knee_angle_{s}", "ankle_angle_{s}"), ("hip_rotation_{s}",), "hip_rotation_{s}"),
    "calcn": Drivers(("ankle_angle_{s}",)),
    "toes": Drivers(("ankle_angle_{s}",)),
    "humerus": Drivers(("arm_flex_{s}", "elbow_flex_{s}"), ("arm_add_{s}", "arm_rot_{s}"), "arm_rot_{s}"),
    "ulna": Drivers(("elbow_flex_{s}",), ("pro_sup_{s}",)),
    "radius": Drivers(("elbow_flex_{s}",), ("pro_sup_{s}",)),
}  # fmt: skip


def driven(body: OsimBody, part: str, q: Array, stand: Array, placed: tuple[Array, Array]) -> Driven:
    """Movement of a body that displaces its skin: joint angles and impacts.

    Args:
        body: The person's body.
        part: Name of the body whose skin it is.
        q: (T, C) coordinates.
        stand: (C,) the standing posture.
        placed: Rotations (T, 3, 3) and origins (T, 3) of the part.
    """
    kind, _, side = part.partition("_")
    names = OF_BODY[kind]

    def less_standing(coordinates: tuple[str, ...]) -> Array:
        columns = [body.column(one.format(s=side)) for one in coordinates]
        return np.asarray(q[:, columns] - stand[columns])

    turned, origins = placed
    acceleration = np.gradient(np.gradient(origins, axis=0), axis=0) * RATE_HZ**2
    shock = np.einsum("tij,ti->tj", turned, acceleration)
    turn = less_standing((names.turn,))[:, 0] if names.turn else np.zeros(len(q))
    return Driven(
        less_standing(names.flexions), less_standing(names.others), turn, shock - shock.mean(axis=0)
    )
