"""The body as the first frame sees it: segments in order, each a rigid cluster of markers about its proximal joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.labelling.assignment import Indices
from mbkf.sensors.marker_sensor import MarkerSensor

UNGUESSED_POSTURE_RAD = 1.0
"""Spread taken for joints without a posture prior."""


@dataclass(frozen=True)
class Cluster:
    """A segment and its markers.

    Attributes:
        segment: Its name.
        parent: Place of the proximal segment in the order, -1 for the root.
        origin_m: (3,) its joint in the parent's frame.
        markers: (k,) its markers.
        local_m: (k, 3) their positions in its frame.
        sd_m: (k,) how far each may be from there, m.
        posture_sd_rad: Typical turn of the joint from neutral.
    """

    segment: str
    parent: int
    origin_m: Array
    markers: Indices
    local_m: Array
    sd_m: Array
    posture_sd_rad: float


def clusters(sensor: MarkerSensor, sd_m: Array) -> tuple[Cluster, ...]:
    """Every segment of the sensor's body, parents first, with the spread (M,) of its markers about their places."""
    model = sensor.model
    _, origins = model.placements(model.neutral())
    names = list(model.joints)
    found = []
    for name, joint in model.joints.items():
        parent = model.description.segment(name).parent
        before = -1 if parent == "world" else names.index(parent)
        own = np.flatnonzero(np.array(sensor.segments) == name)
        sd = model.posture_sd[joint.v]
        # In the neutral posture all segments' frames are parallel to the world.
        foot = np.zeros(3) if before < 0 else origins[model.joint(parent).joint_id]
        found.append(
            Cluster(
                name,
                before,
                origins[joint.joint_id] - foot,
                own,
                sensor.local_m[own],
                sd_m[own],
                float(np.sqrt((sd[sd > 0] ** 2).mean())) if (sd > 0).any() else UNGUESSED_POSTURE_RAD,
            )
        )
    return tuple(found)


def limbs(body: tuple[Cluster, ...]) -> list[list[int]]:
    """For every segment but the root, its number and those of all segments beyond it, as far as they carry markers."""
    found = []
    for first in range(1, len(body)):
        limb = [first]
        for number in range(first + 1, len(body)):
            if body[number].parent in limb:
                limb.append(number)
        if any(len(body[number].markers) for number in limb):
            found.append(limb)
    return found
