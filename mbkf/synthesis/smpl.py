"""Motions of the SMPL skeleton on a body of ours: joint rotations onto segments, then velocities and accelerations.

With G_j the rotation of joint j in the file's world (a product down the tree), U from that world to ours and B the
body's axes at rest (SMPL: x left, y up, z forward; ours: x forward, y left, z up), a segment has the orientation
S = U G_j B A. A turns an arm that hangs into one held to the side, palm down: the skeleton rests with its arms there.
Every segment keeps its orientation but the neck (two axes of three; the head makes up for it) and the toes (one of
three). Lengths are those of our body: the file's shape needs a licensed model.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.amass import JOINTS, PARENTS, SmplMotion
from mbkf.model.body import Body, SegmentJoint

SEGMENTS = {
    "pelvis": "pelvis", "torso": "spine3", "neck": "neck", "head": "head",
    "right_upper_arm": "right_shoulder", "right_forearm": "right_elbow", "right_hand": "right_wrist",
    "left_upper_arm": "left_shoulder", "left_forearm": "left_elbow", "left_hand": "left_wrist",
    "right_thigh": "right_hip", "right_shank": "right_knee", "right_foot": "right_ankle", "right_toes": "right_foot",
    "left_thigh": "left_hip", "left_shank": "left_knee", "left_foot": "left_ankle", "left_toes": "left_foot",
}  # fmt: skip
"""Per segment of ours the SMPL joint that carries it."""

LEAST_FRAMES = 6

_BODY_AXES = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""B: columns are our axes x, y, z in SMPL's."""

WORLDS = {"z": np.eye(3), "y": _BODY_AXES.T}
"""U by the axis of the file's world that points up."""


@dataclass(frozen=True)
class MovedBody:
    """A motion: (T,) times s, (T, nq) configurations, (T, nv) velocities and accelerations in the tangent space."""

    times_s: Array
    q: Array
    v: Array
    a: Array


def motion_of_smpl(model: Body, motion: SmplMotion, up: str = "z") -> MovedBody:
    """The motion of a body whose segments turn as those of the file.

    Between frames, quaternions and places are joined by quintic splines, whose derivatives are the velocities and
    accelerations. The file's root is the middle between the hips; its height is not known without the file's shape, so
    that feet need not stand at height 0.

    Args:
        model: The body.
        motion: The file's motion.
        up: Axis of the file's world that points up, "z" (AMASS) or "y".

    Raises:
        UnknownName: Another axis, or a segment of the body that the skeleton does not have.
        InvalidInput: Fewer than six frames.
    """
    if up not in WORLDS:
        raise UnknownName("axis that points up", up, WORLDS, "--up")
    frames = len(motion.rotations)
    if frames < LEAST_FRAMES:
        raise InvalidInput(f"the motion has {frames} frames; {LEAST_FRAMES} or more give accelerations")
    for segment in model.joints:
        if segment not in SEGMENTS:
            raise UnknownName("segment with a joint of SMPL", segment, SEGMENTS)
    times = np.arange(frames) / motion.rate_hz
    q, v, a = np.zeros((frames, model.nq)), np.zeros((frames, model.nv)), np.zeros((frames, model.nv))
    wanted, had = _orientations(motion, WORLDS[up]), dict[str, Rotation]()
    for segment, joint in model.joints.items():
        parent = model.description.segment(segment).parent
        before = had.get(parent, Rotation.identity(frames))
        turn = before.inv() * wanted[segment]
        if joint.axes:
            angles = _angles(turn, joint.axes)
            had[segment] = before * Rotation.from_euler(joint.axes.upper(), angles)
            curve = _spline(times, angles)
            q[:, joint.q], v[:, joint.v], a[:, joint.v] = angles, curve(times, 1), curve(times, 2)
        else:
            had[segment] = wanted[segment]
            _turning(joint, times, turn, q, v, a)
    moved, pelvis = MovedBody(times, q, v, a), had[model.root.segment]
    place = motion.trans_m @ WORLDS[up].T - pelvis.apply(_between_hips(model))
    _travelling(model.root, place, pelvis.inv(), times, moved)
    return moved


