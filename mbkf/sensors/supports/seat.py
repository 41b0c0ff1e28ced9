"""A seat where no plate reads: the whole ground reaction acts beside the feet, towards the pelvis.

The motion requires a wrench whose centre of pressure on the floor is x = −(n_y + h f_x) / f_z, y = (n_x − h f_y) / f_z
from the point below the centre of mass, at height h above the floor (D. A. Winter, Biomechanics and Motor Control of
Human Movement, 4th ed. 2009, ch. 5.2). Under feet alone it lies between their soles. A runner whose trunk no marker
shows seems to be pressed behind the feet, too; but who sits does not fall, neither while sitting nor right after.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.runs import stretches
from mbkf.numerics.windows import bridged
from mbkf.sensors.contact.offline import falling
from mbkf.sensors.supports.momentum import WholeBody

WINDOW_S = 0.25
"""Duration over which rates of momentum are taken."""

BESIDE_M, NEAR_M = 0.12, 0.05
"""Distances of the centre of pressure from the soles: beyond the first a seat carries load, as long as it is beyond the
second."""

LASTING_S, STILL_M_S = 0.25, 0.5
"""Least duration, and largest speed of the pelvis, of sitting."""

LOADED_SHARE = 0.3
"""Least share of body weight on the ground for its centre of pressure to count."""


def sits(
    body: WholeBody, soles: Array, seat_m: Array, speed_m_s: Array, rate_hz: float, floor_m: float
) -> BoolArray:
    """(T,) frames in which a seat carries load, for a trial without plates.

    Args:
        body: The body's momentum.
        soles: (T, 2, 3, 3) heel, ball and toe end of both soles, m.
        seat_m: (T, 3) the part that sits.
        speed_m_s: (T,) its speed.
        rate_hz: Frame rate.
        floor_m: Height of the floor.
    """
    asked = body.missing_wrench(np.zeros(body.momentum.shape), rate_hz, WINDOW_S)
    with np.errstate(invalid="ignore", divide="ignore"):
        pressed = centre_on_floor(asked, body.centre_m, floor_m)
        beside = distance_to_feet(pressed, soles[..., :2])
        # On the seat's side of the feet.
        feet = soles[..., :2].mean(axis=(1, 2))
        along = ((pressed - feet) * (seat_m[:, :2] - feet)).sum(axis=1) > 0.0
        loaded = asked[:, 2] > LOADED_SHARE * np.linalg.norm(body.weight)
        may = loaded & along & (speed_m_s < STILL_M_S) & (beside > NEAR_M)
    found = np.zeros(len(may), dtype=bool)
    gap = max(1, round(0.5 * LASTING_S * rate_hz))
    falls = falling(seat_m[:, 2], rate_hz)
    for run in stretches(bridged(may, gap)):
        lasts = (beside[run] > BESIDE_M).sum() >= LASTING_S * rate_hz
        found[run] = lasts and not falls[run[0] + gap : run[-1] + gap + 1].any()
    return found


def centre_on_floor(wrench: Array, centre_m: Array, floor_m: float) -> Array:
    """(T, 2) points of the floor at which wrenches have no moment about a horizontal axis.

    Args:
        wrench: (T, 6) force N and moment N m about the points.
        centre_m: (T, 3) the points.
        floor_m: Height of the floor.
    """
    force, moment, height = wrench[:, :3], wrench[:, 3:], centre_m[:, 2] - floor_m
    x = -(moment[:, 1] + height * force[:, 0]) / force[:, 2]
    y = (moment[:, 0] - height * force[:, 1]) / force[:, 2]
    return centre_m[:, :2] + np.column_stack([x, y])


def distance_to_feet(points: Array, soles: Array) -> Array:
    """(T,) horizontal distance of points (T, 2) from the nearest line between two ends of soles (T, 2, 3, 2)."""
    ends = soles[:, :, [0, 2]].reshape(len(points), 4, 2)
    found = np.full(len(points), np.inf)
    for first, second in combinations(range(4), 2):
        start, line = ends[:, first], ends[:, second] - ends[:, first]
        share = ((points - start) * line).sum(axis=1) / np.maximum((line**2).sum(axis=1), 1e-9)
        nearest = start + np.clip(share, 0.0, 1.0)[:, None] * line
        found = np.fmin(found, np.linalg.norm(points - nearest, axis=1))
    return found
