"""A person who stands for a static trial stands upright on flat feet: what keypoints alone do not tell.

Joint centres do not show how a foot is pitched or a pelvis tilted beyond what the places of keypoints are known to, and
these by one or two centimetres only: on a foot that is six degrees. Of standing more is known. Residuals per segment,
each divided by its standard deviation: the two horizontal components of its long axis, A_b(x) e_z.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.sides import mirrored

FLAT_SD_RAD = np.deg2rad(3.0)
"""How far a sole is from level in standing."""

UPRIGHT_SD_RAD = np.deg2rad(6.0)
"""How far a pelvis is from the reference posture's."""


class Standing:
    """Residuals of upright standing.

    Attributes:
        sd: (S, 1) spread of the inclination of each segment, rad.
    """

    def __init__(self, model: Body) -> None:
        """Args: the body, whose roles name the feet and the root."""
        segments = model.description.segments
        trunk = [s.name for s in segments if s.parent == model.roles.root and s.name == mirrored(s.name)]
        names = [*model.roles.feet, model.roles.root, *trunk]
        self._joints = np.array([model.joint(name).joint_id for name in names])
        self.sd = np.array([FLAT_SD_RAD] * len(model.roles.feet) + [UPRIGHT_SD_RAD] * (1 + len(trunk)))[
            :, None
        ]

    def residuals(self, model: Body, q: Array) -> Array:
        """(2 S,) whitened inclinations at q (nq,)."""
        frames = model.frames(q)
        return (frames[4 * self._joints + 2, :2] / self.sd).ravel()

    def linearised(self, model: Body, q: Array) -> tuple[Array, Array]:
        """Residuals (2 S,) and their Jacobian (2 S, nv) in the tangent space."""
        frames, spatial = model.frames_and_jacobian(q)
        axis = frames[4 * self._joints + 2]
        moves = model.supports[self._joints]
        turned = np.cross(spatial[3:].T[None], axis[:, None, :]) * moves[:, :, None]
        jacobian = turned[:, :, :2].transpose(0, 2, 1) / self.sd[:, :, None]
        return (axis[:, :2] / self.sd).ravel(), jacobian.reshape(-1, model.nv)
