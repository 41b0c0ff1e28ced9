"""Curves of one side of the body over a trial: angles, torques and powers with their standard deviations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.dimensions import ANGLE, FORCE
from mbkf.io.results import Reconstruction, SdPart

ENDINGS, ROOT = ("_r", "_l"), "pelvis_"


class SideCurve(NamedTuple):
    """A quantity over a trial.

    Attributes:
        quantity: "angle", "torque", "power" or "reaction".
        name: The coordinate without its side, or the axis of a force.
        unit: Of the values: deg, m, N m, W or N.
        value, sd, offset_sd, change_sd: (T,) values, standard deviations, the part of these that repeats whenever the
            posture is the same, and its change within the trial; NaN where not known.
    """

    quantity: str
    name: str
    unit: str
    value: Array
    sd: Array
    offset_sd: Array
    change_sd: Array


CURVE_PARTS: tuple[SdPart, ...] = ("total", "offset", "change")
"""Parts of standard deviations in a :class:`SideCurve`."""


def side_curves(r: Reconstruction, side: int) -> Iterator[SideCurve]:
    """Angles of a side and of the midline, and torques and powers of the joints among them.

    Args:
        r: The results.
        side: 0 right, 1 left.
    """
    own, other = ENDINGS[side], ENDINGS[1 - side]
    for name in r.coordinate_names:
        if name.endswith(other):
            continue
        coordinate = name.removesuffix(own)
        angle = (r.angle(name), *(r.angle_sd(name, part) for part in CURVE_PARTS))
        if ANGLE.of(name) != "rad":
            yield SideCurve("angle", coordinate, ANGLE.of(name), *angle)
            continue
        yield SideCurve("angle", coordinate, "deg", *(np.rad2deg(one) for one in angle))
        if name.startswith(ROOT):  # the root's moment is a residual
            continue
        moment = (r.moment(name), *(r.moment_sd(name, part) for part in CURVE_PARTS))
        power = (r.power(name), *(r.power_sd(name, part) for part in CURVE_PARTS))
        yield SideCurve("torque", coordinate, FORCE.of(name), *moment)
        yield SideCurve("power", coordinate, "W", *power)
