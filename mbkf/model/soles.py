"""Places of the soles on a scaled body: heel, ball and toe end of each foot."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body

SOLE_POINTS = ("heel", "ball", "toe")
"""Points of a sole, on the middle line of its rectangle."""


def sole_locals(model: Body) -> tuple[tuple[str, ...], Array]:
    """Heel, ball and toe end of right and left sole: their segments (6) and places (6, 3) in those, m."""
    segments, places = [], []
    for sole in model.roles.soles:
        scale = model.axis_scale(model.description.segment(sole.segment))
        for x in (sole.heel_x_m, sole.ball_x_m, sole.toe_x_m):
            segments.append(sole.segment)
            places.append(np.array([x, 0.5 * (sole.inner_y_m + sole.outer_y_m), sole.height_m]) * scale)
    return tuple(segments), np.array(places)


def sole_names(model: Body) -> tuple[str, ...]:
    """Names of these points, such as ``"right_foot_heel"``."""
    return tuple(f"{sole.segment}_{point}" for sole in model.roles.soles for point in SOLE_POINTS)
