"""Soles of the body: heel, ball and toe end of each foot, and how far a point of the floor is from them."""

from __future__ import annotations

from math import hypot

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import FEET
from mbkf.sensors.markers import MarkerSensor


def sole_locals(model: HumanModel) -> tuple[tuple[str, ...], Array]:
    """Heel, ball and toe end of right and left sole: their segments (6) and places (6, 3) in those, m."""
    sole = model.description.sole
    middle = 0.5 * (sole.inner_y_m + sole.outer_y_m)
    segments, places = [], []
    for segment, sign in zip(FEET, (1.0, -1.0), strict=True):
        toes = model.description.segment(segment.replace("foot", "toes"))
        for x in (sole.heel_x_m, toes.origin_m[0], sole.toe_x_m):
            segments.append(segment)
            places.append(np.array([x, sign * middle, sole.height_m]))
        scale = model.axis_scale(model.description.segment(segment))
        places[-3:] = [place * scale for place in places[-3:]]
    return tuple(segments), np.array(places)


def sole_points(model: HumanModel, q: Array) -> Array:
    """(T, 2, 3, 3) world positions of heel, ball and toe end of right and left sole; NaN where q is NaN."""
    sensor = MarkerSensor(model, *sole_locals(model))
    points = np.full((len(q), 2, 3, 3), np.nan)
    for t in np.flatnonzero(~np.isnan(q).any(axis=1)):
        points[t] = sensor.positions(q[t]).reshape(2, 3, 3)
    return points


def distances_to_sole(point: Array, sole: Array) -> Array:
    """(T,) horizontal distance from a point (T, 3) to the line from heel to toe end (T, 3, 3)."""
    heel, toe = sole[:, 0, :2], sole[:, 2, :2]
    along = toe - heel
    share = np.clip(((point[:, :2] - heel) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(point[:, :2] - heel - share[:, None] * along, axis=1)


def distance_to_sole(point: tuple[float, float], sole: list) -> float:
    """Horizontal distance from a point to the line from heel to toe end."""
    (hx, hy, _), (tx, ty, _) = sole[0], sole[2]
    ax, ay = tx - hx, ty - hy
    along = ((point[0] - hx) * ax + (point[1] - hy) * ay) / (ax * ax + ay * ay)
    along = min(max(along, 0.0), 1.0)
    return hypot(point[0] - hx - along * ax, point[1] - hy - along * ay)
