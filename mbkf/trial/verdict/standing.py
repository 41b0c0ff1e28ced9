"""The posture of the static trial that a person was scaled with: knees and ankles bent as no one stands."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.io.subject import STANDING_KEY, Subject
from mbkf.model.body import Body
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.verdict.parts import LEGS, part_of_segment

LEAST_DEG = 15.0
"""Smaller rotations are not listed."""


class Stood(NamedTuple):
    """A joint of a leg as the person stood in the static trial.

    Attributes:
        part: The leg.
        segment: Its distal segment.
        degrees: Largest rotation about one axis from the neutral posture.
    """

    part: str
    segment: str
    degrees: float


def stood_bent(model: Body, subject: Subject) -> tuple[Stood, ...]:
    """Joints of the legs that were turned by more than :data:`LEAST_DEG`, without toes; the most turned first.

    Args:
        model: The body.
        subject: The person, whose report may have the posture of the static trial.
    """
    q = subject.report.get(STANDING_KEY)
    if not isinstance(q, list) or len(q) != model.nq:
        return ()
    turned = np.rad2deg(PostureSensor(model).deviation(np.array(q, dtype=float))[0])
    part, toes = part_of_segment(model.description), model.description.roles.toes
    found = [
        Stood(part[name], name, float(turned[joint.v][np.argmax(np.abs(turned[joint.v]))]))
        for name, joint in model.joints.items()
        if part[name] in LEGS and name not in toes
    ]
    return tuple(
        sorted((one for one in found if abs(one.degrees) > LEAST_DEG), key=lambda one: -abs(one.degrees))
    )
