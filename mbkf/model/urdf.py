"""The body as URDF, for robotics tools: three hinges in place of every spherical joint.

The root link (the pelvis) floats: URDF has no free joint, so the reader adds one. A spherical joint becomes
three revolute joints in the order of the body file, named after the clinical coordinates
(hip_flexion_r, hip_adduction_r, hip_rotation_r …) and turning in their positive sense: the joint positions of
a posture are :meth:`mbkf.model.clinical.ClinicalAngles.angles`. The links between the hinges have no mass.
URDF holds no gravity, and demands limits; the ones written do not bind (±2π). Markers are massless links,
fixed to their segments.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.conventions import Array
from mbkf.io.subject import SubjectMarker
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.clinical import AXES, ClinicalAngles
from mbkf.model.clinical_table import Angle
from mbkf.model.skeleton import joint_origin

if TYPE_CHECKING:
    import yourdfpy

MARKER_PREFIX = "marker_"
"""Link names of markers: this prefix and the marker's name."""


def to_urdf(model: Body, markers: Sequence[SubjectMarker] = ()) -> str:
    """A body as the text of a URDF file.

    Args:
        model: The scaled body.
        markers: Markers to fix to its segments.

    Returns:
        XML; lengths in m, masses in kg.

    Raises:
        UnknownName: A marker names a segment the body does not have.
    """
    import yourdfpy

    links, joints = [], []
    for entry in ClinicalAngles(model).joints:
        links.append(_link(model, entry.distal))
        if entry.proximal != "world":
            between, hinges = _hinges(
                entry.proximal, entry.distal, entry.angles, joint_origin(model, entry.distal)
            )
            links += between
            joints += hinges
    for marker in markers:
        model.joint(marker.segment)
        name = MARKER_PREFIX + marker.name
        links.append(yourdfpy.Link(name=name))
        joints.append(
            yourdfpy.Joint(
                name=f"{name}_fixed",
                type="fixed",
                parent=marker.segment,
                child=name,
                origin=_translation(marker.position_m),
            )
        )
    robot = yourdfpy.Robot(name=model.description.name, links=links, joints=joints)
    urdf = yourdfpy.URDF(robot=robot, build_scene_graph=False, load_meshes=False)
    root = ET.fromstring(urdf.write_xml_string())
    ET.indent(root)
    return (
        f'<?xml version="1.0" encoding="utf-8"?>\n<!-- {MARK} -->\n'
        + ET.tostring(root, encoding="unicode")
        + "\n"
    )


def _link(model: Body, segment: str) -> yourdfpy.Link:
    import yourdfpy

    inertia = model.pin_model.inertias[model.joint(segment).joint_id]
    inertial = yourdfpy.Inertial(
        origin=_translation(inertia.lever), mass=float(inertia.mass), inertia=inertia.inertia
    )
    return yourdfpy.Link(name=segment, inertial=inertial)


def _hinges(
    proximal: str, distal: str, angles: Sequence[Angle], origin_m: Array
) -> tuple[list[yourdfpy.Link], list[yourdfpy.Joint]]:
    """Successive hinges from one segment to the next, and the massless links between them."""
    import yourdfpy

    names = [f"{distal}_after_{angle.name}" for angle in angles[:-1]]
    limit = yourdfpy.Limit(lower=-2 * np.pi, upper=2 * np.pi, effort=1e4, velocity=1e3)
    joints = []
    for i, angle in enumerate(angles):
        joints.append(
            yourdfpy.Joint(
                name=angle.name, type="revolute", limit=limit,
                parent=names[i - 1] if i else proximal, child=names[i] if i < len(names) else distal,
                origin=_translation(origin_m if i == 0 else np.zeros(3)),
                axis=angle.sign * np.eye(3)[AXES[angle.axis]] + 0.0,
            )
        )  # fmt: skip
    return [yourdfpy.Link(name=name) for name in names], joints


def _translation(position_m: Array) -> Array:
    transform = np.eye(4)
    transform[:3, 3] = position_m
    return transform
