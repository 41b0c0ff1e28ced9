"""Segments, landmarks and joint angles of a body from the tree of a URDF file.

Segments are parallel to the root in the neutral posture, which is that of all joints at zero; a segment's origin is its
joint. Links that are fixed to another one are part of its segment, and landmarks of it. Two or three hinges at one
point with light links (:data:`LIGHT_KG`) between them are one universal or spherical joint, whose angles are the
hinges' positions, in their order.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array, TomlTable
from mbkf.model.urdf_tree import HINGES, UrdfJoint, UrdfTree

LIGHT_KG = 1e-3
"""Greatest mass of a link between two hinges of one joint."""

SAME_PLACE_M, SAME_AXIS_RAD = 1e-9, 1e-4
"""Distance of two hinges at one point, and turn of an axis from x, y or z; right angles are often written as 1.5708."""

ROUNDING = 1e-13
"""Share of the largest moment of inertia below which products are rounding."""

KIND_BY_HINGES = {1: "hinge", 2: "universal", 3: "spherical"}

FREE_ORDER, BALL_ORDER = "zyx", "yxz"
"""Axes of the angles of the root (yaw, pitch, roll) and of a joint of the type spherical."""

_TURNS = {"x": "roll", "y": "pitch", "z": "yaw"}


@dataclass
class UrdfSegments:
    """Entries of a body's file.

    Attributes:
        segments: Tables ``[[segment]]`` without scale factors and spreads, which a URDF file does not hold.
        landmarks: Tables ``[[landmark]]``.
        clinical_joints: Tables ``[[clinical_joint]]``.
    """

    segments: list[TomlTable] = field(default_factory=list)
    landmarks: list[TomlTable] = field(default_factory=list)
    clinical_joints: list[TomlTable] = field(default_factory=list)


@dataclass
class _Planned:
    """A segment before its links are known.

    Attributes:
        link: The link whose joint carries it.
        turn: (3, 3) that link's axes in the segment's.
        entry: Its table ``[[segment]]`` so far.
        light: Inertias of the links within its joint, in its frame.
        clinical: Its table ``[[clinical_joint]]``.
    """

    link: str
    turn: Array
    entry: TomlTable
    light: list[pin.Inertia]
    clinical: TomlTable


def urdf_segments(tree: UrdfTree, names: Mapping[str, str]) -> UrdfSegments:
    """The entries of a tree.

    Args:
        tree: The links and joints.
        names: Segment name by link, where they differ.

    Raises:
        ValueError: A joint or an inertia cannot be one of a body.
    """
    found = UrdfSegments()
    waiting = [_root(tree, names)]
    while waiting:
        one = waiting.pop()
        onward = _grow(tree, one, names, found)
        found.clinical_joints.append(one.clinical)
        waiting += [_planned(tree, joint, at, one.entry["name"], names) for joint, at in reversed(onward)]
    return found


def _root(tree: UrdfTree, names: Mapping[str, str]) -> _Planned:
    """The root; a link without mass that it alone hangs on, often named world, gives its axes."""
    link, turn, below = tree.root, np.eye(3), tree.joints[tree.root]
    if tree.inertias[link].mass == 0.0 and len(below) == 1 and below[0].kind in ("fixed", "floating"):
        link, turn = below[0].child, below[0].placement.rotation
    name = names.get(link, link)
    entry = {"name": name, "parent": "world", "joint": "free", "origin_m": [0.0, 0.0, 0.0]}
    return _Planned(link, turn, entry, [], _free(name))


def _grow(
    tree: UrdfTree, planned: _Planned, names: Mapping[str, str], found: UrdfSegments
) -> list[tuple[UrdfJoint, pin.SE3]]:
    """Adds a segment and its landmarks; returns the joints that it carries, with their places in its frame."""
    whole, onward = pin.Inertia.Zero(), []
    waiting = [(planned.link, pin.SE3(planned.turn, np.zeros(3)))]
    while waiting:
        link, place = waiting.pop(0)
        whole += tree.inertias[link].se3Action(place)
        for joint in tree.joints[link]:
            at = place * joint.placement
            if joint.kind == "fixed":
                landmark = names.get(joint.child, joint.child)
                found.landmarks.append(_landmark(landmark, planned.entry["name"], at))
                waiting.append((joint.child, at))
            else:
                onward.append((joint, at))
    if whole.mass <= 0.0:
        raise ValueError(
            f"link {planned.link} has no mass; a link that moves needs <inertial>, unless it is fixed to another one "
            "or stands between hinges at one point"
        )
    for part in planned.light:
        whole += part
    found.segments.append({**planned.entry, **_inertial(whole)})
    return onward


def _planned(
    tree: UrdfTree, first: UrdfJoint, place: pin.SE3, parent: str, names: Mapping[str, str]
) -> _Planned:
    """The segment after a joint."""
    if first.kind == "floating":
        raise ValueError(
            f"joint {first.name} is floating; only the root of a body floats: give it another type"
        )
    chain = _chain(tree, first)
    turn, axes = place.rotation, ""
    signs: list[int] = []
    light: list[pin.Inertia] = []
    for k, joint in enumerate(chain):
        turn = turn @ joint.placement.rotation if k else turn
        if joint.kind in HINGES:
            letter, sign = _axis(joint, turn, len(chain))
            axes, signs = axes + letter, [*signs, sign]
        if joint is not chain[-1]:
            light.append(tree.inertias[joint.child].se3Action(pin.SE3(turn, np.zeros(3))))
    if len(set(axes)) < len(axes):
        raise ValueError(
            f"the joints {', '.join(one.name for one in chain)} meet at one point, and turn about {', '.join(axes)} in "
            "the root's axes; those of a joint are different ones of x, y and z: set one joint apart, or fix it"
        )
    last = chain[-1].child
    name = names.get(last, last)
    entry: TomlTable = {"name": name, "parent": parent, "origin_m": place.translation.tolist()}
    if first.kind == "spherical":
        return _Planned(last, turn, {**entry, "joint": "spherical"}, light, _ball(first, parent, name))
    entry |= {"joint": KIND_BY_HINGES[len(chain)], "limits_deg": _limits(chain, axes, signs)}
    entry |= {"axes": axes} if len(chain) < 3 else {}
    if len(chain) == 1 and not _is_along(axis := signs[0] * turn @ first.axis):
        entry["axis"] = (axis / np.linalg.norm(axis)).tolist()
    return _Planned(last, turn, entry, light, _hinged(chain, axes, signs, parent, name))


def _chain(tree: UrdfTree, first: UrdfJoint) -> list[UrdfJoint]:
    """A hinge and those after it at the same point, with light links between them; three at most."""
    chain = [first]
    while len(chain) < 3 and chain[-1].kind in HINGES:
        link = chain[-1].child
        below = tree.joints[link]
        if len(below) != 1 or below[0].kind not in HINGES or tree.inertias[link].mass > LIGHT_KG:
            break
        if np.linalg.norm(below[0].placement.translation) > SAME_PLACE_M:
            break
        chain.append(below[0])
    return chain


def _axis(joint: UrdfJoint, turn: Array, hinges: int) -> tuple[str, int]:
    """The axis among those of the root that a hinge's is nearest to, and its sense.

    Raises:
        ValueError: Several hinges meet at its point, and it is oblique.
    """
    axis = turn @ joint.axis
    largest = int(np.argmax(np.abs(axis)))
    if hinges > 1 and not _is_along(axis):
        raise ValueError(
            f"joint {joint.name} turns about {np.round(axis, 4).tolist()} in the axes of the root; with all joints at "
            "zero several hinges at one point turn about the root's x, y and z: turn the posture at zero, or fix the "
            "joint"
        )
    return "xyz"[largest], int(np.sign(axis[largest]))


def _is_along(axis: Array) -> bool:
    """True for an axis of the root."""
    return bool(np.linalg.norm(np.sort(np.abs(axis))[:2]) <= SAME_AXIS_RAD)


def _limits(chain: list[UrdfJoint], axes: str, signs: list[int]) -> list[list[float]]:
    """Least and greatest rotation about each axis, degrees, in the order of the segment's degrees of freedom."""
    by_axis = {
        axis: np.rad2deg(np.sort(sign * joint.limits_rad))
        for joint, axis, sign in zip(chain, axes, signs, strict=True)
    }
    order = sorted(axes) if len(chain) == 3 else axes
    return [_without_whole_turns(by_axis[axis]) for axis in order]