def _orientations(motion: SmplMotion, world: Array) -> dict[str, Rotation]:
    """Per segment its (F,) orientations in our world."""
    vectors = np.array(motion.rotations)  # SciPy refuses arrays that may not be written
    turns = [Rotation.from_rotvec(vectors[:, k]) for k in range(len(JOINTS))]
    courses: list[Rotation] = []
    for turn, parent in zip(turns, PARENTS, strict=True):
        courses.append(turn if parent < 0 else courses[parent] * turn)
    to_world = Rotation.from_matrix(world)
    return {
        segment: to_world * courses[JOINTS.index(joint)] * Rotation.from_matrix(axes_at_rest(segment))
        for segment, joint in SEGMENTS.items()
    }


def axes_at_rest(segment: str) -> Array:
    """(3, 3) B A: a segment's axes in those of the SMPL body at rest."""
    arm = {"right": -0.5 * np.pi, "left": 0.5 * np.pi}
    side, _, part = segment.partition("_")
    turn = arm[side] if part in ("upper_arm", "forearm", "hand") else 0.0
    return _BODY_AXES @ Rotation.from_rotvec([turn, 0.0, 0.0]).as_matrix()


def _angles(turn: Rotation, axes: str) -> Array:
    """(F, axes) continuous angles of a hinge or universal joint that come nearest to a turn."""
    if len(axes) == 1:
        quaternion = turn.as_quat()
        angles = 2.0 * np.arctan2(quaternion[:, "xyz".index(axes)], quaternion[:, 3])[:, None]
    else:
        third = next(axis for axis in "xyz" if axis not in axes)
        angles = turn.as_euler((axes + third).upper())[:, :2]
    unwrapped: Array = np.unwrap(angles, axis=0)
    return unwrapped


def _turning(joint: SegmentJoint, times: Array, turn: Rotation, q: Array, v: Array, a: Array) -> None:
    """The turn of a spherical or free joint: ω = 2 Im(q* ⊗ q̇) and its rate 2 Im(q* ⊗ q̈), in the segment's axes."""
    quaternion = turn.as_quat()
    flips = np.where((quaternion[1:] * quaternion[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)
    quaternion[1:] *= np.cumprod(flips)[:, None]
    curve = _spline(times, quaternion)
    q[:, joint.q.stop - 4 : joint.q.stop] = quaternion
    v[:, joint.v.stop - 3 : joint.v.stop] = _twice_vector_part(quaternion, curve(times, 1))
    a[:, joint.v.stop - 3 : joint.v.stop] = _twice_vector_part(quaternion, curve(times, 2))


def _twice_vector_part(q: Array, rate: Array) -> Array:
    """(F, 3) twice the vector part of q* ⊗ rate."""
    return 2.0 * (q[:, 3:] * rate[:, :3] - rate[:, 3:] * q[:, :3] - np.cross(q[:, :3], rate[:, :3]))


def _travelling(root: SegmentJoint, place: Array, to_body: Rotation, times: Array, moved: MovedBody) -> None:
    """The root's place, and its velocity in its own axes, which turn with it."""
    first, linear = (slice(part.start, part.start + 3) for part in (root.q, root.v))
    turning, curve = moved.v[:, linear.stop : root.v.stop], _spline(times, place)
    moved.q[:, first] = place
    moved.v[:, linear] = to_body.apply(curve(times, 1))
    moved.a[:, linear] = to_body.apply(curve(times, 2)) - np.cross(turning, moved.v[:, linear])


def _spline(times: Array, values: Array) -> BSpline:
    """Quintic: its second derivative bends least at the ends."""
    return make_interp_spline(times, values, k=5)


def _between_hips(model: Body) -> Array:
    """(3,) middle of the hip centres in the pelvis's frame, m."""
    places = model.pin_model.jointPlacements
    hips = [places[model.joint(f"{side}_thigh").joint_id].translation for side in ("right", "left")]
    middle: Array = np.mean(hips, axis=0)
    return middle
