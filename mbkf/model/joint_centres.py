"""Displacements of joint centres from where the scale factors put them: names, spreads, effect on places of joints."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.model.description import BodyDescription
from mbkf.model.sides import mirrored

OWN_SHARE = 0.4
"""Share of a side's own part in the spread of a centre: the sides of a person are alike."""


def centre_names(body: BodyDescription) -> tuple[str, ...]:
    """(E,) names of the displacements of joint centres, three for each joint that has a spread."""
    return tuple(f"{centre.segment}_centre_{axis}" for centre in body.joint_centres for axis in "xyz")


def centres_of(subject: Subject, body: BodyDescription) -> Array:
    """(E,) displacements of a subject's joint centres, in the order of its body, m; 0 where it states nothing.

    Raises:
        UnknownName: The body does not have one of them.
    """
    names = centre_names(body)
    for name in subject.joint_centres_m:
        if name not in names:
            raise UnknownName("displacement of a joint centre", name, names)
    return np.array([subject.joint_centres_m.get(name, 0.0) for name in names])


def centre_covariance(body: BodyDescription) -> Array:
    """(E, E) prior covariance of the displacements, m²; those of two sides mirror each other for the most part."""
    centres = body.joint_centres
    found = np.zeros((len(centres), 3, len(centres), 3))
    for n, centre in enumerate(centres):
        found[n, :, n, :] = np.diag(centre.sd_m**2)
        for m, other in enumerate(centres):
            if m != n and other.segment == mirrored(centre.segment):
                alike = (1.0 - OWN_SHARE**2) * centre.sd_m * other.sd_m * [1.0, -1.0, 1.0]
                found[n, :, m, :] = np.diag(alike)
    return found.reshape(3 * len(centres), 3 * len(centres))


def centre_levers(model: Body, segments: list[str]) -> Array:
    """(S, 3, E) derivative of the places of S segments' joints, in the frames before them, by the displacements.

    Args:
        model: The body.
        segments: (S,) names of the segments.
    """
    centres = model.description.joint_centres
    levers = np.zeros((len(segments), 3, len(centres), 3))
    for n, centre in enumerate(centres):
        levers[segments.index(centre.segment), :, n, :] = np.eye(3)
    return levers.reshape(len(segments), 3, 3 * len(centres))
