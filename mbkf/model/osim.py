"""The body as a model of OpenSim 4: a CustomJoint for every joint, with the clinical angles as coordinates.

OpenSim's axes are x forward, y up, z right, in the world and in every segment: p_osim = Wᵀ p and I_osim = Wᵀ I W with W
of :func:`mbkf.io.axes.rotation_to_world`. A joint turns about the axes of its clinical angles in their order and
positive sense, each about the axis that the ones before have turned: R = R₁(θ₁ − z₁) R₂(θ₂ − z₂) R₃(θ₃ − z₃) with z the
value of OpenSim's coordinate where ours is 0 (90° for pro_sup, 0 for most). The root moves along the ground's
axes, then turns; its coordinates are the place of OpenSim's origin (between the ASIS) where the body file states it.
The values of the coordinates in a posture are those of :meth:`mbkf.model.clinical.ClinicalAngles.angles`, shifted by
:func:`osim_coordinates`.

Ranges are the body's; where it has no limit ±2π and ±100 m stand for it. Nothing is locked or clamped.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree import ElementTree as ET

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.axes import rotation_to_world
from mbkf.io.labels import unique_labels
from mbkf.io.subject import SubjectMarker
from mbkf.io.written import MARK
from mbkf.model.body import Body
from mbkf.model.body_shapes import COLOURS, segment_shapes, side_of
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.clinical_table import Angle, ClinicalJoint, opensim_zeros_rad
from mbkf.model.shape_meshes import Mesh, joined, shape_mesh
from mbkf.model.skeleton import joint_origin
from mbkf.model.soles import sole_locals
from mbkf.model.vtp import vtp_text
from mbkf.numerics.cardan import quaternion_matrices

UP = "y"
"""OpenSim's axis that points up."""

UNLIMITED_RAD, UNLIMITED_M = 2.0 * np.pi, 100.0
"""Ranges of coordinates without a limit."""

VERSION = "40000"

ILLEGAL = str.maketrans(dict.fromkeys("\\/*+ \t\r\n", "_"))
"""Characters that OpenSim refuses in names of components."""


def osim_files(model: Body, markers: Sequence[SubjectMarker], name: str) -> dict[str, str]:
    """A body as OpenSim's model file and the surfaces of its segments, texts by the names of files in one folder.

    Args:
        model: The scaled body.
        markers: Markers to fix to its segments.
        name: Name of the model file; surfaces are called after its stem and their segment.

    Raises:
        UnknownName: A marker names a segment the body does not have.
    """
    stem = name.rpartition(".")[0] or name
    surfaces = {segment: f"{stem}_{osim_name(segment)}.vtp" for segment in model.joints}
    meshes = {segment: joined(map(shape_mesh, shapes)) for segment, shapes in segment_shapes(model).items()}
    texts = {surfaces[segment]: vtp_text(_turned(mesh)) for segment, mesh in meshes.items()}
    return {name: to_osim(model, markers, surfaces), **texts}


def to_osim(
    model: Body, markers: Sequence[SubjectMarker] = (), surfaces: Mapping[str, str] | None = None
) -> str:
    """A body as the text of an OpenSim model file.

    Args:
        model: The scaled body.
        markers: Markers to fix to its segments.
        surfaces: Files (VTP) of its segments' surfaces, by segment.

    Returns:
        XML; m, kg, rad.

    Raises:
        UnknownName: A marker names a segment the body does not have.
    """
    document = ET.Element("OpenSimDocument", Version=VERSION)
    root = ET.SubElement(document, "Model", name=osim_name(model.description.name))
    _text(root, "gravity", _numbers([0.0, -GRAVITY_M_S2, 0.0]))
    _text(root, "length_units", "meters")
    _text(root, "force_units", "N")
    clinical = ClinicalAngles(model)
    bodies, joints, placed = (_set(root, name) for name in ("BodySet", "JointSet", "MarkerSet"))
    for entry in clinical.joints:
        _add_body(bodies, model, entry.distal, (surfaces or {}).get(entry.distal, ""))
        _add_joint(joints, model, clinical, entry)
    for marker, name in zip(markers, osim_marker_names([one.name for one in markers]), strict=True):
        model.joint(marker.segment)
        element = ET.SubElement(placed, "Marker", name=name)
        _text(element, "socket_parent_frame", _frame(marker.segment))
        _text(element, "location", _numbers(to_osim_axes(marker.position_m)))
        _text(element, "fixed", "true")
    ET.indent(document)
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {MARK} -->\n'
        + ET.tostring(document, encoding="unicode")
        + "\n"
    )


