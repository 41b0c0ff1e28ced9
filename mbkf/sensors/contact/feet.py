"""Both feet at one state, as contact decisions need them: soles, their tilt and their velocities."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.soles import sole_locals
from mbkf.sensors.contact.rules import FACES_DOWN
from mbkf.sensors.contact.soles import Sole

Vector = tuple[float, float, float]
"""A vector in the world."""


class FeetMotion(NamedTuple):
    """Right and left foot at one state.

    Attributes:
        soles: Heel, ball and toe end of each.
        middles_m: (2, 3) middle of heel and toe end of each.
        facing_down: True for a sole that faces the floor enough to be stood on: not a foot on its side, its instep or
            the tips of its toes.
        twists: Linear and angular velocity of each at the world's origin, m/s and rad/s.
        pelvis_m: The pelvis, x, y, z.
    """

    soles: Sequence[Sole]
    middles_m: Array
    facing_down: tuple[bool, bool]
    twists: Sequence[Sequence[float]]
    pelvis_m: Vector

    def velocity(self, foot: int, point: Sequence[float]) -> Vector:
        """Velocity of a world point that moves with a foot, 0 right and 1 left."""
        vx, vy, vz, wx, wy, wz = self.twists[foot]
        x, y, z = point
        return vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x

    def speed(self, foot: int, point: Sequence[float], floor_m_s: tuple[float, float]) -> float:
        """Speed of a world point that moves with a foot.

        Args:
            foot: 0 right, 1 left.
            point: The point.
            floor_m_s: Horizontal velocity of the floor, against which it counts.
        """
        x, y, z = self.velocity(foot, point)
        return hypot(x - floor_m_s[0], y - floor_m_s[1], z)


class FeetOnBody:
    """The feet of a body."""

    def __init__(self, model: Body) -> None:
        segments, local_m = sole_locals(model)
        feet = [model.joint(segment).joint_id for segment in model.roles.feet]
        self._model = model
        self._moves = np.array([model.supports[joint] for joint in feet], dtype=float)
        # All points and axes below are combinations of the joints' axes and origins: one product.
        picked = np.zeros((11, len(model.supports), 4))
        for k, (segment, place) in enumerate(zip(segments, local_m, strict=True)):
            picked[k, model.joint(segment).joint_id] = *place, 1.0
        picked[6:8] = 0.5 * (picked[[0, 3]] + picked[[2, 5]])
        picked[[8, 9], feet, 2] = 1.0
        picked[10, model.root.joint_id, 3] = 1.0
        self._picked = picked.reshape(11, -1)

    def at(self, q: Array, v: Array) -> FeetMotion:
        """Both feet at a configuration q (nq,) and velocity v (nv,)."""
        frames, jacobian = self._model.frames_and_jacobian(q)
        found = self._picked @ frames
        points = found.tolist()
        x, y, z = points[10]
        return FeetMotion(
            (points[:3], points[3:6]),
            found[6:8],
            (points[8][2] > FACES_DOWN, points[9][2] > FACES_DOWN),
            ((v * self._moves) @ jacobian.T).tolist(),
            (x, y, z),
        )
