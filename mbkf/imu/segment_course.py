"""Configurations of a body from orientations of some of its segments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import conjugate, multiply
from mbkf.model.description import Segment
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import quaternion_matrices


def configurations(body: HumanModel, segments: Sequence[str], course: Array) -> Array:
    """(T, nq) from orientations of segments; a joint turns as the nearest sensors above and below it.

    The root turns with the first segment, as the segments between them do.

    Args:
        body: The body.
        segments: S segments, each after those above it; the root, where it is among them, is the first.
        course: (T, S, 4) segment → world.
    """
    motion = np.tile(body.neutral(), (len(course), 1))
    parents = {segment.name: segment.parent for segment in body.description.segments}
    root = body.root.q
    motion[:, root.stop - 4 : root.stop] = np.where(course[:, 0, 3:] < 0.0, -course[:, 0], course[:, 0])
    for k, name in enumerate(segments[1:], start=1):
        joint = body.joint(name)
        above = parents[name]
        while above != "world" and above not in segments:
            above = parents[above]
        nearest = segments.index(above) if above in segments else 0
        turn = multiply(conjugate(course[:, nearest]), course[:, k])
        turn = np.where(turn[:, 3:] < 0.0, -turn, turn)
        if joint.kind in ("free", "spherical"):
            motion[:, joint.q.stop - 4 : joint.q.stop] = turn
        elif joint.kind == "hinge":
            motion[:, joint.q.start] = _hinge_angle(turn, body.description.segment(name))
    return motion


def _hinge_angle(turn: Array, segment: Segment) -> Array:
    """(T,) angle of a hinge in turns (T, 4): of the x axis about y, else of the part about the hinge's axis."""
    if segment.axis is None and segment.axes == "y":
        R = quaternion_matrices(turn)
        return np.arctan2(R[:, 0, 2], R[:, 0, 0])
    axis = np.eye(3)["xyz".index(segment.axes)] if segment.axis is None else segment.axis
    return 2.0 * np.arctan2(turn[:, :3] @ axis, turn[:, 3])
