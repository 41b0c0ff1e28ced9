"""What is known of a person's posture in the frames of scaling, where markers do not show it.

In a movement, each joint strays from neutral by what people's joints do: rᵀr with r = θ/σ, θ its rotation from neutral
and σ the body file's spread. Asked to stand straight, people are within a few degrees of neutral, or hold a joint
otherwise on purpose (arms out, head turned), which is then any angle: with s = θᵀθ/τ² of the joint the cost is
c² log(1 + s/c²), that of a Cauchy distribution. Near neutral it is s; a joint held otherwise is hardly pulled.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.sensors.posture_sensor import PostureReading, PostureSensor

ON_PURPOSE = 2.0
"""Standard deviations of straight standing beyond which a joint is rather held otherwise on purpose (c)."""


class UsualPosture:
    """The posture term of scaling's cost.

    Attributes:
        sensor: Rotation of every joint from neutral.
        standing_sd: (n,) spread of each dof in straight standing, rad.
    """

    def __init__(self, sensor: PostureSensor, standing_sd_rad: float) -> None:
        """Makes the term.

        Args:
            sensor: Rotation of every joint from neutral.
            standing_sd_rad: Spread in straight standing; of stiff joints less, as in movement.
        """
        self.sensor = sensor
        self.standing_sd = np.minimum(sensor.sd, standing_sd_rad)
        joints = list(sensor.model.joints.values())
        dofs = [np.isin(sensor.dofs, np.arange(joint.v.start, joint.v.stop)) for joint in joints]
        self._joints = np.array([own for own in dofs if own.any()], dtype=np.float64)

    def cost(self, q: Array, stands: bool) -> float:
        """The term at q (nq,)."""
        deviation = self.sensor.reading(q).deviation
        if not stands:
            return float(((deviation / self.sensor.sd) ** 2).sum())
        return float(ON_PURPOSE**2 * np.log1p(self._strayed(deviation) / ON_PURPOSE**2).sum())

    def equations(self, q: Array, stands: bool) -> tuple[Array, Array]:
        """Gauss–Newton matrix (nv, nv) and half the gradient (nv,) of the cost at q (nq,)."""
        reading = self.sensor.reading(q)
        pull = reading.jacobian.T * self._precision(reading, stands)
        return pull @ reading.jacobian, pull @ reading.deviation

    def _precision(self, reading: PostureReading, stands: bool) -> Array:
        """(n,) weight of each dof's squared rotation."""
        if not stands:
            return np.asarray(self.sensor.sd**-2.0)
        held = 1.0 / (1.0 + self._strayed(reading.deviation) / ON_PURPOSE**2)
        return np.asarray((held @ self._joints) / self.standing_sd**2)

    def _strayed(self, deviation: Array) -> Array:
        """(joints,) s of each joint."""
        return np.asarray(self._joints @ (deviation / self.standing_sd) ** 2)
