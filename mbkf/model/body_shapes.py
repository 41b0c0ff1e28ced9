"""Simple shapes of a body's segments, scaled to a person, for drawing only.

Each shape is given in its segment's frame (origin at the proximal joint, x forward, y left, z up). Lengths come from
the person's joints; breadths grow as √(k_m / k) with mass factor k_m and length factor k, so that volume goes with
mass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body

PLAIN_RADII_M = (0.045, 0.035)
"""Radii of a limb of the reference body without a shape in the body file."""

COLOURS = {"": (0.725, 0.769, 0.812), "right": (0.508, 0.672, 0.777), "left": (0.758, 0.648, 0.568)}
"""The viewer's colours (mbkf/viz/assets/scene.js) by side: grey, towards blue or vermillion; sRGB, 0 to 1."""

MARKER_RADIUS_M, MARKER_COLOUR = 0.0105, (0.114, 0.153, 0.200)
"""The viewer's size and colour of a measured marker."""


@dataclass(frozen=True)
class Shape:
    """One drawn shape of a segment.

    Attributes:
        kind: "limb" (tapered, round ends), "ellipsoid", "tube" (elliptic sections) or "outline" (a side view, given
            breadth).
        numbers: limb: (8,) from, to, their radii; ellipsoid: (6,) centre, semi-axes; tube: (4 n,) x, z, half depth
            and half breadth of n sections; outline: (2 + 2 n,) least and greatest y, then n points x, z.
    """

    kind: str
    numbers: Array


def segment_shapes(model: Body) -> dict[str, tuple[Shape, ...]]:
    """Shapes of every segment of a person, m, by segment name in the model's order."""
    return {name: _shapes(model, name) for name in model.joints}


def side_of(segment: str) -> str:
    """A segment's key in :data:`COLOURS`: "right", "left", or "" on the midline."""
    side = segment.split("_", maxsplit=1)[0]
    return side if side in COLOURS else ""


def as_plain(shapes: dict[str, tuple[Shape, ...]]) -> list[dict[str, object]]:
    """The shapes as plain JSON data, rounded to a tenth of a millimetre."""
    return [
        {
            "name": name,
            "shapes": [{"kind": s.kind, "numbers": np.round(s.numbers, 4).tolist()} for s in group],
        }
        for name, group in shapes.items()
    ]


def _shapes(model: Body, name: str) -> tuple[Shape, ...]:
    side = -1.0 if name.startswith("left_") else 1.0
    shape = model.description.shapes.get(name)
    if shape is None:
        return _plain_limbs(model, name)
    if shape.kind == "limb":
        to = model.description.segment(shape.to).origin_m
        return (_limb(model, name, to, (shape.numbers[0], shape.numbers[1])),)
    if shape.kind == "ellipsoid":
        return (_ellipsoid(model, name, shape.numbers[:3], shape.numbers[3:], side),)
    if shape.kind == "tube":
        k = _scale(model, name)
        return (Shape("tube", (shape.numbers.reshape(-1, 4) * k[[0, 2, 0, 1]]).ravel()),)
    return (_sole(model, name, shape.kind == "toes"),)


def _plain_limbs(model: Body, name: str) -> tuple[Shape, ...]:
    """A limb to every joint the segment carries, or to twice its centre of mass."""
    segments = model.description.segments
    ends = [segment.origin_m for segment in segments if segment.parent == name]
    ends = [end for end in ends if np.linalg.norm(end) > 0.0] or [2.0 * model.description.segment(name).com_m]
    return tuple(_limb(model, name, end, PLAIN_RADII_M) for end in ends)


def _breadth(model: Body, name: str) -> float:
    segment = model.description.segment(name)
    k_m = model.mass_kg / model.description.reference_mass_kg
    return float(np.sqrt(k_m / model.scale[segment.length_index]))


def _scale(model: Body, name: str) -> Array:
    return model.axis_scale(model.description.segment(name))


def _limb(model: Body, name: str, end_m: Array, radii: tuple[float, float]) -> Shape:
    to = _scale(model, name) * end_m
    return Shape("limb", np.concatenate([np.zeros(3), to, _breadth(model, name) * np.array(radii)]))


def _ellipsoid(model: Body, name: str, centre: Array, radii: Array, side: float) -> Shape:
    k = _scale(model, name)
    return Shape("ellipsoid", np.concatenate([k * centre * [1.0, side, 1.0], k * radii]))


def _sole(model: Body, name: str, toes: bool) -> Shape:
    """Foot or toes: the sole's outline from heel to ball or from ball to tip, and the instep above it."""
    roles = model.roles
    foot = (roles.toes if toes else roles.feet).index(name)
    sole = roles.soles[foot]
    ball = (
        model.description.segment(roles.toes[foot]).origin_m
        if roles.toes
        else np.array([sole.ball_x_m, 0, -0.044])
    )
    if toes:
        x = np.array([0.0, sole.toe_x_m - ball[0], sole.toe_x_m - ball[0] - 0.012, 0.0])
        z = np.array([sole.height_m - ball[2], sole.height_m - ball[2], -0.008, 0.012])
        breadth = 0.95
    else:
        front = ball[0] if roles.toes else sole.toe_x_m
        x = np.array([sole.heel_x_m, front, ball[0], 0.035, -0.035, sole.heel_x_m - 0.004])
        z = np.array([sole.height_m, sole.height_m, ball[2] + 0.012, 0.012, 0.018, -0.03])
        breadth = 0.85
    k = _scale(model, name)
    y = np.sort(breadth * np.array([sole.inner_y_m, sole.outer_y_m])) * k[1]
    return Shape("outline", np.concatenate([y, np.column_stack([k[0] * x, k[2] * z]).ravel()]))
