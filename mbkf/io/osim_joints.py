"""Joints and coordinates of OpenSim's models, as versions 2 and 3 (in the child body) and version 4 write them.

Every kind of joint is a spatial transform: three turns, each about an axis that the turns before it have moved, then
three shifts along axes of the frame in the parent (A. Seth et al., Nonlinear Dynamics 62 (2010) 291-303).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array, read_only
from mbkf.io.loose_xml import Element
from mbkf.io.osim_frames import body_frame, placed, vector
from mbkf.io.osim_functions import OsimFunction, function_of, number_list, polynomial

_PARENT_FRAMES = ("socket_parent_frame", "socket_parent_frame_connectee_name", "parent_body")
_CHILD_FRAMES = ("socket_child_frame", "socket_child_frame_connectee_name")
_ROTATIONS = ("rotation1", "rotation2", "rotation3")
_TRANSLATIONS = ("translation1", "translation2", "translation3")
_NO_FUNCTION = ("coordinates", "axis")
_UNITS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

_FREEDOMS = {
    "WeldJoint": "", "PinJoint": "rz", "SliderJoint": "tx", "UniversalJoint": "rx ry", "BallJoint": "rx ry rz",
    "GimbalJoint": "rx ry rz", "PlanarJoint": "rz tx ty", "FreeJoint": "rx ry rz tx ty tz",
}  # fmt: skip
"""Turns (r) and shifts (t) of joints without a spatial transform of their own, in the order of their coordinates."""


@dataclass(frozen=True)
class OsimAxis:
    """A turn or shift of a joint.

    Attributes:
        direction: (3,) its axis.
        amount: Angle, rad, or length, m, as a function of the coordinate.
        coordinate: Name of the coordinate; "" where the amount is constant.
    """

    direction: Array
    amount: OsimFunction
    coordinate: str


@dataclass(frozen=True)
class OsimCoordinate:
    """A coordinate of a joint; rad where it turns, m where it shifts.

    Attributes:
        name: Its name.
        default: Its value in the default pose.
        lowest, highest: Its range.
        clamped: The range is a limit.
        locked: It keeps its default value.
        prescribed: The file prescribes its motion.
        rotational: OpenSim counts it as an angle and writes it in degrees: one of its joint's turns is the coordinate,
            forwards or backwards.
    """

    name: str
    default: float
    lowest: float
    highest: float
    clamped: bool
    locked: bool
    prescribed: bool
    rotational: bool


@dataclass(frozen=True)
class OsimJoint:
    """A joint.

    Attributes:
        parent, child: The bodies it connects.
        parent_frame: (4, 4) its frame in the parent, m.
        child_frame: (4, 4) its frame in the child, m.
        turns: Its turns, in their order.
        shifts: Its shifts.
        coordinates: Its coordinates.
        name: Its name.
        fault: Reason for which its motion could not be read; "" where it could.
    """

    parent: str
    child: str
    parent_frame: Array
    child_frame: Array
    turns: tuple[OsimAxis, ...] = ()
    shifts: tuple[OsimAxis, ...] = ()
    coordinates: tuple[OsimCoordinate, ...] = ()
    name: str = ""
    fault: str = ""

    @cached_property
    def child_in_parent(self) -> Array:
        """(4, 4) the child's frame in the parent with all coordinates at zero, m."""
        moved = np.eye(4)
        for one in self.turns:
            turn = Rotation.from_rotvec(one.amount.value(np.zeros(())) * one.direction).as_matrix()
            moved[:3, :3] = moved[:3, :3] @ turn
        for one in self.shifts:
            moved[:3, 3] += one.amount.value(np.zeros(())) * one.direction
        return read_only(self.parent_frame @ moved @ np.linalg.inv(self.child_frame))

    @property
    def centre_m(self) -> Array:
        """(3,) the joint's centre in the child's frame, m."""
        return self.child_frame[:3, 3]


def osim_joints(root: Element, fixed_frames: dict[str, Element]) -> Iterator[OsimJoint]:
    """The joints of a model, in the order of the file.

    Args:
        root: The model.
        fixed_frames: Frames fixed to bodies, outside joints, by name.
    """
    for body in root.every("Body"):  # up to version 3 a joint stands in its child body
        holder = body.child("Joint")
        joint = holder.children[0] if holder is not None and holder.children else None
        if joint is not None and joint.child_text("parent_body"):
            into = placed(joint.child_text("location_in_parent"), joint.child_text("orientation_in_parent"))
            own = placed(joint.child_text("location"), joint.child_text("orientation"))
            yield _joint(joint, joint.child_text("parent_body"), body.name, into, own)
    for joint in (one for group in root.every("JointSet") for one in group.every(*_joint_tags(group))):
        frames = fixed_frames | {one.name: one for one in joint.every("PhysicalOffsetFrame")}
        parent, into = body_frame(joint.child_text(*_PARENT_FRAMES), frames)
        child, own = body_frame(joint.child_text(*_CHILD_FRAMES), frames)
        if parent and child:
            yield _joint(joint, parent, child, into, own)


