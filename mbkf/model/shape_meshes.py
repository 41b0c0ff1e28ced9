"""Shapes of segments as closed triangle meshes, in the resolution of the viewer (mbkf/viz/assets/scene.js)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.model.body_shapes import Shape
from mbkf.numerics.orthonormal import axes_from

LIMB_CORNERS, ELLIPSOID_CORNERS, TUBE_CORNERS = 28, 36, 40
"""Corners of a ring."""

CAP_RINGS, SIDE_RINGS, ELLIPSOID_RINGS, TUBE_PARTS, BEVEL_RINGS = 8, 7, 23, 4, 4

SWELL = 0.10
"""Swelling of a limb between its ends, as a share of the radius at its beginning."""

BEVEL_M, BEVEL_OUT_M = 0.010, 0.005
"""Breadth of the bevel of a foot's edge, and how far the side view grows along it."""


@dataclass(frozen=True)
class Mesh:
    """Triangles, counter-clockwise seen from outside.

    Attributes:
        vertices_m: (V, 3) places in the segment's frame.
        normals: (V, 3) unit vectors outwards.
        triangles: (N, 3) vertices of each.
    """

    vertices_m: Array
    normals: Array
    triangles: NDArray[np.int64]


def shape_mesh(shape: Shape) -> Mesh:
    """The surface of a shape."""
    makers = {"limb": _limb, "ellipsoid": _ellipsoid, "tube": _tube, "outline": _outline}
    return makers[shape.kind](shape.numbers)


def joined(meshes: Iterable[Mesh]) -> Mesh:
    """Several meshes as one."""
    parts = list(meshes)
    first = np.cumsum([0, *(len(part.vertices_m) for part in parts)])
    return Mesh(
        np.concatenate([part.vertices_m for part in parts]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.triangles + at for part, at in zip(parts, first, strict=False)]),
    )


def _limb(n: Array) -> Mesh:
    start, end, (r0, r1) = n[:3], n[3:6], n[6:8]
    length = float(np.linalg.norm(end - start))
    quarter = 0.5 * np.pi * np.arange(CAP_RINGS + 1) / CAP_RINGS
    s = np.arange(1, SIDE_RINGS + 1) / (SIDE_RINGS + 1)
    side = r0 + (r1 - r0) * s + SWELL * r0 * np.sin(np.pi * np.sqrt(s))
    radius = np.concatenate([r0 * np.sin(quarter[1:]), side, r1 * np.cos(quarter[:-1])])
    along = np.concatenate([-r0 * np.cos(quarter[1:]), length * s, length + r1 * np.sin(quarter[:-1])])
    axes = axes_along(end - start)
    ring = _circle(LIMB_CORNERS) @ axes[:, :2].T
    rings = start + radius[:, None, None] * ring + along[:, None, None] * axes[:, 2]
    return _smooth(*_closed(rings, start - r0 * axes[:, 2], end + r1 * axes[:, 2]))


def _ellipsoid(n: Array) -> Mesh:
    polar = np.pi * np.arange(1, ELLIPSOID_RINGS + 1) / (ELLIPSOID_RINGS + 1)
    circle = np.pad(_circle(ELLIPSOID_CORNERS), ((0, 0), (0, 1)))
    up = np.array([0.0, 0.0, 1.0])
    unit = np.sin(polar)[:, None, None] * circle - np.cos(polar)[:, None, None] * up
    centre, radii = n[:3], n[3:]
    return _smooth(*_closed(centre + radii * unit, centre - radii * up, centre + radii * up))


def _tube(n: Array) -> Mesh:
    x, z, depth, breadth = _rounded(n.reshape(-1, 4)).T[:, :, None]
    c, s = _circle(TUBE_CORNERS).T
    rings = np.stack([x + depth * c, breadth * s, z + 0.0 * c], axis=2)
    return _smooth(*_closed(rings, rings[0].mean(axis=0), rings[-1].mean(axis=0)))


