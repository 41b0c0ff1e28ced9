"""Simple shapes of the 18 segments, scaled to a person, for drawing only.

Each shape stands in its segment's frame (origin at the proximal joint, x forward, y left, z up). Lengths come from
the person's joints; breadths grow as √(k_m / k) with mass factor k_m and length factor k, so that volume goes with
mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.model.description import mirrored
from mbkf.model.human import HumanModel

LIMB_RADII_M = {
    "right_thigh": (0.078, 0.052),
    "right_shank": (0.052, 0.034),
    "right_upper_arm": (0.046, 0.036),
    "right_forearm": (0.038, 0.025),
    "neck": (0.056, 0.050),
}
"""Radii of a limb of the reference body at its proximal and distal end, judged by eye."""

_DISTAL = {"right_thigh": "right_shank", "right_shank": "right_foot", "right_upper_arm": "right_forearm",
             "right_forearm": "right_hand", "neck": "head"}  # fmt: skip
"""The segment whose joint is a limb's distal end."""

_ELLIPSOIDS = {
    "head": ((0.018, 0.0, 0.075), (0.100, 0.078, 0.120)),
    "right_hand": ((0.005, 0.0, -0.085), (0.036, 0.019, 0.090)),
}
"""Centre and semi-axes of ellipsoids of the reference body, m."""

_TUBES = {
    "pelvis": (
        (0.010, -0.345, 0.010, 0.012), (0.008, -0.335, 0.055, 0.075), (0.000, -0.300, 0.098, 0.138),
        (-0.008, -0.255, 0.116, 0.160), (-0.012, -0.210, 0.116, 0.164), (-0.010, -0.150, 0.106, 0.150),
        (-0.003, -0.090, 0.097, 0.135), (0.000, -0.030, 0.093, 0.129), (0.000, 0.020, 0.085, 0.120),
    ),
    "torso": (
        (0.000, -0.050, 0.088, 0.124), (0.000, 0.000, 0.094, 0.130), (0.000, 0.060, 0.104, 0.139),
        (0.002, 0.120, 0.116, 0.151), (0.000, 0.175, 0.120, 0.162), (-0.006, 0.220, 0.110, 0.166),
        (-0.012, 0.255, 0.090, 0.148), (-0.012, 0.282, 0.066, 0.096), (-0.006, 0.302, 0.050, 0.058),
        (0.000, 0.315, 0.010, 0.012),
    ),
}  # fmt: skip
"""Sections of the trunk from below: x, z of the centre, half depth, half breadth; m on the reference body."""


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


def segment_shapes(model: HumanModel) -> dict[str, tuple[Shape, ...]]:
    """Shapes of every segment of a person, m, by segment name in the model's order."""
    return {name: _shapes(model, name) for name in model.joints}


def as_plain(shapes: dict[str, tuple[Shape, ...]]) -> list[dict[str, Any]]:
    """The shapes as JSON can hold them, tenths of a millimetre kept."""
    return [
        {
            "name": name,
            "shapes": [{"kind": s.kind, "numbers": np.round(s.numbers, 4).tolist()} for s in group],
        }
        for name, group in shapes.items()
    ]


def _shapes(model: HumanModel, name: str) -> tuple[Shape, ...]:
    right = mirrored(name) if name.startswith("left_") else name
    side = -1.0 if name.startswith("left_") else 1.0
    if right in LIMB_RADII_M:
        end = _DISTAL[right]
        return (_limb(model, name, end if right == name else mirrored(end), LIMB_RADII_M[right]),)
    if right in _ELLIPSOIDS:
        centre, radii = np.array(_ELLIPSOIDS[right])
        return (_ellipsoid(model, name, centre, radii, side),)
    if right in _TUBES:
        k = _scale(model, name)
        return (Shape("tube", (np.array(_TUBES[right]) * k[[0, 2, 0, 1]]).ravel()),)
    return (_sole(model, name, side),)


def _breadth(model: HumanModel, name: str) -> float:
    segment = model.description.segment(name)
    k_m = model.mass_kg / model.description.reference_mass_kg
    return float(np.sqrt(k_m / model.scale[segment.length_index]))


def _scale(model: HumanModel, name: str) -> Array:
    return model.axis_scale(model.description.segment(name))


def _limb(model: HumanModel, name: str, end: str, radii: tuple[float, float]) -> Shape:
    to = _scale(model, name) * model.description.segment(end).origin_m
    return Shape("limb", np.concatenate([np.zeros(3), to, _breadth(model, name) * np.array(radii)]))


def _ellipsoid(model: HumanModel, name: str, centre: Array, radii: Array, side: float) -> Shape:
    k = _scale(model, name)
    return Shape("ellipsoid", np.concatenate([k * centre * [1.0, side, 1.0], k * radii]))


def _sole(model: HumanModel, name: str, side: float) -> Shape:
    """Foot or toes: the sole's outline from heel to ball or from ball to tip, and the instep above it."""
    description = model.description
    sole = description.sole
    ball = description.segment("right_toes").origin_m
    if name.endswith("toes"):
        x = np.array([0.0, sole.toe_x_m - ball[0], sole.toe_x_m - ball[0] - 0.012, 0.0])
        z = np.array([sole.height_m - ball[2], sole.height_m - ball[2], -0.008, 0.012])
        breadth = 0.95
    else:
        x = np.array([sole.heel_x_m, ball[0], ball[0], 0.035, -0.035, sole.heel_x_m - 0.004])
        z = np.array([sole.height_m, sole.height_m, ball[2] + 0.012, 0.012, 0.018, -0.03])
        breadth = 0.85
    k = _scale(model, name)
    y = np.sort(side * breadth * np.array([sole.inner_y_m, sole.outer_y_m])) * k[1]
    return Shape("outline", np.concatenate([y, np.column_stack([k[0] * x, k[2] * z]).ravel()]))
