"""Curves of one side of the body over a trial: angles, torques and powers with their standard deviations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.io.dimensions import ANGLE, FORCE
from mbkf.io.results import Reconstruction, SdPart
from mbkf.model.description import BodyDescription
from mbkf.model.human import reference_body
from mbkf.trial.gait.convention import BY_MODEL, TRUNK, Convention
from mbkf.trial.gait.convention_angles import ConventionAngles, convention_angles

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


def side_curves(
    r: Reconstruction, side: int, convention: Convention = BY_MODEL, read: ConventionAngles | None = None
) -> Iterator[SideCurve]:
    """Angles of a side and of the midline, and torques and powers of the joints among them.

    Powers are those of the body's own axes in every convention.

    Args:
        r: The results.
        side: 0 right, 1 left.
        convention: Axes and signs of angles, and signs of torques.
        read: Angles in the convention, where they are known already.
    """
    own, other = ENDINGS[side], ENDINGS[1 - side]
    angles = read or convention_angles(r, convention)
    for name in angles.names:
        if name.endswith(other):
            continue
        coordinate = name.removesuffix(own)
        value, spreads = angles.of(name)
        unit = ANGLE.of(name) if name in r.coordinate_names else "rad"
        if unit != "rad":
            yield SideCurve("angle", coordinate, unit, value, *spreads)
            continue
        yield SideCurve("angle", coordinate, "deg", *(np.rad2deg(one) for one in (value, *spreads)))
        if name.startswith(ROOT) or name not in r.coordinate_names:  # the root's moment is a residual
            continue
        moment = convention.moment_sign(coordinate) * r.moment(name)
        power = (r.power(name), *(r.power_sd(name, part) for part in CURVE_PARTS))
        spread = (r.moment_sd(name, part) for part in CURVE_PARTS)
        yield SideCurve("torque", coordinate, FORCE.of(name), moment, *spread)
        yield SideCurve("power", coordinate, "W", *power)


def side_views(
    r: Reconstruction, side: int, convention: Convention = BY_MODEL, read: ConventionAngles | None = None
) -> Iterator[SideCurve]:
    """The curves of :func:`side_curves` as the side sees them: of the midline, the left has the mirrored ones.

    Args:
        r: The results.
        side: 0 right, 1 left.
        convention: Axes and signs.
        read: Angles in the convention, where they are known already.
    """
    mirrored = mirrored_midline(reference_body(r.subject)) if side else frozenset()
    for curve in side_curves(r, side, convention, read):
        turned = curve.name in mirrored and curve.quantity != "power"
        yield curve._replace(value=-curve.value) if turned else curve


def mirrored_midline(body: BodyDescription) -> frozenset[str]:
    """Curves of the midline that change their sign in a mirror: about x and z, and along y."""
    found = set(TRUNK[1:])
    for joint in body.clinical_joints:
        if joint.name.endswith(ENDINGS):
            continue
        found |= {angle.name for angle in joint.angles if angle.axis != "y"}
        found |= {place.name for place in joint.translations if place.axis == "y"}
    return frozenset(found)
