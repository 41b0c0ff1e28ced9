"""A URDF file as a tree of links and joints, read by yourdfpy and checked."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.errors import FileFormatError
from mbkf.io.files_read import SETTINGS_BYTES, read_bytes

if TYPE_CHECKING:
    import yourdfpy

HINGES = ("revolute", "continuous")
KINDS = (*HINGES, "spherical", "fixed", "floating")
"""Kinds of joints that a body may have; floating at its root alone."""

_NEEDED = {"link": ("name",), "joint": ("name", "type")}


@dataclass(frozen=True)
class UrdfJoint:
    """A joint.

    Attributes:
        name: Its name.
        kind: One of :data:`KINDS`.
        parent, child: The links that it joins.
        placement: The child's frame in the parent's at position zero.
        axis: (3,) unit vector that a hinge turns about, in the child's frame.
        limits_rad: (2,) least and greatest position; ±inf where the file gives neither.
    """

    name: str
    kind: str
    parent: str
    child: str
    placement: pin.SE3
    axis: Array
    limits_rad: Array


@dataclass(frozen=True)
class UrdfTree:
    """A tree of links.

    Attributes:
        name: Name of the robot.
        root: The link that is the child of no joint.
        inertias: Inertia of each link in its frame, by name; zero for a link without <inertial>.
        joints: The joints by their parent link, in the file's order.
    """

    name: str
    root: str
    inertias: dict[str, pin.Inertia]
    joints: dict[str, tuple[UrdfJoint, ...]]


def read_urdf_tree(path: Path) -> UrdfTree:
    """The tree of a URDF file.

    Raises:
        FileFormatError: The file is missing, not a URDF, not a tree, or has a joint or number that no body has.
        OSError: The file cannot be read.
    """
    robot = _robot(path)
    try:
        inertias = {link.name: _inertia(link) for link in robot.links}
        joints = [_joint(one) for one in robot.joints]
    except ValueError as error:
        raise FileFormatError(path, str(error)) from error
    for fault in _faults(robot, inertias, joints):
        raise FileFormatError(path, fault)
    children = {joint.child for joint in joints}
    (root,) = (name for name in inertias if name not in children)
    below = {name: tuple(one for one in joints if one.parent == name) for name in inertias}
    reached, waiting = {root}, [root]
    while waiting:
        onward = [joint.child for joint in below[waiting.pop()]]
        reached.update(onward)
        waiting += onward
    if apart := [name for name in inertias if name not in reached]:
        raise FileFormatError(path, f"the links {', '.join(apart)} form a closed loop; a body is a tree")
    return UrdfTree(robot.name, root, inertias, below)


def _robot(path: Path) -> yourdfpy.Robot:
    """The file's links and joints as yourdfpy reads them, without visuals and collision shapes."""
    import yourdfpy

    content = read_bytes(path, SETTINGS_BYTES, "name a URDF file")
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise FileFormatError(path, "a URDF file has no document type; delete its <!DOCTYPE …>")
    try:
        element = ET.fromstring(content)
    except (ET.ParseError, LookupError, ValueError) as error:
        raise FileFormatError(path, f"not XML ({error}); a URDF file is XML with a root <robot>") from error
    for fault in _missing(element):
        raise FileFormatError(path, fault)
    for link in element.findall("link"):
        for drawn in (*link.findall("visual"), *link.findall("collision")):
            link.remove(drawn)
    plain = io.BytesIO(ET.tostring(element))
    try:
        return yourdfpy.URDF.load(plain, build_scene_graph=False, load_meshes=False).robot
    except (AttributeError, LookupError, SyntaxError, TypeError, ValueError) as error:
        raise FileFormatError(path, f"not a valid URDF: {error}") from error


