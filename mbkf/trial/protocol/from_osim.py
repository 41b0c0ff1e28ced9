"""A marker set from an OpenSim model or marker set: bodies become segments, positions go to the reference body.

With all coordinates at zero an OpenSim model has the posture of the reference body, arms hanging, so a marker's place
from a joint's centre is the same on both, up to size. Limbs start at the joint's centre, lie along the line to the
next joint and are scaled by its length; the pelvis is placed by the midpoint of the front iliac spines, OpenSim's
origin, trunk and head by the midpoint of the shoulders. The palm faces forward there and inward here: parts that move
with the radius are turned.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.osim import OsimMarker, OsimModel, read_osim
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import DEFAULT_PLACEMENT_SD_M, Protocol, ProtocolMarker
from mbkf.trial.protocol.osim_bodies import head_origin, poses_at_zero, segment_of

FIXED_SD_M, FREE_SD_M = 0.025, 0.050
"""Spread of a marker about its imported place, per coordinate: fixed in OpenSim, and free. The same markers imported
from four files differ from the sets that come with mbkf by 17 mm per coordinate."""

NOISE_M = {
    "thigh": 0.008, "upper_arm": 0.007, "torso": 0.006, "neck": 0.006, "pelvis": 0.005, "shank": 0.005,
    "forearm": 0.005, "hand": 0.005, "foot": 0.004, "toes": 0.004, "head": 0.004,
}  # fmt: skip
"""Camera noise and skin movement by segment, in the order of Leardini 2005 and Cappozzo 1996."""

INSIDE_M = 0.015
"""Distance from the centre of a large joint below which a marker is inside the body: software computed it."""

HEAD_FROM_M = 0.36
"""Height in the reference torso above which a marker on the torso of a model without a head is on the head."""

TOES_FROM_M, FOOT_UP_TO_M = 0.03, 0.015
"""Distance before the line of the toes' bend from which a marker of the foot is on the toes, and up to which one of the
toes is on the foot: many models weld the two."""

BY_PLACE = 0.8
"""Probability of a segment chosen by the marker's place instead of the file's body."""

SKIN_M = 0.010
"""Distance of a marker's middle in front of the bone of the iliac spine, OpenSim's origin."""

LONGEST_M = 3.0
_NEXT = {"thigh": "shank", "shank": "foot", "foot": "toes", "upper_arm": "forearm", "forearm": "hand"}
_LARGE_JOINTS = ("thigh", "shank", "foot", "upper_arm", "forearm")
_SIDES = ("right_", "left_")
_NO_BODY = "its body '{}' has no segment in the reference body"


@dataclass(frozen=True)
class ImportedSet:
    """A marker set from another program's file.

    Attributes:
        protocol: The marker set; markers that could not be placed are among its ignored points.
        moved: Markers placed on another segment than the file's, by name, "torso → head": the model has no head, or
            its toes are part of the foot.
        computed: Markers inside a joint, taken as computed points.
        with_skeleton: True where the file has joints; else those of OpenSim's common model are used.
    """

    protocol: Protocol
    moved: Mapping[str, str]
    computed: tuple[str, ...]
    with_skeleton: bool


def import_osim(path: str | Path) -> ImportedSet:
    """Reads the markers of an OpenSim model (.osim) or of a marker set's own file (.xml).

    Args:
        path: The file.

    Raises:
        FileFormatError: It is not such a file, or holds no marker on a known body.
        InvalidInput: Its lengths are not in metres.
    """
    model = read_osim(path)
    body = load_body("human18")
    skeleton = _Skeleton(model, body)
    far = np.median([np.linalg.norm(marker.position_m) for marker in model.markers])
    if far > LONGEST_M:
        raise InvalidInput(
            f"{path}: markers lie {far:.3g} m from their bodies' origins; convert the file to metres, OpenSim's unit"
        )
    markers: list[ProtocolMarker] = []
    ignored = dict(model.damaged)
    for marker in model.markers:
        placed = skeleton.place(marker)
        if placed is None:
            ignored[marker.name] = _NO_BODY.format(marker.body)
        else:
            markers.append(placed)
    if not markers:
        bodies = ", ".join(sorted({marker.body for marker in model.markers})[:8])
        raise FileFormatError(path, f"holds no marker on a known body; its bodies are {bodies}")
    name = "_".join(Path(path).stem.lower().split())
    protocol = Protocol(
        name,
        model.name if model.name != Path(path).stem else f"Markers of {Path(path).name}",
        body,
        tuple(markers),
        f"imported from {Path(path).name} (OpenSim)",
        ignored,
    )
    return ImportedSet(
        protocol,
        skeleton.moved,
        tuple(m.name for m in markers if m.kind == "computed"),
        bool(model.joints),
    )


class _Skeleton:
    """Takes points of a model to segments of the reference body."""

    def __init__(self, model: OsimModel, body: BodyDescription) -> None:
        self._body = body
        self._poses = poses_at_zero(model.joints)
        self._own = {joint.child for joint in model.joints}
        heads = [m for m in model.markers if segment_of(m.body)[0] == "head" and m.body not in self._own]
        self._has_head = bool(heads) or any(segment_of(one)[0] == "head" for one in self._own)
        for marker in heads:  # bodies that nothing joins to the torso
            pose = np.eye(4)
            pose[1, 3] = head_origin(np.array([m.position_m[1] for m in heads if m.body == marker.body]))
            self._poses[marker.body] = self._poses["torso"] @ pose
        self.moved: dict[str, str] = {}
        centres = {joint.child: joint.centre_m for joint in model.joints}
        self._centres: dict[str, Array] = {}
        for child, pose in self._poses.items():
            segment, _, _ = segment_of(child)
            if segment and segment not in self._centres and "patella" not in child:
                self._centres[segment] = _turned(pose[:3, :3] @ centres.get(child, np.zeros(3)) + pose[:3, 3])
        self._shoulders = self._middle("upper_arm")
        self._scales = self._found_scales()
        self._turns = {side + name: self._turn(side, name) for side in _SIDES for name in _NEXT}

    def place(self, marker: OsimMarker) -> ProtocolMarker | None:
        """The marker on the reference body; None where its body is unknown."""
        segment, probability, others = segment_of(marker.body)
        pose = self._pose_of(marker.body, segment)
        if not segment or pose is None:
            return None
        ground = _turned(pose[:3, :3] @ marker.position_m + pose[:3, 3])
        placed = self._by_place(ground, segment, marker.body)
        if placed != segment:
            self.moved[marker.name] = f"{segment} → {placed}".replace("_", " ")
            sure = placed == "head"
            segment, probability, others = (
                (placed, 1.0, ()) if sure else (placed, BY_PLACE, ((segment, 1.0 - BY_PLACE),))
            )
        position = self._in_segment(ground, segment, marker.body)
        kind = "anatomical" if marker.fixed else "technical"
        if any(self._inside(ground, side, name) for name in _LARGE_JOINTS for side in _SIDES):
            kind = "computed"
        sd = {"anatomical": FIXED_SD_M, "technical": FREE_SD_M}.get(
            kind, 2.0 * DEFAULT_PLACEMENT_SD_M["computed"]
        )
        return ProtocolMarker(
            marker.name,
            segment,
            read_only(np.round(position, 4)),
            kind,
            sd,
            NOISE_M[_plain(segment)],
            probability=probability,
            alternatives=others,
        )

    def _pose_of(self, body: str, segment: str) -> Array | None:
        """The body's frame, or that of the common model's body that is the same segment."""
        if body in self._poses:
            return self._poses[body]
        near = [one for one in self._poses if one != "ground" and segment_of(one)[0] == segment and segment]
        return self._poses[near[0]] if near else None

    def _by_place(self, ground: Array, segment: str, body: str) -> str:
        """The segment of a point of the ground, where it differs from the model's body."""
        side = segment.removesuffix(_plain(segment))
        if segment == "torso" and not self._has_head and self._on_trunk(ground)[2] > HEAD_FROM_M:
            return "head"
        if _plain(segment) not in ("foot", "toes"):
            return segment
        before = self._in_segment(ground, f"{side}toes", body)[0]
        limit = TOES_FROM_M if _plain(segment) == "foot" else FOOT_UP_TO_M
        return f"{side}{'toes' if before > limit else 'foot'}"

    def _in_segment(self, ground: Array, segment: str, body: str) -> Array:
        """(3,) a point of the ground in the reference body's segment."""
        if segment == "pelvis":
            spines = [self._body.landmark(f"{side}_asis").position_m for side in ("right", "left")]
            return np.mean(spines, axis=0) - [SKIN_M, 0.0, 0.0] + self._scales[segment] * ground
        if segment in ("torso", "neck", "head"):
            at = self._on_trunk(ground)
            while segment != "torso":
                at, segment = at - self._body.segment(segment).origin_m, self._body.segment(segment).parent
            return at
        at = self._scales[segment] * (ground - self._centres[segment])
        side, name = segment.removesuffix(_plain(segment)), _plain(segment)
        if name == "hand" or (name == "forearm" and "ulna" not in body.lower()):
            at = _pronated(at, side)
        along = {"toes": "foot", "hand": "forearm"}.get(name, name)
        turned: Array = self._turns[side + along] @ at
        return turned

    def _turn(self, side: str, name: str) -> Array:
        """(3, 3) the least turn of a limb onto the reference body's line from its joint to the next."""
        line = self._centres[side + _NEXT[name]] - self._centres[side + name]
        if name == "forearm":
            line = _pronated(line, side)
        onto = self._body.segment(side + _NEXT[name]).origin_m
        axis = np.cross(line, onto)
        size = np.linalg.norm(axis)
        if not size > 0.0:
            return np.eye(3)
        turn: Array = Rotation.from_rotvec(np.arctan2(size, line @ onto) * axis / size).as_matrix()
        return turn

    def _on_trunk(self, ground: Array) -> Array:
        """(3,) a point of the ground in the reference body's torso, by the shoulders."""
        origins = [self._body.segment(f"{side}_upper_arm").origin_m for side in ("right", "left")]
        return np.mean(origins, axis=0) + self._scales["torso"] * (ground - self._shoulders)

    def _inside(self, ground: Array, side: str, name: str) -> bool:
        return float(np.linalg.norm(ground - self._centres[side + name])) < INSIDE_M

    def _middle(self, segment: str) -> Array:
        return 0.5 * (self._centres[f"right_{segment}"] + self._centres[f"left_{segment}"])

    def _found_scales(self) -> dict[str, float]:
        """From the model to the reference body, by segment: the length between joints, or a neighbour's scale."""
        found: dict[str, float] = {}
        for side in _SIDES:
            for name, end in _NEXT.items():
                length = np.linalg.norm(self._centres[side + end] - self._centres[side + name])
                reference = np.linalg.norm(self._body.segment(side + end).origin_m)
                found[side + name] = float(reference / length) if length > 0.0 else 1.0
            found[side + "toes"], found[side + "hand"] = found[side + "foot"], found[side + "forearm"]
        if any(segment_of(one)[0].endswith("upper_arm") for one in self._own):
            height = (self._shoulders - self._middle("thigh"))[2]
            arm, thigh = (self._body.segment(f"right_{one}").origin_m[2] for one in ("upper_arm", "thigh"))
            trunk = float((arm - thigh) / height) if height > 0.0 else 1.0
        else:
            trunk = float(np.mean([found[s + n] for s in _SIDES for n in ("thigh", "shank")]))
        return found | dict.fromkeys(("pelvis", "torso"), trunk)


def _plain(segment: str) -> str:
    return segment.removeprefix("right_").removeprefix("left_")


def _pronated(point: Array, side: str) -> Array:
    """(3,) a point of an arm whose palm faces forward, once the palm faces inward."""
    turn = 1.0 if side == "right_" else -1.0
    return np.array([-turn * point[1], turn * point[0], point[2]])


def _turned(point: Array) -> Array:
    """(3,) x forward, y up, z right becomes x forward, y left, z up."""
    return np.array([point[0], -point[2], point[1]])
