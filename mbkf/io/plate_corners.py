"""Geometry of a force plate's surface from its corners, which lie in its quadrants (+x+y), (−x+y), (−x−y), (+x−y).

The plate's own z axis points down.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.orthonormal import axes_from

QUADRANTS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
"""Signs of x and y of the corners, in their order."""

LEAST_SIDE_M = 0.02
"""Corners that enclose less than the square of this are those of no plate."""


def plate_sides(corners: Array) -> tuple[Array, Array]:
    """Twice the sides (3,) of a plate along its x and y, from corners (4, 3)."""
    a, b, c, d = corners
    return a + d - b - c, a + b - c - d


def plate_axes(corners: Array) -> Array:
    """(3, 3) rotation whose columns are the plate's x, y and z in the axes of its corners (4, 3), in any unit."""
    x, y = plate_sides(corners)
    return axes_from("x", x, "y", y)


def plate_normal(corners: Array) -> Array:
    """(3,) unit normal of a plate's surface, the way that the order of its corners (4, 3) makes it face."""
    normal = np.cross(corners[0] - corners[2], corners[3] - corners[1])
    return np.asarray(normal / np.linalg.norm(normal))


def upward_normal(corners: Array) -> Array:
    """(3,) unit normal of a plate's surface, the way that points up in world axes."""
    normal = plate_normal(corners)
    return normal if normal[2] >= 0.0 else -normal


def has_area(corners_m: Array, farthest_m: float = np.inf) -> bool:
    """True where corners (4, 3) enclose a convex surface, within a distance of the origin along each axis.

    Corners that coincide, or whose order crosses the surface (0, 2, 1, 3), enclose none.
    """
    if not (np.abs(corners_m) <= min(farthest_m, np.finfo(float).max)).all():
        return False
    sides = np.roll(corners_m, -1, axis=0) - corners_m
    turns = np.cross(sides, np.roll(sides, -1, axis=0))  # twice the area of the triangle at each corner
    whole = np.cross(corners_m[2] - corners_m[0], corners_m[3] - corners_m[1])
    size = float(np.linalg.norm(whole))
    return size > LEAST_SIDE_M**2 and bool((turns @ whole > size * LEAST_SIDE_M**2).all())