def _without_whole_turns(limits: Array) -> list[float]:
    return [-np.inf, np.inf] if limits[1] - limits[0] >= 360.0 else [float(one) for one in limits]


def _inertial(whole: pin.Inertia) -> TomlTable:
    matrix = whole.inertia
    products = matrix[[0, 0, 1], [1, 2, 2]]
    products = np.where(np.abs(products) > ROUNDING * np.abs(matrix).max(), products, 0.0)
    found = {
        "mass_kg": float(whole.mass), "com_m": whole.lever.tolist(), "inertia_kg_m2": np.diag(matrix).tolist()
    }  # fmt: skip
    return {**found, "products_kg_m2": products.tolist()} if products.any() else found


def _landmark(name: str, segment: str, at: pin.SE3) -> TomlTable:
    return {"name": name, "segment": segment, "position_m": at.translation.tolist(), "mirror": False}


def _free(name: str) -> TomlTable:
    angles = [{"name": f"{name}_{_TURNS[axis]}", "axis": axis, "sign": 1} for axis in FREE_ORDER]
    moves = [{"name": f"{name}_{axis}", "axis": axis, "sign": 1} for axis in "xyz"]
    joint = {
        "name": name,
        "proximal": "world",
        "distal": name,
        "order": FREE_ORDER,
        "main": angles[1]["name"],
    }
    return {**joint, "angle": angles, "translation": moves}


def _ball(joint: UrdfJoint, proximal: str, distal: str) -> TomlTable:
    angles = [{"name": f"{joint.name}_{axis}", "axis": axis, "sign": 1} for axis in BALL_ORDER]
    names = {"name": joint.name, "proximal": proximal, "distal": distal}
    return {**names, "order": BALL_ORDER, "main": angles[0]["name"], "angle": angles}


def _hinged(chain: list[UrdfJoint], axes: str, signs: list[int], proximal: str, distal: str) -> TomlTable:
    angles = [
        {"name": joint.name, "axis": axis, "sign": sign}
        for joint, axis, sign in zip(chain, axes, signs, strict=True)
    ]
    names = {"name": distal, "proximal": proximal, "distal": distal}
    return {**names, "order": axes, "main": chain[0].name, "angle": angles}
