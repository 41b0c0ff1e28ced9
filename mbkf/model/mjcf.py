"""The body as MJCF, for MuJoCo, with its native joints.

A free joint carries the pelvis; spherical joints are balls, hinges are hinges, a universal joint (the neck)
is two hinges. Ball and free joints are named after their segments, hinges after their dof.
MuJoCo writes quaternions (w, x, y, z) and gives the free joint's linear velocity in world axes, mbkf in the
pelvis's; all other components of q and v are the same, in the same order. Markers are sites. Bodies have explicit
inertias; the capsules are for drawing only, without mass or contact. Joints have no limits, and the body floats freely
in standard gravity.
"""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.subject import SubjectMarker
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.description import Segment
from mbkf.model.skeleton import joint_origin

_CAPSULE_RADIUS_M = 0.025
_SITE_RADIUS_M = 0.007
_LEAST_LENGTH_M = 1e-3


def to_mjcf(model: Body, markers: Sequence[SubjectMarker] = ()) -> str:
    """A body as the text of an MJCF file.

    Args:
        model: The scaled body.
        markers: Markers to fix to its segments as sites.

    Returns:
        XML; m, kg, rad.

    Raises:
        UnknownName: A marker names a segment the body does not have.
    """
    root = ET.Element("mujoco", model=model.description.name)
    ET.SubElement(root, "compiler", angle="radian", inertiafromgeom="false", autolimits="true")
    ET.SubElement(root, "option", gravity=_numbers([0.0, 0.0, -GRAVITY_M_S2]))
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "light", pos="0 0 4", dir="0 0 -1", directional="true")
    bodies = {"world": world}
    for segment in model.description.segments:
        body = ET.SubElement(
            bodies[segment.parent], "body", name=segment.name, pos=_numbers(joint_origin(model, segment.name))
        )
        bodies[segment.name] = body
        _add_joints(body, segment)
        inertia = model.pin_model.inertias[model.joint(segment.name).joint_id]
        ET.SubElement(
            body,
            "inertial",
            _moments(inertia.inertia),
            pos=_numbers(inertia.lever),
            mass=_number(inertia.mass),
        )
        _add_capsules(body, model, segment.name)
    for marker in markers:
        model.joint(marker.segment)
        ET.SubElement(
            bodies[marker.segment],
            "site",
            name=marker.name,
            pos=_numbers(marker.position_m),
            size=_number(_SITE_RADIUS_M),
        )
    ET.indent(root)
    return (
        f'<?xml version="1.0" encoding="utf-8"?>\n<!-- {MARK} -->\n'
        + ET.tostring(root, encoding="unicode")
        + "\n"
    )


def _moments(inertia: Array) -> dict[str, str]:
    """The moments of inertia, with the products where the axes are not principal ones."""
    products = inertia[[0, 0, 1], [1, 2, 2]]
    if not products.any():
        return {"diaginertia": _numbers(np.diag(inertia))}
    return {"fullinertia": _numbers([*np.diag(inertia), *products])}


def _add_joints(body: ET.Element, segment: Segment) -> None:
    if segment.joint == "free":
        ET.SubElement(body, "freejoint", name=segment.name)
    elif segment.joint == "spherical":
        ET.SubElement(body, "joint", name=segment.name, type="ball")
    directions = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    if segment.axis is not None:
        directions[segment.axes] = _numbers(segment.axis)
    for axis in segment.axes:
        ET.SubElement(body, "joint", name=f"{segment.name}_{axis}", type="hinge", axis=directions[axis])


def _add_capsules(body: ET.Element, model: Body, segment: str) -> None:
    """Capsules from the segment's origin to the joints it carries, or to twice its centre of mass."""
    ends = [joint_origin(model, s.name) for s in model.description.segments if s.parent == segment]
    ends = ends or [2.0 * model.pin_model.inertias[model.joint(segment).joint_id].lever]
    for end in ends:
        if np.linalg.norm(end) > _LEAST_LENGTH_M:
            ET.SubElement(
                body,
                "geom",
                type="capsule",
                fromto=f"0 0 0 {_numbers(end)}",
                mass="0",
                contype="0",
                size=_number(_CAPSULE_RADIUS_M),
                conaffinity="0",
                rgba="0.8 0.7 0.6 0.5",
            )


def _number(value: float) -> str:
    return repr(float(value))


def _numbers(values: Sequence[float] | Array) -> str:
    return " ".join(_number(value) for value in values)
