"""Starts of the fit of a body to a cloud of points: headings, sizes and arm postures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.marker_sets.equipment import Equipment
from mbkf.model.human import HumanModel

HEADINGS = 8
"""Number of headings: that of the person is unknown."""

SIZES = (0.5, 1.2)
"""Least and greatest overall size: a child of three, and a tall man."""

ARMS_RAD = (0.2, 0.8, 1.5)
"""Abduction of the arms: hanging, held away from the body, and stretched out sideways."""


@dataclass(frozen=True)
class Start:
    """A pose (nq,) of a body of this size."""

    q: Array
    size: float


def starts(model: HumanModel, points_m: Array, equipment: Equipment) -> Iterator[Start]:
    """Upright poses whose equipment has its highest and lowest markers at the highest and lowest points.

    Args:
        model: The reference body.
        points_m: (N, 3) the points.
        equipment: The part of the body that carries them.
    """
    low, high = np.percentile(points_m[:, 2], [1.0, 99.0])
    middle = np.median(points_m[:, :2], axis=0)
    sole = model.description.sole
    neutral = model.neutral()
    floor = model.placements(neutral)[1][model.joint(sole.segment).joint_id][2] + sole.height_m
    for top in equipment.top_m:
        size = (high - low) / (top - equipment.bottom_m)
        if not SIZES[0] <= size <= SIZES[1]:
            continue
        for heading in np.arange(HEADINGS) * (2.0 * np.pi / HEADINGS):
            for away in ARMS_RAD if "hand" not in equipment.without else ARMS_RAD[:1]:
                q = _arms(model, neutral, away)
                root = q[model.root.q]
                root[:2] = middle
                root[2] = low - size * (equipment.bottom_m + floor)
                root[3:] = [0.0, 0.0, np.sin(0.5 * heading), np.cos(0.5 * heading)]
                yield Start(q, float(size))


def _arms(model: HumanModel, neutral: Array, away: float) -> Array:
    """The neutral posture with both arms abducted by an angle, rad."""
    q = neutral.copy()
    for segment, sense in (("right_upper_arm", -1.0), ("left_upper_arm", 1.0)):
        if segment in model.joints:
            q[model.joint(segment).q] = [np.sin(0.5 * sense * away), 0.0, 0.0, np.cos(0.5 * away)]
    return q
