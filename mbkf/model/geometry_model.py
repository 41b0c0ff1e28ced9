"""The body's shapes as a geometry model of Pinocchio, for its visualisers."""

from __future__ import annotations

from collections.abc import Sequence

import coal
import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.io.subject import SubjectMarker
from mbkf.model.body import Body
from mbkf.model.body_shapes import COLOURS, MARKER_COLOUR, MARKER_RADIUS_M, segment_shapes, side_of
from mbkf.model.shape_meshes import Mesh, joined, shape_mesh

MARKER_PREFIX = "marker_"
"""Names of markers' geometries: this prefix and the marker's name."""


def geometry_model(model: Body, markers: Sequence[SubjectMarker] = ()) -> pin.GeometryModel:
    """One surface for each segment, named after it, and one sphere for each marker.

    Args:
        model: The scaled body.
        markers: Markers to fix to its segments.

    Raises:
        UnknownName: A marker names a segment that the body does not have.
    """
    made = pin.GeometryModel()
    for name, shapes in segment_shapes(model).items():
        surface = _surface(joined(shape_mesh(shape) for shape in shapes))
        _add(made, name, model.joint(name).joint_id, np.zeros(3), surface, COLOURS[side_of(name)])
    for marker in markers:
        joint = model.joint(marker.segment).joint_id
        name, sphere = MARKER_PREFIX + marker.name, coal.Sphere(MARKER_RADIUS_M)
        _add(made, name, joint, marker.position_m, sphere, MARKER_COLOUR)
    return made


def _add(
    made: pin.GeometryModel,
    name: str,
    joint: int,
    position_m: Array,
    geometry: coal.CollisionGeometry,
    colour: tuple[float, float, float],
) -> None:
    placement = pin.SE3(np.eye(3), np.asarray(position_m, dtype=float))
    one = pin.GeometryObject(name, joint, placement, geometry)
    one.meshColor = np.array([*colour, 1.0])
    made.addGeometryObject(one)


def _surface(mesh: Mesh) -> coal.BVHModelOBBRSS:
    surface = coal.BVHModelOBBRSS()
    surface.beginModel(len(mesh.triangles), len(mesh.vertices_m))
    surface.addVertices(np.ascontiguousarray(mesh.vertices_m))
    surface.addTriangles(np.ascontiguousarray(mesh.triangles))
    surface.endModel()
    return surface
