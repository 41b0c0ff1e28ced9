"""Clinical angles, moments and powers as points of a C3D file, named as Vicon's Plug-in Gait names them.

A point has three numbers: x the main angle (flexion), y the one in the frontal plane (adduction), z rotation. Where a
coordinate's sign is not Plug-in Gait's, the angle is turned about, and its moment with it. Powers stand in z alone.
Pelvis, hips, knees and ankles have the signs of Plug-in Gait's angles in laboratories' files; its moments have the
opposite sign, being those that the outside exerts.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import DerivedPoint
from mbkf.io.results import Reconstruction
from mbkf.model.body import Body
from mbkf.model.clinical_table import Angle, ClinicalJoint

STEMS = {"lumbar": "Spine", "neck": "LowerNeck", "head": "UpperNeck", "mtp": "Toe"}
"""Names of joints that do not go by their own; Plug-in Gait's neck is head against trunk, so ours has other names."""

ROOT_SIDES = ("R", "L")
"""The pelvis's angles stand twice: as either side sees them."""

TURNED = {
    ("pelvis_tilt", "R"): "forward lean (anterior tilt)",
    ("pelvis_tilt", "L"): "forward lean (anterior tilt)",
    ("pelvis_list", "R"): "right side up",
    ("pelvis_rotation", "L"): "turned to the right",
    ("subtalar_angle_r", ""): "outer border up (eversion)",
    ("subtalar_angle_l", ""): "outer border up (eversion)",
    ("lumbar_extension", ""): "trunk forward (flexion)",
    ("neck_extension", ""): "neck forward (flexion)",
    ("head_extension", ""): "face down (flexion)",
}
"""Coordinates whose sign is reversed, by the side of the point, and their positive direction."""


@dataclass(frozen=True)
class Component:
    """A coordinate in a point: its name, the sign it is stored with, and its positive direction."""

    coordinate: str
    sign: float
    positive: str


@dataclass(frozen=True)
class JointPoint:
    """A joint in a file of points.

    Attributes:
        stem: Its name there, e.g. "RHip".
        components: x, y and z; None: the joint has no such coordinate.
        root: Whether it is the root, whose moments are residuals.
        distal: The segment that it moves.
    """

    stem: str
    components: tuple[Component | None, Component | None, Component | None]
    root: bool
    distal: str

    @property
    def signs(self) -> str:
        """Positive direction, in words."""
        labelled = zip("XYZ", self.components, strict=True)
        return ", ".join(f"{axis}+ {c.positive or c.coordinate}" for axis, c in labelled if c is not None)

    def values(self, r: Reconstruction, array: str) -> Array:
        """(T, 3) one of a result's arrays over coordinates; 0 for a coordinate that the joint does not have."""
        columns = np.zeros((r.frames, 3))
        signed = not array.endswith("_sd")
        for k, c in enumerate(self.components):
            if c is not None:
                column = getattr(r, array)[:, r.coordinate_names.index(c.coordinate)]
                columns[:, k] = c.sign * column if signed else column
        return columns


def joint_point_names(joint: ClinicalJoint) -> tuple[str, ...]:
    """The stems of a joint's points: one, of the root two."""
    base, side = side_of(joint.name)
    stem = STEMS.get(base) or "".join(word.capitalize() for word in base.split("_"))
    sides = ROOT_SIDES if joint.proximal == "world" else (side,)
    return tuple(f"{one}{stem}" for one in sides)


def side_of(name: str) -> tuple[str, str]:
    """A joint's name without its side, and "R", "L" or ""."""
    sides = {"_r": "R", "_l": "L"}
    return (name[:-2], sides[name[-2:]]) if name[-2:] in sides else (name, "")


def joint_points(joints: tuple[ClinicalJoint, ...]) -> tuple[JointPoint, ...]:
    """The points of a body's joints."""
    found = []
    for joint in joints:
        root = joint.proximal == "world"
        for stem in joint_point_names(joint):
            found.append(JointPoint(stem, _components(joint, stem[0] if root else ""), root, joint.distal))
    return tuple(found)


def _components(
    joint: ClinicalJoint, side: str
) -> tuple[Component | None, Component | None, Component | None]:
    """Main angle, the other one about x or y, rotation."""

    def of(angle: Angle) -> Component:
        turned = TURNED.get((angle.name, side))
        return Component(angle.name, -1.0 if turned else 1.0, turned or angle.positive)

    places: list[Component | None] = [None, None, None]
    rest = []
    for angle in joint.angles:
        if angle.name == joint.main:
            places[0] = of(angle)
        elif angle.axis == "z":
            places[2] = of(angle)
        else:
            rest.append(of(angle))
    for component in rest:
        places[1 if places[1] is None else 2] = component
    return places[0], places[1], places[2]


def derived_from_joints(r: Reconstruction, model: Body) -> Iterator[DerivedPoint]:
    """Angles, moments and powers with standard deviations where these are known.

    Args:
        r: The result.
        model: Its body.

    Yields:
        Points of the kinds "angle" (deg), "moment" (Nm) and "power" (W). A joint's power is that of its torque about
        all axes, whatever axes the angles are read in.
    """
    read = "" if r.angles_read == "model" else f", in {r.angles_read} axes"
    for joint in joint_points(model.description.clinical_joints):
        description = f"{joint.signs}{f', {r.direction} frame' if joint.root else ''}{read}"
        degrees = np.rad2deg(joint.values(r, "angles"))
        yield DerivedPoint(f"{joint.stem}Angles", "angle", degrees, "deg", description)
        sd = np.rad2deg(joint.values(r, "angles_sd"))
        yield DerivedPoint(f"{joint.stem}AnglesSD", "angle", sd, "deg", "standard deviations")
        if joint.root:
            continue
        moment, sd = joint.values(r, "moments"), joint.values(r, "moments_sd")
        yield DerivedPoint(f"{joint.stem}Moment", "moment", moment, "Nm", f"internal: {joint.signs}")
        yield DerivedPoint(f"{joint.stem}MomentSD", "moment", sd, "Nm", "standard deviations")
        dofs = model.joints[joint.distal].v
        power = (r.tau[:, dofs] * r.v[:, dofs]).sum(axis=1)
        in_z = np.column_stack([np.zeros((r.frames, 2)), power])
        yield DerivedPoint(f"{joint.stem}Power", "power", in_z, "W", "Z+ generated, all axes together")
