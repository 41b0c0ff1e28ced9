"""Strength of people: torques that the joints of a synthetic motion must not exceed."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body

PEAK_NM_PER_KG: dict[str, tuple[tuple[float, float], ...]] = {
    "torso": ((2.5, 2.5), (4.0, 2.5), (1.8, 1.8)),
    "neck": ((0.8, 0.8), (1.0, 0.6)),
    "head": ((0.6, 0.6), (0.8, 0.5), (0.4, 0.4)),
    "upper_arm": ((1.2, 1.2), (1.3, 1.3), (0.8, 0.8)),
    "forearm": ((0.6, 0.6), (1.0, 1.0), (0.4, 0.4)),
    "hand": ((0.3, 0.3), (0.3, 0.3), (0.2, 0.2)),
    "thigh": ((2.0, 2.0), (2.5, 4.0), (1.2, 1.2)),
    "shank": ((1.5, 1.5), (3.3, 2.0), (0.8, 0.8)),
    "foot": ((0.8, 0.8), (0.8, 3.0), (0.8, 0.8)),
    "toes": ((0.5, 0.5),),
}
"""Peak torque (negative, positive) about x, y, z in N m per kg of body mass.

About y positive is flexion of trunk and neck, extension of the hip, flexion of the knee, plantarflexion of the ankle.
Legs: the greatest torques of an active person, above the isometric averages of D. E. Anderson et al., J. Biomech. 40
(2007) 3105-3113, which running and jumping exceed. Trunk: about 300 N m of extension. Knee and ankle about x and z
are carried by ligaments. The rest are safe upper bounds of our own choice.
"""


def overloaded(model: Body, tau: Array) -> str:
    """The first joint whose torque a person could not produce; "" where every torque is possible.

    Args:
        model: The body.
        tau: (T, nv) generalised forces, N m.
    """
    for name, joint in model.joints.items():
        if joint.kind == "free":
            continue
        low, high = np.array(PEAK_NM_PER_KG[name.removeprefix("right_").removeprefix("left_")]).T
        if joint.kind == "hinge":
            low, high = low[:1], high[:1]
        used = tau[:, joint.v] / model.mass_kg
        if (used < -low).any() or (used > high).any():
            return name
    return ""