def _outline(n: Array) -> Mesh:
    """A side view, given breadth: rings about it from one side to the other, with edges that show."""
    (y0, y1), side = n[:2], n[2:].reshape(-1, 2)
    if _area(side) < 0.0:
        side = side[::-1]
    turn = 0.5 * np.pi * np.arange(BEVEL_RINGS + 1) / BEVEL_RINGS
    inwards, out = BEVEL_M * (1.0 - np.cos(turn)), BEVEL_OUT_M * np.sin(turn)
    rings = side + np.concatenate([out, out[::-1]])[:, None, None] * _mitres(side)
    y = np.concatenate([y0 + inwards, (y1 - inwards)[::-1]])[:, None] + np.zeros(len(side))
    middle = _centroid(side)
    closed = np.stack([rings[..., 0], y, rings[..., 1]], axis=2)
    ends = (np.array([middle[0], end, middle[1]]) for end in (y0, y1))
    return _flat(*_closed(closed, *ends))


def _circle(corners: int) -> Array:
    angle = 2.0 * np.pi * np.arange(corners) / corners
    return np.column_stack([np.cos(angle), np.sin(angle)])


def axes_along(direction: Array) -> Array:
    """(3, 3) axes whose z has this direction; the world's where it has none."""
    if not direction.any():
        return np.eye(3)
    return axes_from("z", direction, "y", np.eye(3)[int(np.argmin(np.abs(direction)))])


def _rounded(sections: Array) -> Array:
    """Catmull and Rom's curve through sections (n, 4), each stretch in so many parts."""
    a, b = np.vstack([sections[:1], sections[:-2]]), sections[:-1]
    c, d = sections[1:], np.vstack([sections[2:], sections[-1:]])
    s = (np.arange(TUBE_PARTS) / TUBE_PARTS)[None, :, None]
    a, b, c, d = (part[:, None] for part in (a, b, c, d))
    curve = b + 0.5 * s * (c - a + s * (2 * a - 5 * b + 4 * c - d + s * (3 * (b - c) + d - a)))
    return np.vstack([curve.reshape(-1, sections.shape[1]), sections[-1:]])


def _closed(rings: Array, first: Array, last: Array) -> tuple[Array, NDArray[np.int64]]:
    """Vertices and triangles of a surface through rings (K, n, 3), with a point at each end."""
    count, corners, _ = rings.shape
    vertices = np.vstack([rings.reshape(-1, 3), first, last])
    here = np.arange(corners)
    then = np.roll(here, -1)
    triangles = [np.column_stack([np.full(corners, count * corners), then, here])]
    for k in range(count - 1):
        below, above = k * corners, (k + 1) * corners
        triangles.append(np.column_stack([below + here, below + then, above + then]))
        triangles.append(np.column_stack([below + here, above + then, above + here]))
    top = (count - 1) * corners
    triangles.append(np.column_stack([np.full(corners, count * corners + 1), top + here, top + then]))
    found = np.concatenate(triangles)
    p, q, r = vertices[found].transpose(1, 0, 2)
    outwards = float((p * np.cross(q, r)).sum()) > 0.0  # six times the volume
    return vertices, found if outwards else found[:, ::-1]


def _smooth(vertices: Array, triangles: NDArray[np.int64]) -> Mesh:
    """A mesh whose normals are means over a vertex's triangles, weighted by their areas."""
    normals = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], _crossed(vertices, triangles))
    return Mesh(vertices, _unit(normals), triangles)


def _flat(vertices: Array, triangles: NDArray[np.int64]) -> Mesh:
    """A mesh whose triangles share no vertices, so that edges show."""
    normals = np.repeat(_unit(_crossed(vertices, triangles)), 3, axis=0)
    return Mesh(vertices[triangles.ravel()], normals, np.arange(triangles.size).reshape(-1, 3))


def _crossed(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    p, q, r = vertices[triangles].transpose(1, 0, 2)
    return np.cross(q - p, r - p)


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _area(polygon: Array) -> float:
    """Signed area of a polygon (n, 2), positive where it runs anticlockwise."""
    x, y = polygon.T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _centroid(polygon: Array) -> Array:
    after = np.roll(polygon, -1, axis=0)
    crossed = polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]
    return np.asarray(((polygon + after) * crossed[:, None]).sum(axis=0) / (3.0 * crossed.sum()))


def _mitres(polygon: Array) -> Array:
    """(n, 2) how far each corner moves when every edge of an anticlockwise polygon moves out by 1."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    out = _unit(np.column_stack([edges[:, 1], -edges[:, 0]]))
    before = np.roll(out, 1, axis=0)
    return np.asarray((out + before) / (1.0 + (out * before).sum(axis=1, keepdims=True)))
