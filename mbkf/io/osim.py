"""OpenSim's models (.osim, of every version from 2 to 4) and marker sets (.xml): joints, and markers on bodies.

What is read of a model is its pose with every coordinate at zero, in which OpenSim's bodies stand upright with their
axes parallel: x forward, y up, z to the right. Format: OpenSim's documented model files (opensim.stanford.edu).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError
from mbkf.io.loose_xml import Element, read_loose_xml

LARGEST = 1e6
"""Bound of lengths (m, or mm by mistake), angles and coefficients of a body's joints."""

_NEVER_NESTED = frozenset({"Marker", "Body", "PhysicalOffsetFrame", "TransformAxis"})
_ROTATIONS = ("rotation1", "rotation2", "rotation3")
_TRANSLATIONS = ("translation1", "translation2", "translation3")
_PARENT_FRAMES = ("socket_parent_frame", "socket_parent_frame_connectee_name", "parent_body")
_CHILD_FRAMES = ("socket_child_frame", "socket_child_frame_connectee_name")
_OFFSET_PARENTS = ("socket_parent", "socket_parent_connectee_name")
_MARKER_BODIES = ("socket_parent_frame", "socket_parent_frame_connectee_name", "body")


@dataclass(frozen=True)
class OsimJoint:
    """A joint at zero coordinates.

    Attributes:
        parent, child: The bodies it connects.
        child_in_parent: (4, 4) the child body's frame in the parent body's, m.
        centre_m: (3,) the joint's centre in the child's frame, m.
    """

    parent: str
    child: str
    child_in_parent: Array
    centre_m: Array


@dataclass(frozen=True)
class OsimMarker:
    """A marker.

    Attributes:
        name: Its name.
        body: The body that it is on, as the file calls it.
        position_m: (3,) where, in the body's frame, m.
        fixed: Whether OpenSim leaves it there when it fits a model to a person; None where the file does not say.
    """

    name: str
    body: str
    position_m: Array
    fixed: bool | None


@dataclass(frozen=True)
class OsimModel:
    """A model, or a set of markers without one.

    Attributes:
        name: Its name.
        joints: Its joints in the order of the file; empty for a marker set.
        markers: Its markers.
        damaged: The reason by name of each marker that could not be read.
    """

    name: str
    joints: tuple[OsimJoint, ...]
    markers: tuple[OsimMarker, ...]
    damaged: dict[str, str]


def read_osim(path: str | Path) -> OsimModel:
    """Reads a model, or a marker set that stands in a file of its own.

    Raises:
        FileFormatError: The file is missing, not one of OpenSim, or without markers.
    """
    path = Path(path)
    root = read_loose_xml(path, _NEVER_NESTED)
    _drop(root, "defaults")
    model = next(root.every("Model"), None)
    found = model or next(root.every("MarkerSet", "OpenSimDocument"), None)
    if found is None:
        raise FileFormatError(
            path, "not an OpenSim model or marker set; name an .osim file or a MarkerSet .xml"
        )
    frames = {one.name: one for one in root.every("PhysicalOffsetFrame") if one.name}
    markers: dict[str, OsimMarker] = {}
    damaged: dict[str, str] = {}
    for element in root.every("Marker"):
        _read_marker(element, frames, markers, damaged)
    if not markers:
        faults = "; ".join(f"{name}: {reason}" for name, reason in list(damaged.items())[:3])
        raise FileFormatError(
            path, f"holds no marker that can be read ({faults})" if faults else "holds no marker"
        )
    return OsimModel(found.name or path.stem, tuple(_joints(root)), tuple(markers.values()), damaged)


def _drop(root: Element, tag: str) -> None:
    """Takes away all elements of a name: defaults are patterns of markers and joints, not ones of the model."""
    waiting = [root]
    while waiting:
        one = waiting.pop()
        one.children = [child for child in one.children if child.tag != tag]
        waiting.extend(one.children)


def _read_marker(
    element: Element,
    frames: dict[str, Element],
    markers: dict[str, OsimMarker],
    damaged: dict[str, str],
) -> None:
    """Puts a marker among those that could be read or those that could not."""
    name = " ".join(element.name.split())
    place = _numbers(element.child_text("location"))
    body, offset = _body_frame(element.child_text(*_MARKER_BODIES), frames)
    if not name:
        damaged.setdefault("(no name)", "a marker without a name")
    elif name in markers:
        damaged[f"{name} (again)"] = "the name stands twice; the first is taken"
    elif place is None:
        damaged[name] = "its location is not three finite numbers"
    elif not body:
        damaged[name] = "it names no body"
    else:
        fixed = {"true": True, "1": True, "false": False, "0": False}.get(element.child_text("fixed").lower())
        on_body = offset[:3, :3] @ place + offset[:3, 3]
        markers[name] = OsimMarker(name, body, read_only(on_body), fixed)


