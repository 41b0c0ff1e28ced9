"""Bodies of an OpenSim model and the segments of ours that move with them: by names, and where one lies in the other.

A body with three markers or more that the person has under the same name, not in one line, lies in the segment as these
markers do (Kabsch, Acta Cryst. A32, 1976, 922-923). The axes of another one in the model's upright posture, all
coordinates at zero, are along those of ours in the neutral one, its joint at our joint, and its line to the next joint
along ours; the pelvis lies by the middle of its hips, the trunk by that of its shoulders. These places differ between
persons and models: :func:`replaced` puts the body's origin where a fit has it on the average.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.io.osim import OsimMarker, OsimModel
from mbkf.io.subject import SubjectMarker
from mbkf.model.body import Body
from mbkf.model.osim_kinematics import OsimKinematics
from mbkf.trial.protocol.osim_bodies import segment_of

LEAST_SPREAD_M = 0.02
"""Spread of markers across the line through them below which they do not show how a body is turned."""

PALM_DEG = 90.0
"""OpenSim's forearm turns so much between the palm forward, its zero, and inward."""

_NEXT = {"thigh": "shank", "shank": "foot", "foot": "toes", "upper_arm": "forearm", "forearm": "hand"}
_BRANCHES = {"pelvis": "thigh", "torso": "upper_arm"}


@dataclass(frozen=True)
class Pair:
    """A body and the segment that it moves with.

    Attributes:
        body: The body of the OpenSim model.
        segment: The segment of ours.
        rotation: (3, 3) the body's axes in the segment's.
        origin_m: (3,) the body's origin in the segment's frame, m.
        markers: Names of the model's markers that placed it; none where its joints did.
        centre_m: (3,) the middle of these markers, else its joint, in the body's frame, m.
    """

    body: str
    segment: str
    rotation: Array
    origin_m: Array
    markers: tuple[str, ...]
    centre_m: Array


def shared_markers(model: OsimModel, markers: Sequence[SubjectMarker]) -> dict[str, OsimMarker]:
    """Markers of an OpenSim model by the name of the person's marker; capitals, blanks and points do not matter.

    Args:
        model: The OpenSim model.
        markers: The person's markers.
    """
    theirs = {_plain(one.name): one for one in model.markers}
    found: dict[str, OsimMarker] = {}
    for one in markers:
        names = [_plain(name) for name in (one.name, *one.aliases)]
        match = next((theirs[name] for name in names if name in theirs), None)
        if match is not None and match.name not in {other.name for other in found.values()}:
            found[one.name] = match
    return found


def pairs(kinematics: OsimKinematics, ours: Body, markers: Sequence[SubjectMarker]) -> tuple[Pair, ...]:
    """The pairs of bodies and segments, one for each segment that has a body.

    Of several bodies of a segment (talus and calcaneus) the one with most markers is taken, else the last one.

    Args:
        kinematics: The OpenSim model.
        ours: Our body.
        markers: The person's markers.

    Raises:
        InvalidInput: No body of the model is known by its name.
    """
    shared = shared_markers(kinematics.model, markers)
    held: dict[str, list[SubjectMarker]] = {body: [] for body in kinematics.bodies}
    for one in markers:
        match = shared.get(one.name)
        if match is not None and match.body in held:
            held[match.body].append(one)
    bodies: dict[str, str] = {}
    for body in _moving(kinematics):
        segment = segment_of(body)[0]
        if segment in ours.joints and (
            segment not in bodies or len(held[body]) >= len(held[bodies[segment]])
        ):
            bodies[segment] = body
    if not bodies:
        raise InvalidInput(
            f"{kinematics.model.name}: no body has a name of OpenSim's common models (pelvis, femur_r, tibia_r, …); "
            f"its bodies are {', '.join(kinematics.bodies[:8])}"
        )
    upright = _Upright(kinematics, ours, bodies)
    found = []
    for segment, body in bodies.items():
        own = [one for one in held[body] if one.segment == segment]
        theirs = [shared[one.name] for one in own]
        found.append(_by_markers(body, segment, own, theirs) or upright.pair(segment))
    return tuple(found)


def replaced(pair: Pair, origins_m: Array) -> Pair:
    """The pair of a body without markers with its origin at the mean of places (F, 3) in the segment's frame, m."""
    return pair if pair.markers else replace(pair, origin_m=origins_m.mean(axis=0))


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.casefold())


