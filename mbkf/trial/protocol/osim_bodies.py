"""Segments of the reference body for OpenSim's bodies by name, and the joints of OpenSim's common model."""

from __future__ import annotations

import re

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.io.osim_joints import OsimJoint

_LEFT = re.compile(r"(?:^|[_.\s-])(?:l|left)(?:$|[_.\s-])")
_RIGHT = re.compile(r"(?:^|[_.\s-])(?:r|right)(?:$|[_.\s-])")

_PAIRED = (
    (re.compile(r"femur|thigh"), "thigh"),
    # The patella keeps its distance from the tibia, whose tendon holds it, not from the femur that it slides on.
    (re.compile(r"tibia|fibula|shank|shin|patella"), "shank"),
    (re.compile(r"talus|calcn|calcaneus|hindfoot|midfoot|foot"), "foot"),
    (re.compile(r"toe|phalan|forefoot"), "toes"),
    (re.compile(r"humer|upper_?arm"), "upper_arm"),
    (re.compile(r"ulna|radius|forearm|lower_?arm"), "forearm"),
    (re.compile(r"hand|lunate|scaphoid|capitate|metacarp|finger|thumb|wrist"), "hand"),
)
_MIDLINE = (
    (re.compile(r"head|skull|jaw|cranium"), "head"),
    (re.compile(r"neck|cerv|^c[1-7]$"), "neck"),
    # The reference body bends between T12 and L1: the lumbar spine goes with the pelvis.
    (re.compile(r"lumbar|^l[1-5]$|abdomen"), "pelvis"),
    (re.compile(r"pelvis|sacrum|hip"), "pelvis"),
    (re.compile(r"torso|trunk|thora|spine|back|chest|sternum|rib|scapula|clav|^t\d+$"), "torso"),
)

_BETWEEN = re.compile(r"lumbar|^l[1-5]$|abdomen")
"""Bodies between the reference body's pelvis and torso, whose markers may be on either."""

_SHOULDER = re.compile(r"scapula|clav")


def segment_of(body: str) -> tuple[str, float, tuple[tuple[str, float], ...]]:
    """The segment of the reference body that an OpenSim body belongs to.

    Returns:
        Its name or "", its probability, and other possible segments with theirs.
    """
    plain = re.sub(r"([a-z])([LR])$", r"\1_\2", body.strip()).lower()
    side = "left_" if _LEFT.search(plain) else "right_" if _RIGHT.search(plain) else ""
    if _SHOULDER.search(plain):
        return "torso", 1.0, ()
    if _BETWEEN.search(plain):
        return "pelvis", 0.6, (("torso", 0.4),)
    for pattern, segment in _PAIRED if side else ():
        if pattern.search(plain):
            return side + segment, 1.0, ()
    for pattern, segment in _MIDLINE:
        if pattern.search(plain):
            return segment, 1.0, ()
    return "", 0.0, ()


def _joint(parent: str, child: str, *origin_m: float) -> OsimJoint:
    pose = np.eye(4)
    pose[:3, 3] = origin_m
    return OsimJoint(parent, child, read_only(pose), read_only(np.eye(4)))


def _both_sides(parent: str, child: str, x: float, y: float, z: float) -> tuple[OsimJoint, OsimJoint]:
    from_ = (parent, parent) if parent in ("pelvis", "torso") else (f"{parent}_r", f"{parent}_l")
    return _joint(from_[0], f"{child}_r", x, y, z), _joint(from_[1], f"{child}_l", x, y, -z)


COMMON_JOINTS: tuple[OsimJoint, ...] = (
    _joint("ground", "pelvis", 0.0, 0.0, 0.0),
    *_both_sides("pelvis", "femur", -0.0707, -0.0661, 0.0835),
    *_both_sides("femur", "tibia", -0.0045, -0.3958, 0.0),
    *_both_sides("tibia", "talus", 0.0, -0.43, 0.0),
    *_both_sides("talus", "calcn", -0.04877, -0.04195, 0.00792),
    *_both_sides("calcn", "toes", 0.1788, -0.002, 0.00108),
    _joint("pelvis", "torso", -0.1007, 0.0815, 0.0),
    *_both_sides("torso", "humerus", 0.003155, 0.3715, 0.17),
    *_both_sides("humerus", "ulna", 0.013144, -0.286273, -0.009595),
    *_both_sides("ulna", "radius", -0.006727, -0.013007, 0.026083),
    *_both_sides("radius", "hand", -0.008797, -0.235841, 0.01361),
)
"""OpenSim's common full-body skeleton, unscaled: for marker sets that come without a model, and joints a model lacks.

Legs and trunk: gait2392 (S. L. Delp et al., IEEE Trans. Biomed. Eng. 37 (1990) 757-767), knees straight. Arms: S. R.
Hamner, A. Seth, S. L. Delp, J. Biomech. 43 (2010) 2709-2716, also in the model of A. Rajagopal et al. 2016.
"""

HEAD_ORIGINS_M = (0.0, 0.3715, 0.5435)
"""Heights in the common torso at which models begin their head: with the torso (Pose2Sim), with the shoulders (the set
of A. L. Clouthier et al. 2021), or with the skull."""

MIDDLE_OF_HEAD_M = 0.61
"""Height of the middle of the head in the common torso."""


def head_origin(heights_m: Array) -> float:
    """The height in the common torso of a head without a joint, from heights (N,) of its markers in its own frame, m.

    Of the known origins it is the one that brings the median marker nearest to the middle of the head.
    """
    middle = float(np.median(heights_m))
    return min(HEAD_ORIGINS_M, key=lambda origin: abs(origin + middle - MIDDLE_OF_HEAD_M))


def poses_at_zero(joints: tuple[OsimJoint, ...]) -> dict[str, Array]:
    """(4, 4) frame of every body in the ground with all coordinates at zero; unconnected bodies are left out.

    :data:`COMMON_JOINTS` replace missing joints, and joints to unconnected bodies.
    """
    common = {joint.child: joint for joint in COMMON_JOINTS}
    by_child = common | {joint.child: joint for joint in joints}
    poses: dict[str, Array] = {"ground": np.eye(4), "pelvis": np.eye(4)}
    left = {child: joint for child, joint in by_child.items() if child not in poses}
    while True:
        ready = [joint for joint in left.values() if joint.parent in poses]
        if not ready:
            ready = [joint for child, joint in common.items() if child in left and joint.parent in poses][:1]
        if not ready:
            return poses
        for joint in ready:
            poses[joint.child] = poses[joint.parent] @ joint.child_in_parent
            del left[joint.child]
