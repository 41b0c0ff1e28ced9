"""Configurations of a body from orientations of some of its segments."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import conjugate, multiply
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import quaternion_matrices


def configurations(body: HumanModel, segments: Sequence[str], course: Array) -> Array:
    """(T, nq) from orientations of segments; a joint turns as the nearest sensors above and below it.

    Args:
        body: The body.
        segments: S segments, each after those above it.
        course: (T, S, 4) segment → world.
    """
    motion = np.tile(body.neutral(), (len(course), 1))
    parents = {segment.name: segment.parent for segment in body.description.segments}
    for k, name in enumerate(segments):
        joint = body.joint(name)
        above = parents[name]
        while above != "world" and above not in segments:
            above = parents[above]
        turn = course[:, k]
        if above != "world":
            turn = multiply(conjugate(course[:, segments.index(above)]), turn)
        turn = np.where(turn[:, 3:] < 0.0, -turn, turn)
        if joint.kind in ("free", "spherical"):
            motion[:, joint.q.stop - 4 : joint.q.stop] = turn
        elif joint.kind == "hinge":
            R = quaternion_matrices(turn)
            motion[:, joint.q.start] = np.arctan2(R[:, 0, 2], R[:, 0, 0])
    return motion
