"""Shapes of segments as boxes, cylinders and spheres, the solids that every reader of URDF draws.

A limb is a cylinder between two spheres, an ellipsoid the same along its longest axis. Each stretch of a tube is a box
whose section has the ellipse's area, and a foot is a row of boxes under its side view.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body_shapes import Shape
from mbkf.model.shape_meshes import axes_along

SLICES = 3
"""Boxes of a foot, from heel to front."""

SQUARE = np.sqrt(np.pi) / 2.0
"""Side of a square over the diameter of the circle of its area."""

LEAST_M = 0.002
"""Flatter solids are left out."""


@dataclass(frozen=True)
class Primitive:
    """A solid in its segment's frame.

    Attributes:
        kind: "box", "cylinder" (along its z) or "sphere".
        size_m: Box: its three lengths; cylinder: radius and length; sphere: radius.
        placement: (4, 4) its frame in the segment's; the origin is its middle.
    """

    kind: Literal["box", "cylinder", "sphere"]
    size_m: tuple[float, ...]
    placement: Array


def primitives(shape: Shape) -> tuple[Primitive, ...]:
    """The solids that stand for a shape."""
    makers = {"limb": _limb, "ellipsoid": _ellipsoid, "tube": _tube, "outline": _outline}
    return tuple(one for one in makers[shape.kind](shape.numbers) if min(one.size_m) > LEAST_M)


def _limb(n: Array) -> Iterator[Primitive]:
    start, end, (r0, r1) = n[:3], n[3:6], n[6:8]
    yield Primitive("sphere", (float(r0),), _placed(start))
    yield Primitive("sphere", (float(r1),), _placed(end))
    length = float(np.linalg.norm(end - start))
    if length > 0.0:
        middle = _placed(0.5 * (start + end), axes_along(end - start))
        yield Primitive("cylinder", (0.5 * float(r0 + r1), length), middle)


def _ellipsoid(n: Array) -> Iterator[Primitive]:
    centre, radii = n[:3], n[3:]
    longest = int(np.argmax(radii))
    radius = float(np.sqrt(np.delete(radii, longest).prod()))
    reach = (radii[longest] - radius) * np.eye(3)[longest]
    yield from _limb(np.concatenate([centre - reach, centre + reach, [radius, radius]]))


def _tube(n: Array) -> Iterator[Primitive]:
    for below, above in pairwise(n.reshape(-1, 4)):
        x, z, depth, breadth = 0.5 * (below + above)
        size = (2.0 * SQUARE * depth, 2.0 * SQUARE * breadth, abs(above[1] - below[1]))
        yield Primitive("box", tuple(float(one) for one in size), _placed([x, 0.0, z]))


def _outline(n: Array) -> Iterator[Primitive]:
    (y0, y1), side = n[:2], n[2:].reshape(-1, 2)
    edges = np.linspace(side[:, 0].min(), side[:, 0].max(), SLICES + 1)
    for rear, front in pairwise(edges):
        x = 0.5 * (rear + front)
        low, high = _heights(side, x)
        size = (float(front - rear), float(y1 - y0), high - low)
        yield Primitive("box", size, _placed([x, 0.5 * (y0 + y1), 0.5 * (low + high)]))


def _heights(side: Array, x: float) -> tuple[float, float]:
    """Least and greatest height at which a side view (n, 2) has this x."""
    after = np.roll(side, -1, axis=0)
    crossed = (side[:, 0] - x) * (after[:, 0] - x) < 0.0
    p, q = side[crossed], after[crossed]
    heights = p[:, 1] + (x - p[:, 0]) / (q[:, 0] - p[:, 0]) * (q[:, 1] - p[:, 1])
    return float(heights.min()), float(heights.max())


def _placed(at: Array | list[float], axes: Array | None = None) -> Array:
    placement = np.eye(4)
    placement[:3, 3] = at
    if axes is not None:
        placement[:3, :3] = axes
    return placement
