"""Prior of a static trial: the person stands upright on flat feet, which keypoints do not show.

The places of keypoints are known to one or two centimetres, which leaves the pitch of a foot uncertain by six degrees,
and the tilt of the pelvis likewise. In standing both are known better. Residuals per segment, each divided by its
standard deviation: the two horizontal components of its long axis, A_b(x) e_z.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.sides import mirrored

FLAT_SD_RAD = np.deg2rad(3.0)
"""Spread of a sole's inclination in standing."""

UPRIGHT_SD_RAD = np.deg2rad(6.0)
"""Spread of the inclination of pelvis and trunk about the reference posture's."""


class UprightPosture:
    """Residuals of upright standing on flat feet.

    Attributes:
        sd: (S, 1) spread of the inclination of each segment, rad.
    """

    def __init__(self, model: Body, sd_rad: Mapping[str, float] | None = None) -> None:
        """Takes the spread of each segment's inclination, rad; by default those of feet, root and trunk in standing."""
        sd_rad = standing_sd_rad(model) if sd_rad is None else sd_rad
        self._joints = np.array([model.joint(name).joint_id for name in sd_rad], dtype=np.intp)
        self.sd = np.array([*sd_rad.values()])[:, None]

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


def standing_sd_rad(model: Body) -> dict[str, float]:
    """Spread of the inclination of feet, root and trunk of a person who stands, rad."""
    root, segments = model.roles.root, model.description.segments
    trunk = [one.name for one in segments if one.parent == root and one.name == mirrored(one.name)]
    feet = {name: float(FLAT_SD_RAD) for name in model.roles.feet}
    return feet | {name: float(UPRIGHT_SD_RAD) for name in (root, *trunk)}