def osim_name(name: str) -> str:
    """A name as OpenSim takes it: blanks, slashes, stars and plus signs become underscores."""
    return name.translate(ILLEGAL)


def osim_marker_names(names: Sequence[str]) -> list[str]:
    """Names of markers as OpenSim takes them; equal ones get a number."""
    return unique_labels([osim_name(name) for name in names], [])


def to_osim_axes(vectors: Array) -> Array:
    """Vectors (…, 3) of the world or of a segment in OpenSim's axes."""
    return np.asarray(vectors) @ rotation_to_world(UP)


def osim_origin_m(model: Body) -> Array:
    """(3,) place of OpenSim's origin of the root in the root's frame, of the person's size, m."""
    place = model.description.clinical_joints[0].opensim_origin_m
    return np.zeros(3) if place is None else model.axis_scale(model.description.segments[0]) * np.array(place)


def osim_coordinates(model: Body, q: Array) -> Array:
    """Values of the model file's coordinates in a motion.

    Args:
        model: The body.
        q: (T, nq) configurations; NaN frames give NaN.

    Returns:
        (T, A) rad and m, in the order of :class:`mbkf.model.clinical.ClinicalAngles`.

    Raises:
        ShapeError: q is not (T, nq).
    """
    clinical = ClinicalAngles(model)
    values = clinical.angles(q)
    for name, zero in opensim_zeros_rad(clinical.joints).items():
        values[:, clinical.names.index(name)] += zero
    start = model.root.q.start
    place = quaternion_matrices(q[:, start + 3 : start + 7]) @ osim_origin_m(model)
    for one in clinical.joints[0].translations:
        values[:, clinical.names.index(one.name)] += place @ one.direction
    return values


def osim_forces(model: Body, q: Array, tau: Array) -> Array:
    """Generalised forces conjugate to the model file's coordinates, as OpenSim's inverse dynamics states them.

    m = Bᵀ τ (:meth:`mbkf.model.clinical.ClinicalAngles.moments`); the root's moments are about OpenSim's origin d of
    it: n_d = n − d × f.

    Args:
        model: The body.
        q: (T, nq) configurations.
        tau: (T, nv) generalised forces; the root's are the residual.

    Returns:
        (T, A) N m and N, in the order of :class:`mbkf.model.clinical.ClinicalAngles`.

    Raises:
        ShapeError: q is not (T, nq).
    """
    start, moved = model.root.v.start, np.array(tau)
    force, turns = moved[:, start : start + 3], slice(start + 3, start + 6)
    moved[:, turns] -= np.cross(osim_origin_m(model), force)
    return ClinicalAngles(model).moments(q, moved)


def _add_body(bodies: ET.Element, model: Body, segment: str, surface: str) -> None:
    R, own = rotation_to_world(UP), model.pin_model.inertias[model.joint(segment).joint_id]
    body = ET.SubElement(bodies, "Body", name=osim_name(segment))
    if surface:
        mesh = ET.SubElement(
            ET.SubElement(body, "attached_geometry"), "Mesh", name=f"{osim_name(segment)}_surface"
        )
        _text(mesh, "socket_frame", "..")
        _text(mesh, "mesh_file", surface)
        _text(ET.SubElement(mesh, "Appearance"), "color", _numbers(COLOURS[side_of(segment)]))
    inertia = R.T @ own.inertia @ R
    _text(body, "mass", repr(float(own.mass)))
    _text(body, "mass_center", _numbers(to_osim_axes(own.lever)))
    _text(body, "inertia", _numbers([*np.diag(inertia), *inertia[[0, 0, 1], [1, 2, 2]]]))


