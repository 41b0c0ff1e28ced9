"""Bodies as biorbd's model files (.bioMod) describe them: every dof a segment of its own, turning about its x axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array

GRAVITY_M_S2 = 9.80665
WORLD = "ground"


@dataclass(frozen=True)
class Hinges:
    """A joint that turns a child about axes through one point.

    Attributes:
        child, parent: Names of the bodies; the world is :data:`WORLD`.
        coordinates: (n,) names of its coordinates, in the order in which they turn.
        axes: (n, 3) unit axes in the parent's frame at zero.
        point_parent_m: (3,) the point, in the parent's frame.
        point_child_m: (3,) the same in the child's.
        rotation: (3, 3) the child's frame in the parent's at zero.
        free: Names of the coordinates that move the child along the parent's axes before it turns; three or none.
    """

    child: str
    parent: str
    coordinates: tuple[str, ...]
    axes: Array
    point_parent_m: Array
    point_child_m: Array
    rotation: Array
    free: tuple[str, ...] = ()


@dataclass(frozen=True)
class Inertia:
    """A body's mass in kg, its centre of mass (3,) in m, and its inertia (3, 3) about that in kg m²."""

    mass_kg: float
    centre_m: Array
    about_centre: Array


@dataclass(frozen=True)
class Fixed:
    """A marker: its name, its body, and its place (3,) there in m."""

    name: str
    body: str
    place_m: Array


@dataclass(frozen=True)
class BiomodBody:
    """A whole body: a joint for every segment, parents before children; inertia by segment; markers in their order."""

    joints: tuple[Hinges, ...]
    inertias: Mapping[str, Inertia]
    markers: tuple[Fixed, ...]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Coordinates in the order in which biorbd has them."""
        return tuple(name for joint in self.joints for name in (*joint.free, *joint.coordinates))


def biomod(body: BiomodBody) -> str:
    """The file's text."""
    lines = ["version 4", "", f"gravity 0 {-GRAVITY_M_S2} 0", ""]
    for joint in body.joints:
        lines += _segments(joint, body.inertias[joint.child])
    for marker in body.markers:
        lines += [
            f"marker {marker.name}",
            f"    parent {marker.body}",
            f"    position {_row(marker.place_m)}",
            "    technical 1",
            "endmarker",
            "",
        ]
    return "\n".join(lines)


def _segments(joint: Hinges, inertia: Inertia) -> list[str]:
    """A joint's dofs, each with a segment without mass, and its child."""
    lines: list[str] = []
    parent, frame, place = joint.parent, np.eye(3), joint.point_parent_m
    if joint.free:
        lines += _segment(f"{joint.child}_moved", parent, frame, place, ["translations xyz"])
        parent, place = f"{joint.child}_moved", np.zeros(3)
    for name, axis in zip(joint.coordinates, joint.axes, strict=True):
        turned = _with_x_along(axis)
        lines += _segment(name, parent, frame.T @ turned, place, ["rotations x"])
        parent, frame, place = name, turned, np.zeros(3)
    at_child = frame.T @ joint.rotation
    matter = [
        f"mass {inertia.mass_kg:.12g}",
        f"com {_row(inertia.centre_m)}",
        "inertia",
        *(f"    {_row(row)}" for row in inertia.about_centre),
    ]
    return lines + _segment(joint.child, parent, at_child, place - at_child @ joint.point_child_m, matter)


def _segment(name: str, parent: str, rotation: Array, place_m: Array, more: Sequence[str]) -> list[str]:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, place_m
    return [
        f"segment {name}",
        f"    parent {'base' if parent == WORLD else parent}",
        "    RTinMatrix 1",
        "    RT",
        *(f"        {_row(row)}" for row in pose),
        *(f"    {line}" for line in more),
        "endsegment",
        "",
    ]


def _with_x_along(axis: Array) -> Array:
    """(3, 3) a rotation whose first column is the axis."""
    other = np.eye(3)[np.argmin(np.abs(axis))]
    y = np.cross(other, axis)
    y /= np.linalg.norm(y)
    return np.column_stack([axis, y, np.cross(axis, y)])


def _row(values: Array) -> str:
    return " ".join(f"{value:.12g}" for value in values)
