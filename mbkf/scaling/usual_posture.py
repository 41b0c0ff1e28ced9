"""Prior of a person's posture in the frames of scaling, for joints that markers do not show.

In a movement each joint has the usual spread about neutral: rᵀr with r = θ/σ, θ its rotation from neutral and σ the
body file's spread. Asked to stand straight, people are within a few degrees of neutral, or hold a joint at another
angle on purpose (arms out, head turned): with s = θᵀθ/τ² of the joint the cost is c² log(1 + s/c²), that of a Cauchy
distribution. Near neutral it is s; on a joint held elsewhere it has little effect.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.sensors.posture import prior_information
from mbkf.sensors.posture_sensor import PostureSensor

ON_PURPOSE = 2.0
"""Standard deviations of straight standing beyond which a joint is held elsewhere on purpose (c)."""


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

    def cost(self, q: Array, standing: bool) -> float:
        """The term at q (nq,)."""
        deviation = self.sensor.deviation(q)[0][self.sensor.dofs]
        if not standing:
            return float(((deviation / self.sensor.sd) ** 2).sum())
        return float(ON_PURPOSE**2 * np.log1p(self._squared(deviation) / ON_PURPOSE**2).sum())

    def equations(self, q: Array, standing: bool) -> tuple[Array, Array]:
        """Gauss–Newton matrix (nv, nv) and half the gradient (nv,) of the cost at q (nq,)."""
        deviation, jacobian = self.sensor.deviation(q)
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
        """(joints,) s of each joint."""
        return np.asarray(self._joints @ (deviation / self.standing_sd) ** 2)
