"""Prior of a person's posture in the frames of scaling, for joints that markers do not show.

In a movement each joint has the usual spread about neutral: rᵀr with r = θ/σ, θ its rotation from neutral and σ the
body file's spread. Asked to stand straight, people are within a few degrees of neutral, or hold a joint at another
angle on purpose (arms out, head turned): with s = θᵀθ/τ² of the joint the cost is c² log(1 + s/c²), that of a Cauchy
distribution. Near neutral it is s; on a joint held elsewhere it has little effect.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.sensors.posture import prior_information
from mbkf.sensors.posture_sensor import PostureSensor

ON_PURPOSE = 2.0
"""Standard deviations of straight standing beyond which a joint is held elsewhere on purpose (c)."""


class Turned(NamedTuple):
    """Turns of the joints from neutral.

    Attributes:
        poses: (N, nq) configurations.
        deviations: (N, nv) rad, 0 for the root.
        jacobians: (nv, nv) derivative in each of them.
    """

    poses: Array
    deviations: Array
    jacobians: Sequence[Array]


class UsualPosture:
    """The posture term of scaling's cost.

    Attributes:
        sensor: Rotation of every joint from neutral.
        standing_sd: (n,) spread of each dof in straight standing, rad; smaller for stiff joints, as in movement.
    """

    def __init__(self, sensor: PostureSensor, standing_sd_rad: float) -> None:
        self.sensor = sensor
        self.standing_sd = np.minimum(sensor.sd, standing_sd_rad)
        joints = list(sensor.model.joints.values())
        dofs = [np.isin(sensor.dofs, np.arange(joint.v.start, joint.v.stop)) for joint in joints]
        self._joints = np.array([own for own in dofs if own.any()], dtype=np.float64)

    def costs(self, deviations: Array, standing: BoolArray) -> Array:
        """(N,) the term of N postures.

        Args:
            deviations: (N, nv) turns of the joints from neutral, rad.
            standing: (N,) True where the person stands straight.
        """
        turned = deviations[:, self.sensor.dofs]
        moving = ((turned / self.sensor.sd) ** 2).sum(axis=1)
        held = ON_PURPOSE**2 * np.log1p(self._squared(turned) / ON_PURPOSE**2).sum(axis=1)
        return np.where(standing, held, moving)

    def equations(self, deviation: Array, jacobian: Array, standing: bool) -> tuple[Array, Array]:
        """Gauss–Newton matrix (nv, nv) and half the gradient (nv,) of a posture's cost.

        Args:
            deviation: (nv,) turns of the joints from neutral, rad.
            jacobian: (nv, nv) their derivative.
            standing: True where the person stands straight.
        """
        weights = np.zeros(len(deviation))
        weights[self.sensor.dofs] = 1.0 / self._sd(deviation[self.sensor.dofs], standing)
        known = prior_information(self.sensor, deviation, jacobian, weights)
        return known.matrix, -known.vector

    def _sd(self, deviation: Array, standing: bool) -> Array:
        """(n,) spread of each dof's rotation, in standing the greater the further the joint is from neutral."""
        if not standing:
            return self.sensor.sd
        held = np.sqrt(1.0 + self._squared(deviation) / ON_PURPOSE**2)
        return np.asarray((held @ self._joints) * self.standing_sd)

    def _squared(self, deviation: Array) -> Array:
        """(…, joints) s of each joint."""
        return np.asarray((deviation / self.standing_sd) ** 2 @ self._joints.T)