def _missing(robot: ET.Element) -> Iterator[str]:
    """Faults of the elements' attributes that yourdfpy would state as errors of Python."""
    if robot.tag != "robot":
        yield f"not a URDF: its root is <{robot.tag}>, not <robot>"
    if any("xacro" in one.tag for one in robot.iter()):
        yield "holds macros of xacro; expand it first: xacro FILE.xacro > FILE.urdf"
    if not robot.get("name"):
        yield "<robot> lacks its name"
    for tag, keys in _NEEDED.items():
        for one in robot.findall(tag):
            yield from (
                f"a <{tag}> ({one.get('name', 'without a name')}) lacks its {k}"
                for k in keys
                if not one.get(k)
            )
    for one in robot.findall("joint"):
        for end in ("parent", "child"):
            found = one.find(end)
            if found is None or not found.get("link"):
                yield f'joint {one.get("name")} lacks <{end} link="…"/>'
        if one.find("mimic") is not None:
            yield f"joint {one.get('name')} mimics another one; a body has no coupled joints: delete <mimic>, or fix it"


def _inertia(link: yourdfpy.Link) -> pin.Inertia:
    stated = link.inertial
    if stated is None:
        return pin.Inertia.Zero()
    mass = 0.0 if stated.mass is None else float(stated.mass)
    matrix = np.zeros((3, 3)) if stated.inertia is None else np.array(stated.inertia, dtype=float)
    place = _placement(stated.origin)
    if not (np.isfinite(mass) and np.isfinite(matrix).all() and np.isfinite(place.homogeneous).all()):
        raise ValueError(f"link {link.name}: its <inertial> holds a number that is not finite; correct it")
    if mass < 0.0:
        raise ValueError(f"link {link.name}: its mass is {mass:g} kg; a mass is positive")
    return pin.Inertia(mass, np.zeros(3), matrix).se3Action(place)


def _joint(given: yourdfpy.Joint) -> UrdfJoint:
    axis, limit = np.array(given.axis, dtype=float), given.limit
    place = _placement(given.origin)
    if axis.shape != (3,) or not (np.isfinite(axis).all() and np.isfinite(place.homogeneous).all()):
        raise ValueError(f"joint {given.name}: its <origin> and <axis> need three finite numbers each")
    if given.type in HINGES and not axis.any():
        raise ValueError(f"joint {given.name}: its axis is 0 0 0; give the direction that it turns about")
    limits = np.array([-np.inf, np.inf])
    ends = () if given.type != "revolute" or limit is None else (limit.lower, limit.upper)
    if any(end is not None for end in ends):  # one that is left out is 0 in URDF
        limits = np.array([end or 0.0 for end in ends])
        if not limits[0] < limits[1]:
            raise ValueError(
                f"joint {given.name}: its lower limit {limits[0]:g} must be below its upper {limits[1]:g}"
            )
    unit = axis / (np.linalg.norm(axis) or 1.0)
    return UrdfJoint(given.name, given.type, given.parent, given.child, place, unit, limits)


def _placement(transform: Array | None) -> pin.SE3:
    return pin.SE3.Identity() if transform is None else pin.SE3(np.array(transform, dtype=float))


def _faults(
    robot: yourdfpy.Robot, inertias: dict[str, pin.Inertia], joints: list[UrdfJoint]
) -> Iterator[str]:
    """Faults of the joints, and of links that hang on no or on several joints."""
    if not inertias:
        yield "it holds 0 links; a body needs at least one <link>"
    for kind, names in (
        ("links", [one.name for one in robot.links]),
        ("joints", [one.name for one in joints]),
    ):
        yield from (
            f"two {kind} are named {name}; give each a name of its own"
            for name in sorted(set(names))
            if names.count(name) > 1
        )
    for joint in joints:
        if joint.kind not in KINDS:
            yield f"joint {joint.name} is {joint.kind}; a body's joints are {', '.join(KINDS)}: replace or fix it"
        for link in (joint.parent, joint.child):
            if link not in inertias:
                yield f"joint {joint.name} names the link {link}, which does not exist; add it, or correct its name"
    children = [joint.child for joint in joints]
    for name in inertias:
        if children.count(name) > 1:
            by = ", ".join(joint.name for joint in joints if joint.child == name)
            yield f"link {name} is the child of the joints {by}: a closed loop; a body is a tree"
    roots = [name for name in inertias if name not in children]
    if len(roots) > 1:
        yield f"it has {len(roots)} roots ({', '.join(roots)}); a body is one tree: join them"
    if not roots:
        yield f"its joints form a closed loop ({', '.join(inertias)}); a body is a tree"