def _joint_tags(group: Element) -> set[str]:
    return {one.tag for holder in (group, *group.every("objects")) for one in holder.children} - {"objects"}


def _joint(joint: Element, parent: str, child: str, into: Array, own: Array) -> OsimJoint:
    elements = list(joint.every("Coordinate"))
    turns, shifts, fault = _spatial_transform(joint)
    if joint.tag in _FREEDOMS:
        names = [one.name for one in elements]
        turns, shifts, fault = _freedoms(joint, names)
    if joint.child_text("reverse").lower() in ("true", "1"):
        fault = "it is reversed"
    rotational = {one.coordinate for one in turns if one.amount.line and abs(one.amount.line[1]) == 1.0}
    coordinates = tuple(_coordinate(one, one.name in rotational) for one in elements)
    return OsimJoint(
        parent, child, read_only(into), read_only(own), turns, shifts, coordinates, joint.name, fault
    )


def _freedoms(joint: Element, names: list[str]) -> tuple[tuple[OsimAxis, ...], tuple[OsimAxis, ...], str]:
    """Turns and shifts of a joint whose kind states them, and why they are not known."""
    found: dict[str, list[OsimAxis]] = {"r": [], "t": []}
    words = _FREEDOMS[joint.tag].split()
    for word, name in zip(words, names, strict=False):
        found[word[0]].append(OsimAxis(np.array(_UNITS[word[1]]), polynomial(0.0, 1.0), name))
    fault = "" if len(words) == len(names) else f"it has {len(names)} of {len(words)} coordinates"
    return tuple(found["r"]), tuple(found["t"]), fault


def _spatial_transform(joint: Element) -> tuple[tuple[OsimAxis, ...], tuple[OsimAxis, ...], str]:
    """Turns and shifts of a joint that lists them, and why one is not known."""
    transform = next(joint.every("SpatialTransform"), None)
    elements = {one.name: one for one in transform.every("TransformAxis")} if transform else {}
    fault = "" if joint.tag == "CustomJoint" else f"joints of the kind {joint.tag} are not supported"
    found: list[list[OsimAxis]] = []
    for names in (_ROTATIONS, _TRANSLATIONS):
        found.append([])
        for name in (one for one in names if one in elements):
            axis, wrong = _axis(elements[name])
            fault = fault or (f"its {name} {wrong}" if wrong else "")
            if axis is not None:
                found[-1].append(axis)
    return tuple(found[0]), tuple(found[1]), fault


def _axis(element: Element) -> tuple[OsimAxis | None, str]:
    """A turn or shift, None where it has no axis or function; and why it cannot be right."""
    coordinates = element.child_text("coordinates").split()
    given = next((one for one in element.children if one.tag not in _NO_FUNCTION), None)
    amount = polynomial(0.0, 1.0 if coordinates else 0.0) if given is None else function_of(given)
    direction = vector(element.child_text("axis"))
    if direction is None or not np.linalg.norm(direction) > 0.0:
        return None, "has no axis"
    if amount is None:
        kind = given.children[0].tag if given and given.children else given.tag if given else ""
        return None, f"is a function of a kind that is not supported ({kind})"
    wrong = f"depends on {len(coordinates)} coordinates" if len(coordinates) > 1 else ""
    direction = direction / np.linalg.norm(direction)
    return OsimAxis(read_only(direction), amount, coordinates[0] if coordinates else ""), wrong


def _coordinate(element: Element, rotational: bool) -> OsimCoordinate:
    def stated(name: str) -> bool:
        return element.child_text(name).lower() in ("true", "1")

    default = (number_list(element.child_text("default_value", "initial_value")) or [0.0])[0]
    limits = number_list(element.child_text("range"))
    lowest, highest = limits if len(limits) == 2 else (-np.inf, np.inf)
    clamped = stated("clamped") and lowest <= highest
    return OsimCoordinate(
        element.name, default, lowest, highest, clamped, stated("locked"), stated("prescribed"), rotational
    )