def _joints(root: Element) -> list[OsimJoint]:
    found = []
    for body in root.every("Body"):  # up to version 3 a joint stands in its child body
        holder = body.child("Joint")
        joint = holder.children[0] if holder is not None and holder.children else None
        if joint is not None and joint.child_text("parent_body"):
            into = _placed(joint.child_text("location_in_parent"), joint.child_text("orientation_in_parent"))
            own = _placed(joint.child_text("location"), joint.child_text("orientation"))
            found.append(_joint(joint, joint.child_text("parent_body"), body.name, into, own))
    for joint in (one for group in root.every("JointSet") for one in group.every(*_joint_tags(group))):
        frames = {one.name: one for one in joint.every("PhysicalOffsetFrame")}
        parent, into = _body_frame(joint.child_text(*_PARENT_FRAMES), frames)
        child, own = _body_frame(joint.child_text(*_CHILD_FRAMES), frames)
        if parent and child:
            found.append(_joint(joint, parent, child, into, own))
    return found


def _joint_tags(group: Element) -> set[str]:
    return {one.tag for holder in (group, *group.every("objects")) for one in holder.children} - {"objects"}


def _joint(joint: Element, parent: str, child: str, into: Array, own: Array) -> OsimJoint:
    pose = into @ _at_zero(joint) @ np.linalg.inv(own)
    return OsimJoint(parent, child, read_only(pose), read_only(own[:3, 3]))


def _at_zero(joint: Element) -> Array:
    """(4, 4) a joint's own transform with its coordinates at zero: turns about its axes in turn, then a shift."""
    pose = np.eye(4)
    transform = next(joint.every("SpatialTransform"), None)
    axes = {one.name: one for one in transform.every("TransformAxis")} if transform else {}
    for name in (*_ROTATIONS, *_TRANSLATIONS):
        axis = _numbers(axes[name].child_text("axis")) if name in axes else None
        if axis is None or not np.linalg.norm(axis) > 0.0:
            continue
        amount = next(
            (_value_at_zero(one) for one in axes[name].children if one.tag not in _NO_FUNCTION), 0.0
        )
        if name in _ROTATIONS:
            turn = Rotation.from_rotvec(amount * axis / np.linalg.norm(axis)).as_matrix()
            pose[:3, :3] = pose[:3, :3] @ turn
        else:
            pose[:3, 3] += amount * axis
    return pose


_NO_FUNCTION = ("coordinates", "axis")


def _value_at_zero(function: Element, depth: int = 4) -> float:
    """The value of one of OpenSim's functions where its argument is zero; 0 for one that is not known."""
    if depth == 0:
        return 0.0
    inner = [one for one in function.children if one.children or one.tag == "Constant"]
    if function.tag == "function" and inner:
        return _value_at_zero(inner[0], depth - 1)
    if function.tag == "MultiplierFunction":
        scale, value = (
            _list(function.child_text("scale")),
            _value_at_zero(inner[0], depth - 1) if inner else 0.0,
        )
        return (scale[0] if scale else 1.0) * value
    if function.tag == "Constant":
        return (_list(function.child_text("value")) or [0.0])[0]
    if function.tag in ("LinearFunction", "PolynomialFunction"):  # highest power first
        return (_list(function.child_text("coefficients")) or [0.0])[-1]
    x, y = _list(function.child_text("x")), _list(function.child_text("y"))
    if len(x) < 2 or len(x) != len(y) or not np.all(np.diff(x) > 0.0):
        return 0.0
    if function.tag == "PiecewiseLinearFunction":
        return float(np.interp(0.0, x, y))
    return float(CubicSpline(x, y, bc_type="natural")(np.clip(0.0, x[0], x[-1])))


def _body_frame(path: str, frames: dict[str, Element], depth: int = 4) -> tuple[str, Array]:
    """The body that a path leads to through frames fixed to it, and the (4, 4) last frame in that body."""
    name = path.strip().rstrip("/").rpartition("/")[2]
    frame = frames.get(name)
    if frame is None or depth == 0:
        return name, np.eye(4)
    own = _placed(frame.child_text("translation"), frame.child_text("orientation"))
    body, beyond = _body_frame(frame.child_text(*_OFFSET_PARENTS), frames, depth - 1)
    return body, beyond @ own


def _placed(translation: str, orientation: str) -> Array:
    """(4, 4) a frame from its origin, m, and its turns about its own x, y, z in turn, rad."""
    pose = np.eye(4)
    shift, turns = _numbers(translation), _numbers(orientation)
    if shift is not None:
        pose[:3, 3] = shift
    if turns is not None:
        pose[:3, :3] = Rotation.from_euler("XYZ", turns).as_matrix()
    return pose


def _numbers(text: str) -> Array | None:
    """(3,) finite numbers, None where the text is not three of them."""
    found = _list(text)
    return np.array(found) if len(found) == 3 else None


def _list(text: str) -> list[float]:
    """Numbers of a body's size; empty where any word is something else."""
    try:
        found = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        return []
    return found if all(abs(number) <= LARGEST for number in found) else []
