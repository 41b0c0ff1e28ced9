"""Orientations of worn sensors that another system has found, as a block: z_i = Exp(r) R̂(q) e_i, r ~ N(0, σ² I₃).

R̂ = R_segment(q) R₀ is the orientation (sensor → world) that the body's posture predicts, e_i are the axes. To first
order each axis errs by r × R̂ e_i, with H_i = −[R̂ e_i]ₓ J and J the derivative of the segment's turn by the posture.
The three axes of a sensor together count as R⁻¹ = I / (2 σ²) each, which is I₃ / σ² on r. Their errors last for many
frames, so that each frame counts for little.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.cardan import quaternion_matrices, unit_quaternions
from mbkf.numerics.kalman import Information, information
from mbkf.numerics.rotations import skew
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, State
from mbkf.sensors.inertial import observed_dofs
from mbkf.sensors.inertial_sensor import InertialSensor

ORIENTATIONS = "sensor orientations"
"""Name of the readings (S, 4) of a frame: unit quaternions sensor → world, NaN where missing."""


@dataclass(frozen=True)
class WornOrientationSettings:
    """Noise of orientations.

    Attributes:
        worn_turn_sd_rad: Difference between an orientation and its segment's, per component and reading. Errors of a
            few degrees that last for half a second count as much as independent ones of this size.
    """

    worn_turn_sd_rad: float = 0.1


class WornOrientations(Block[State, None, Array | None, None]):
    """Orientations of sensors on the body, on a state that begins with q.

    Attributes:
        sensor: The sensors on the body, as calibrated.
        settings: Their noise.
    """

    def __init__(
        self, sensor: InertialSensor, settings: WornOrientationSettings = WornOrientationSettings()
    ) -> None:
        self.sensor, self.settings = sensor, settings
        self._joints = [sensor.model.joint(mount.segment).joint_id for mount in sensor.mounts]
        self._observed = observed_dofs(sensor.model, [mount.segment for mount in sensor.mounts])

    def decide(
        self, at: OperatingPoint[State, None], frame: Frame, memory: None, notes: Notes
    ) -> Array | None:
        """The frame's orientations as matrices (S, 3, 3), NaN where missing; None without any."""
        found = frame.readings.get(ORIENTATIONS)
        if found is None:
            return None
        turns = quaternion_matrices(unit_quaternions(found))
        if np.isnan(turns).all():
            return None
        notes.observed = True
        notes.unobserved = notes.unmarked[~self._observed[notes.unmarked]]
        return turns

    def linearise(self, at: OperatingPoint[State, None], decision: Array | None) -> Information | None:
        """Information on positions."""
        if decision is None:
            return None
        model, q = self.sensor.model, at.state.q
        there = np.flatnonzero(np.isfinite(decision).all(axis=(1, 2)))
        predicted = self.sensor.orientations(q)[there].transpose(0, 2, 1)  # (S, axis, xyz)
        turning = model.spatial_jacobian(q)[3:]
        joints = np.array(self._joints)[there]
        by_q = turning[None] * model.supports[joints][:, None]
        rows = -skew(predicted) @ by_q[:, None]
        away = decision[there].transpose(0, 2, 1) - predicted
        sd = np.full(away.size, np.sqrt(2.0) * self.settings.worn_turn_sd_rad)
        found = information(away.reshape(-1), rows.reshape(away.size, -1), sd)
        return found._replace(readings=3 * len(there))
