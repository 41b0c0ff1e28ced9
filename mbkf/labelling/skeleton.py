"""The body as a tree of rigid marker clusters, each about its segment's proximal joint."""

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
        number: Its place in the order of the segments.
        parent: Place of the proximal segment, -1 for the root.
        ends: True where no segment follows it.
        origin_m: (3,) its joint in the parent's frame.
        markers: (k,) its markers.
        local_m: (k, 3) their positions in its frame.
        sd_m: (k,) spread of each about that position, m.
        posture_sd_rad: Typical turn of the joint from neutral.
    """

    segment: str
    number: int
    parent: int
    ends: bool
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
    parents = [str(segment.parent) for segment in model.description.segments]
    found = []
    for number, (name, joint) in enumerate(model.joints.items()):
        own = np.flatnonzero(np.array(sensor.segments) == name)
        sd = model.posture_sd[joint.v]
        # In the neutral posture all segments' frames are parallel to the world.
        before = np.zeros(3) if number == 0 else origins[model.joint(parents[number]).joint_id]
        found.append(
            Cluster(
                name,
                number,
                -1 if number == 0 else names.index(parents[number]),
                name not in parents,
                origins[joint.joint_id] - before,
                own,
                sensor.local_m[own],
                sd_m[own],
                float(np.sqrt((sd[sd > 0] ** 2).mean())) if (sd > 0).any() else UNGUESSED_POSTURE_RAD,
            )
        )
    return tuple(found)


def limbs(body: tuple[Cluster, ...]) -> list[list[Cluster]]:
    """For every segment but the root, the segment and all segments beyond it, as far as they carry markers."""
    found = []
    for first in body[1:]:
        limb = {first.number: first}
        for cluster in body[first.number + 1 :]:
            if cluster.parent in limb:
                limb[cluster.number] = cluster
        if any(len(cluster.markers) for cluster in limb.values()):
            found.append(list(limb.values()))
    return found