def _moving(kinematics: OsimKinematics) -> list[str]:
    """Bodies whose joint has a free coordinate, and those fixed to such a body of their segment.

    A patella that follows the knee is left out, and so is a hand that is fixed to its forearm.
    """
    free = {kinematics.names[number] for number in kinematics.free}
    joints = {joint.child: joint for joint in kinematics.model.joints}
    moving: list[str] = []
    for body in kinematics.bodies:
        joint = joints[body]
        own = {one.name for one in joint.coordinates}
        fixed = joint.parent in moving and segment_of(body) == segment_of(joint.parent)
        follows = own.intersection(one.follower for one in kinematics.model.couplers)
        if own & free or (fixed and not follows):
            moving.append(body)
    return moving


def _by_markers(
    body: str, segment: str, own: Sequence[SubjectMarker], theirs: Sequence[OsimMarker]
) -> Pair | None:
    """A body placed by its markers; None where they do not show how it is turned."""
    if len(own) < 3:
        return None
    s, p = np.array([one.position_m for one in own]), np.array([one.position_m for one in theirs])
    about, from_ = s - s.mean(axis=0), p - p.mean(axis=0)
    if np.linalg.svd(from_, compute_uv=False)[1] / np.sqrt(len(own)) < LEAST_SPREAD_M:
        return None
    R = Rotation.align_vectors(about, from_)[0].as_matrix()
    centre = p.mean(axis=0)
    return Pair(body, segment, R, s.mean(axis=0) - R @ centre, tuple(one.name for one in theirs), centre)


class _Upright:
    """Both bodies upright: where the model's bodies lie in our segments without markers."""

    def __init__(self, kinematics: OsimKinematics, ours: Body, bodies: Mapping[str, str]) -> None:
        poses = kinematics.poses(np.zeros((1, len(kinematics.names))))
        to_world, numbers = rotation_to_world("y"), {s: kinematics.body(b) for s, b in bodies.items()}
        self._bodies = bodies
        self._R = {s: to_world @ poses.rotations[0, n] for s, n in numbers.items()}
        self._at = {
            s: to_world @ poses.origins_m[0, kinematics.body(_first_of(kinematics, s))] for s in bodies
        }
        self._from_joint = {s: to_world @ poses.origins_m[0, n] - self._at[s] for s, n in numbers.items()}
        R, origins = ours.placements(ours.neutral())
        self._our_R = {s: R[joint.joint_id] for s, joint in ours.joints.items()}
        self._our_at = {s: origins[joint.joint_id] for s, joint in ours.joints.items()}

    def pair(self, segment: str) -> Pair:
        """A segment's pair."""
        side, plain = _split(segment)
        at, our_at = self._at[segment], self._our_at[segment]
        ends = [s + _BRANCHES[plain] for s in ("right_", "left_")] if plain in _BRANCHES else []
        middle = np.zeros(3)
        if ends and all(end in self._at for end in ends):
            centre = np.mean([self._at[end] for end in ends], axis=0)
            middle = np.mean([self._our_at[end] for end in ends], axis=0) - our_at - (centre - at)
        turn = self._turn(side, plain) @ _palm(side, plain)
        to_segment = self._our_R[segment].T
        origin = to_segment @ (middle + turn @ self._from_joint[segment])
        rotation = to_segment @ turn @ self._R[segment]
        return Pair(self._bodies[segment], segment, rotation, origin, (), np.zeros(3))

    def _turn(self, side: str, plain: str) -> Array:
        """(3, 3) the least turn that takes a limb's line to the next joint along ours."""
        start, end = side + plain, side + _NEXT.get(plain, "")
        if plain not in _NEXT or end not in self._at:
            return np.eye(3)
        line, onto = self._at[end] - self._at[start], self._our_at[end] - self._our_at[start]
        line = _palm(side, plain) @ line
        axis = np.cross(line, onto)
        size = np.linalg.norm(axis)
        if not size > 0.0:
            return np.eye(3)
        turned: Array = Rotation.from_rotvec(np.arctan2(size, line @ onto) * axis / size).as_matrix()
        return turned


def _first_of(kinematics: OsimKinematics, segment: str) -> str:
    """The body of a segment that the segment's proximal joint moves: the talus of a foot."""
    return next(body for body in kinematics.bodies if segment_of(body)[0] == segment)


def _split(segment: str) -> tuple[str, str]:
    """Side and plain name of a segment: "right_thigh" is "right_" and "thigh"."""
    side = next((one for one in ("right_", "left_") if segment.startswith(one)), "")
    return side, segment.removeprefix(side)


def _palm(side: str, plain: str) -> Array:
    """(3, 3) turns forearm and hand from the palm forward to inward, in the world's axes."""
    angle = PALM_DEG if plain in ("forearm", "hand") else 0.0
    turned: Array = Rotation.from_euler("z", angle if side == "right_" else -angle, degrees=True).as_matrix()
    return turned
