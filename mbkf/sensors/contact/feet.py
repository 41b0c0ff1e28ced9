"""Both feet at one state, as contact decisions need them: soles, which way they face, and how they move."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.feet import CompiledFeet
from mbkf.model.body import Body
from mbkf.sensors.contact.soles import Sole, sole_locals
from mbkf.sensors.contact.thresholds import FACES_DOWN, SOLE_ENDS

Vector = tuple[float, float, float]
"""A vector in the world."""


class FeetMotion(NamedTuple):
    """Right and left foot at one state.

    Attributes:
        soles: Heel, ball and toe end of each.
        velocities: Of these points, m/s.
        middles_m: (2, 3) middle of heel and toe end of each.
        facing_down: Whether each sole faces the floor enough to be stood on (:func:`.soles.soles_down`).
        pelvis_m: The pelvis, x, y, z.
        lowest: The lowest point of each sole: 0 heel, 1 ball, 2 toe end.
        lowest_end: The lower one of heel and ball.
    """

    soles: Sequence[Sole]
    velocities: Sequence[Sole]
    middles_m: Array
    facing_down: tuple[bool, bool]
    pelvis_m: Vector
    lowest: tuple[int, int]
    lowest_end: tuple[int, int]

    def speed(self, foot: int, point: int, floor_m_s: tuple[float, float]) -> float:
        """Speed of a point of a sole.

        Args:
            foot: 0 right, 1 left.
            point: 0 heel, 1 ball, 2 toe end.
            floor_m_s: Horizontal velocity of the floor, against which it counts.
        """
        x, y, z = self.velocities[foot][point]
        return hypot(x - floor_m_s[0], y - floor_m_s[1], z)


class FeetOnBody:
    """The feet of a body."""

    def __init__(self, model: Body) -> None:
        """Args: the body."""
        segments, local_m = sole_locals(model)
        right, left = (model.joint(segment).joint_id for segment in model.roles.feet)
        self._model = model
        self._compiled: CompiledFeet | None = None
        if set(segments) == set(model.roles.feet):
            joints = right, left, model.root.joint_id
            self._compiled = CompiledFeet.where_built(model.tree, joints, local_m)
        self._moves = np.array([model.supports[joint] for joint in (right, left)], dtype=float)
        # All points and axes that are looked at are combinations of the joints' axes and origins: one product.
        picked = np.zeros((11, len(model.supports), 4))
        for k, (segment, place) in enumerate(zip(segments, local_m, strict=True)):
            picked[k, model.joint(segment).joint_id] = *place, 1.0
        picked[6:8] = 0.5 * (picked[[0, 3]] + picked[[2, 5]])
        picked[[8, 9], [right, left], 2] = 1.0
        picked[10, model.root.joint_id, 3] = 1.0
        self._picked = picked.reshape(11, -1)

    def at(self, q: Array, v: Array) -> FeetMotion:
        """Both feet at a configuration q (nq,) and velocity v (nv,)."""
        if self._compiled is not None:
            soles, velocities, (right, left), pelvis, lowest, ends, middles = self._compiled.at(q, v)
            down = right > FACES_DOWN, left > FACES_DOWN
            return FeetMotion(soles, velocities, middles, down, pelvis, lowest, ends)
        frames, jacobian = self._model.frames_and_jacobian(q)
        found = self._picked @ frames
        points, twists = found.tolist(), (v * self._moves) @ jacobian.T
        velocities = twists[:, None, :3] + np.cross(twists[:, None, 3:], found[:6].reshape(2, 3, 3))
        (x, y, z), heights = points[10], found[:6, 2].reshape(2, 3)
        return FeetMotion(
            (points[:3], points[3:6]),
            velocities.tolist(),
            found[6:8],
            (points[8][2] > FACES_DOWN, points[9][2] > FACES_DOWN),
            (x, y, z),
            (int(heights[0].argmin()), int(heights[1].argmin())),
            (int(heights[0, :SOLE_ENDS].argmin()), int(heights[1, :SOLE_ENDS].argmin())),
        )
