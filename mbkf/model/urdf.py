"""The body as URDF, for robotics tools: three hinges in place of every spherical joint.

The root link (the pelvis) floats: URDF has no free joint, so the reader adds one. A spherical joint becomes
three revolute joints in the order of the body file, named after the clinical coordinates
(hip_flexion_r, hip_adduction_r, hip_rotation_r …) and turning in their positive sense: the joint positions of
a posture are :meth:`mbkf.model.clinical.ClinicalAngles.angles`. The links between the hinges weigh
:data:`LINK_MASS_KG` each: PyBullet counts 1 kg for a link without a mass, and MuJoCo refuses it. URDF holds no gravity,
and demands limits; the ones written do not bind (±2π). Markers are links of mass 0, fixed to their segments. Visuals
are boxes, cylinders and spheres; there is no collision geometry.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.conventions import Array
from mbkf.io.subject import SubjectMarker
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.body_shapes import (
    COLOURS,
    MARKER_COLOUR,
    MARKER_RADIUS_M,
    Shape,
    segment_shapes,
    side_of,
)
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.clinical_table import Angle
from mbkf.model.primitive_shapes import Primitive, primitives
from mbkf.model.skeleton import joint_origin

if TYPE_CHECKING:
    import yourdfpy

MARKER_PREFIX = "marker_"
"""Link names of markers: this prefix and the marker's name."""

LINK_MASS_KG, LINK_INERTIA_KG_M2 = 1e-14, 1e-14
"""Mass and moments of inertia of a link between two hinges; MuJoCo's least are 1e-15."""

MUJOCO = {"discardvisual": "false", "fusestatic": "false"}
"""MuJoCo's settings for the file: it keeps the visuals, and the root as a body of its own, which can be set free."""


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
    shapes = segment_shapes(model)
    for entry in ClinicalAngles(model).joints:
        links.append(_link(model, entry.distal, shapes[entry.distal]))
        if entry.proximal != "world":
            between, hinges = _hinges(
                entry.proximal, entry.distal, entry.angles, joint_origin(model, entry.distal)
            )
            links += between
            joints += hinges
    for marker in markers:
        model.joint(marker.segment)
        name = MARKER_PREFIX + marker.name
        links.append(_marker_link(name))
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
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", MUJOCO)
    ET.indent(root)
    return (
        f'<?xml version="1.0" encoding="utf-8"?>\n<!-- {MARK} -->\n'
        + ET.tostring(root, encoding="unicode")
        + "\n"
    )


def _link(model: Body, segment: str, shapes: Iterable[Shape]) -> yourdfpy.Link:
    import yourdfpy

    own = model.pin_model.inertias[model.joint(segment).joint_id]
    side = side_of(segment)
    paint = _material(side or "middle", COLOURS[side])
    visuals = [_visual(solid, paint) for shape in shapes for solid in primitives(shape)]
    return yourdfpy.Link(name=segment, inertial=_inertial(own.mass, own.lever, own.inertia), visuals=visuals)


def _between(name: str) -> yourdfpy.Link:
    """A link between two hinges."""
    import yourdfpy

    return yourdfpy.Link(
        name=name, inertial=_inertial(LINK_MASS_KG, np.zeros(3), LINK_INERTIA_KG_M2 * np.eye(3))
    )


def _marker_link(name: str) -> yourdfpy.Link:
    import yourdfpy

    ball = Primitive("sphere", (MARKER_RADIUS_M,), np.eye(4))
    return yourdfpy.Link(
        name=name,
        inertial=_inertial(0.0, np.zeros(3), np.zeros((3, 3))),
        visuals=[_visual(ball, _material("marker", MARKER_COLOUR))],
    )


def _inertial(mass_kg: float, com_m: Array, inertia_kg_m2: Array) -> yourdfpy.Inertial:
    import yourdfpy

    return yourdfpy.Inertial(origin=_translation(com_m), mass=float(mass_kg), inertia=inertia_kg_m2)


def _material(name: str, colour: tuple[float, float, float]) -> yourdfpy.Material:
    import yourdfpy

    return yourdfpy.Material(name=name, color=yourdfpy.Color(np.array([*colour, 1.0])))


def _visual(solid: Primitive, paint: yourdfpy.Material) -> yourdfpy.Visual:
    import yourdfpy

    geometry = yourdfpy.Geometry()
    if solid.kind == "box":
        geometry.box = yourdfpy.Box(size=np.array(solid.size_m))
    elif solid.kind == "cylinder":
        geometry.cylinder = yourdfpy.Cylinder(*solid.size_m)
    else:
        geometry.sphere = yourdfpy.Sphere(*solid.size_m)
    return yourdfpy.Visual(origin=solid.placement, geometry=geometry, material=paint)


def _hinges(
    proximal: str, distal: str, angles: Sequence[Angle], origin_m: Array
) -> tuple[list[yourdfpy.Link], list[yourdfpy.Joint]]:
    """Successive hinges from one segment to the next, and the light links between them."""
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
                axis=angle.direction,
            )
        )  # fmt: skip
    return [_between(name) for name in names], joints


def _translation(position_m: Array) -> Array:
    transform = np.eye(4)
    transform[:3, 3] = position_m
    return transform
