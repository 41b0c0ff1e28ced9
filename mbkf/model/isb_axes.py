"""The ISB's axes on a body: pelvis, thighs, shanks and feet from palpable points and joint centres.

G. Wu et al., J. Biomech. 35 (2002) 543-548: pelvis, femur, ankle; E. S. Grood, W. J. Suntay, J. Biomech. Eng. 105
(1983) 136-144: knee, whose shank has its long axis from knee to ankle centre. Wu's axes are x forward, y up, z right;
written here in the body's x forward, y left, z up. The standards define no axes of the foot by points: in the neutral
posture they are those of the shank at the knee, so that tibial torsion stays in the ankle's rotation. The upper limb
(Wu, J. Biomech. 38 (2005) 981-992) is read in the body's own axes.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mbkf.conventions import Array
from mbkf.model.angle_reading import AngleReading, JointAxes
from mbkf.numerics.orthonormal import axes_from

SIDES = {"r": "right", "l": "left"}


def isb_axes(places: Mapping[str, Array]) -> AngleReading:
    """The convention for a person.

    Args:
        places: (3,) places in the body's neutral posture, in which all segments' frames are the world's, m: ``sacrum``,
            and with ``right_`` and ``left_`` before them ``asis``, ``hip_centre``, ``knee``, ``knee_medial``, ``ankle``
            and ``ankle_medial``.
    """
    right, left = places["right_asis"], places["left_asis"]
    pelvis = axes_from("y", left - right, "x", 0.5 * (right + left) - places["sacrum"])
    joints = {"pelvis": JointAxes(np.eye(3), pelvis)}
    for suffix, side in SIDES.items():
        leftward = -1.0 if side == "left" else 1.0
        knees, ankles = (
            (places[f"{side}_{name}"], places[f"{side}_{name}_medial"]) for name in ("knee", "ankle")
        )
        knee, ankle = 0.5 * (knees[0] + knees[1]), 0.5 * (ankles[0] + ankles[1])
        thigh = axes_from("z", places[f"{side}_hip_centre"] - knee, "y", leftward * (knees[1] - knees[0]))
        shank = axes_from("z", knee - ankle, "y", leftward * (knees[1] - knees[0]))
        between = axes_from("y", leftward * (ankles[1] - ankles[0]), "z", knee - ankle)
        joints[f"hip_{suffix}"] = JointAxes(pelvis, thigh)
        joints[f"knee_{suffix}"] = JointAxes(thigh, shank)
        joints[f"ankle_{suffix}"] = JointAxes(between, shank)
    return AngleReading("isb", joints)