def _add_joint(joints: ET.Element, model: Body, clinical: ClinicalAngles, entry: ClinicalJoint) -> None:
    floats, name = entry.proximal == "world", osim_name(entry.name)
    joint = ET.SubElement(joints, "CustomJoint", name=name)
    ends = {
        "parent": ("/ground" if floats else _frame(entry.proximal), joint_origin(model, entry.distal)),
        "child": (_frame(entry.distal), osim_origin_m(model) if floats else np.zeros(3)),
    }
    for end in ends:
        _text(joint, f"socket_{end}_frame", f"{name}_{end}")
    coordinates, frames = ET.SubElement(joint, "coordinates"), ET.SubElement(joint, "frames")
    for end, (frame, place_m) in ends.items():
        offset = ET.SubElement(frames, "PhysicalOffsetFrame", name=f"{name}_{end}")
        _text(offset, "socket_parent", frame)
        _text(offset, "translation", _numbers(to_osim_axes(place_m)))
        _text(offset, "orientation", "0 0 0")
    standing = dict(zip(clinical.names, osim_coordinates(model, _standing(model)[None])[0], strict=True))
    for angle, (least, most) in zip(entry.coordinates, _ranges(model, entry), strict=True):
        coordinate = ET.SubElement(coordinates, "Coordinate", name=osim_name(angle.name))
        _text(coordinate, "default_value", repr(float(standing[angle.name])))
        _text(coordinate, "range", _numbers([least, most]))
        _text(coordinate, "clamped", "false")
        _text(coordinate, "locked", "false")
    _add_transform(joint, entry)


def _standing(model: Body) -> Array:
    """(nq,) the neutral posture with the lower sole on the ground."""
    q = model.neutral()
    R, origins = model.placements(q)
    segments, places = sole_locals(model)
    ids = [model.joint(segment).joint_id for segment in segments]
    lowest = (origins[ids] + np.einsum("nij,nj->ni", R[ids], places))[:, 2].min()
    return model.integrate(q, np.eye(model.nv)[model.root.v.start + 2] * -lowest)


def _ranges(model: Body, entry: ClinicalJoint) -> Array:
    """(n, 2) least and greatest values of a joint's coordinates, rad; m for translations."""
    place = model.joint(entry.distal)
    axes = "xyz" if place.kind in {"free", "spherical"} else place.axes
    turns = model.limits[place.v][-len(axes) :]
    found = []
    for angle in entry.angles:
        limits = np.sort(angle.sign * turns[axes.index(angle.axis)]) + np.deg2rad(angle.opensim_zero_deg)
        found.append(np.where(np.isfinite(limits), limits, [-UNLIMITED_RAD, UNLIMITED_RAD]))
    return np.array([*found, *([-UNLIMITED_M, UNLIMITED_M] for _ in entry.translations)])


def _add_transform(joint: ET.Element, entry: ClinicalJoint) -> None:
    """Rotations about the angles' axes in their order, about unused axes by a constant 0; then translations."""
    transform = ET.SubElement(joint, "SpatialTransform")
    turned = [(one, to_osim_axes(one.direction)) for one in entry.angles]
    free = [
        to_osim_axes(axis) for name, axis in zip("xyz", np.eye(3), strict=True) if name not in entry.order
    ]
    moved = [(one, to_osim_axes(one.direction)) for one in entry.translations]
    still = [] if moved else list(np.eye(3))
    for kind, used, unused in (("rotation", turned, free), ("translation", moved, still)):
        axes: list[tuple[Angle | None, Array]] = [*used, *((None, axis) for axis in unused)]
        for number, (angle, axis) in enumerate(axes, start=1):
            element = ET.SubElement(transform, "TransformAxis", name=f"{kind}{number}")
            _text(element, "coordinates", osim_name(angle.name) if angle else "")
            _text(element, "axis", _numbers(axis))
            if angle is None:
                _text(ET.SubElement(element, "Constant", name="function"), "value", "0")
            else:
                zero = -np.deg2rad(angle.opensim_zero_deg) + 0.0
                linear = ET.SubElement(element, "LinearFunction", name="function")
                _text(linear, "coefficients", _numbers([1.0, zero]))


def _turned(mesh: Mesh) -> Mesh:
    return Mesh(to_osim_axes(mesh.vertices_m), to_osim_axes(mesh.normals), mesh.triangles)


def _frame(segment: str) -> str:
    return f"/bodyset/{osim_name(segment)}"


def _set(root: ET.Element, name: str) -> ET.Element:
    return ET.SubElement(ET.SubElement(root, name, name=name.lower()), "objects")


def _text(parent: ET.Element, tag: str, text: str) -> None:
    ET.SubElement(parent, tag).text = text


def _numbers(values: Sequence[float] | Array) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)
