"""Inertial sensors on the body, as a block: z = (ω, f)(q, v, a) + r, r ~ N(0, diag(σ_ω² I₃, σ_f² I₃)) per sensor.

ω and f are angular velocity and specific force in the sensor's own axes (:mod:`mbkf.sensors.inertial_sensor`).
Readings that are missing are left out, component by component.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.states import AcceleratedState


@dataclass(frozen=True)
class InertialSettings:
    """Noise of inertial sensors, skin movement included.

    Attributes:
        imu_rate_sd_rad_s, imu_force_sd_mps2: Difference between a reading and that of its segment, rad/s and m/s² per
            component.
    """

    imu_rate_sd_rad_s: float = 0.05
    imu_force_sd_mps2: float = 0.5


class InertialSensors(Block[AcceleratedState, None, Array | None, None]):
    """Gyroscopes and accelerometers, on a state that begins with (q, v, a).

    Attributes:
        sensor: The sensors on the body.
        observed: (nv,) dofs of the joints that carry a segment with a sensor.
    """

    quantities = 2

    def __init__(self, sensor: InertialSensor, settings: InertialSettings = InertialSettings()) -> None:
        self.sensor, self.settings = sensor, settings
        deviations = np.repeat([settings.imu_rate_sd_rad_s, settings.imu_force_sd_mps2], 3)
        self._weight = np.tile(1.0 / deviations, len(sensor.mounts))
        self.observed = observed_dofs(sensor.model, [mount.segment for mount in sensor.mounts])

    def decide(
        self, at: OperatingPoint[AcceleratedState, None], frame: Frame, memory: None, notes: Notes
    ) -> Array | None:
        """The frame's readings (S, 6), None without any; the joints that they observe are noted."""
        if frame.imus is None or not np.isfinite(frame.imus).any():
            return None
        notes.imus, notes.observed = frame.imus, True
        notes.unobserved = notes.unmarked[~self.observed[notes.unmarked]]
        return frame.imus

    def linearise(self, at: OperatingPoint[AcceleratedState, None], decision: Array | None) -> Rows | None:
        """Rows on (q, v, a)."""
        if decision is None:
            return None
        state = at.state
        return Rows(*self.rows(state.q, state.v, state.a, decision))

    def rows(self, q: Array, v: Array, a: Array, measured: Array) -> tuple[Array, Array]:
        """Whitened Jacobian (m, 3 nv) by (q, v, a) and innovations (m,) of one frame.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            measured: (S, 6) angular velocity rad/s and specific force m/s²; NaN are left out.
        """
        reading = self.sensor.reading(q, v, a)
        short = (measured - reading.values).reshape(-1)
        there = np.flatnonzero(np.isfinite(short))
        jacobian = np.concatenate([reading.by_q, reading.by_v, reading.by_a], axis=2)
        weight = self._weight[there]
        return jacobian.reshape(len(short), -1)[there] * weight[:, None], short[there] * weight


def observed_dofs(model: Body, segments: Sequence[str]) -> BoolArray:
    """(nv,) dofs of the joints that carry these segments; only the sum of joints between two of them is observed."""
    observed = np.zeros(model.nv, dtype=bool)
    for segment in segments:
        observed[model.joint(segment).v] = True
    return observed
