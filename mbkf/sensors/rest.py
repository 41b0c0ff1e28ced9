"""Posture and rest, as a block: 0 = θ_j(q) + r, r ~ N(0, (k σ_j)²) and 0 = v_j + r, r ~ N(0, σ_v²) for every dof j.

θ is each joint's rotation vector from the neutral posture, σ_j its spread among people, k a factor
(:mod:`mbkf.sensors.posture`). Both readings are weak and repeated in every frame; dofs that move no marker of the
capture have neither. The torque-state filter needs them for every dof, since without markers it knows velocities
through forces alone; the other filters damp unobserved joints only (:mod:`mbkf.sensors.unobserved`).
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.numerics.kalman import Information, information
from mbkf.sensors.block import Block, Notes, OperatingPoint, State
from mbkf.sensors.posture_sensor import PostureSensor


class PostureAndRest(Block[State, None, Notes, None]):
    """Weak priors on posture and velocity.

    Attributes:
        sensor: Deviation of every joint from neutral.
    """

    prior = True

    def __init__(
        self, sensor: PostureSensor, unobservable: BoolArray, posture_scale: float, rest_sd: float
    ) -> None:
        """Args: the attributes; unobservable: (nv,) dofs without readings; posture_scale: k; rest_sd: σ_v, rad/s."""
        self.sensor = sensor
        self._free = np.flatnonzero(~unobservable[sensor.dofs])
        self._posture_sd = posture_scale * sensor.sd[self._free]
        self._moving, self._certainty = np.flatnonzero(~unobservable), rest_sd**-2

    def linearise(self, at: OperatingPoint[State, None], decision: Notes) -> Information:
        """Information on positions and velocities."""
        state, nv, stop = at.state, self.layout.nv, self.layout.v.stop
        rest = self.layout.v.start + self._moving
        away = self.sensor.reading(state.q)
        posture = information(-away.deviation[self._free], away.jacobian[self._free], self._posture_sd)
        matrix, vector = np.zeros((stop, stop)), np.zeros(stop)
        matrix[:nv, :nv], vector[:nv] = posture.matrix, posture.vector
        matrix[rest, rest] = self._certainty
        vector[rest] = -state.v[self._moving] * self._certainty
        return Information(matrix, vector, 0.0, 0)
