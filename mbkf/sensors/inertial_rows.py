"""Inertial readings as whitened rows on a body's positions, velocities and accelerations, for its filters."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.human import HumanModel
from mbkf.sensors.inertial import InertialSensor


class InertialRows:
    """A sensor block: gyroscopes and accelerometers on a body.

    Attributes:
        sensor: The sensors.
        felt: (nv,) dofs of the joints that move a segment with a sensor, and of the pelvis.
    """

    def __init__(self, sensor: InertialSensor, rate_sd_rad_s: float, force_sd_mps2: float) -> None:
        """Standard deviations count skin movement, too: rad/s and m/s² per component and reading."""
        self.sensor = sensor
        self._weight = np.tile(1.0 / np.repeat([rate_sd_rad_s, force_sd_mps2], 3), len(sensor.mounts))
        self.felt = felt_dofs(sensor.model, [mount.segment for mount in sensor.mounts])

    def rows(self, q: Array, v: Array, a: Array, measured: Array) -> tuple[Array, Array]:
        """Whitened Jacobian (m, 3 nv) by (q, v, a) and innovations (m,) of one frame.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            measured: (S, 6) angular velocity rad/s and specific force m/s²; rows that are NaN are left out.
        """
        reading = self.sensor.reading(q, v, a)
        short = (measured - reading.values).reshape(-1)
        there = np.flatnonzero(np.isfinite(short))
        jacobian = np.concatenate([reading.by_q, reading.by_v, reading.by_a], axis=2)
        weight = self._weight[there]
        return jacobian.reshape(len(short), -1)[there] * weight[:, None], short[there] * weight


def felt_dofs(model: HumanModel, segments: list[str]) -> BoolArray:
    """(nv,) dofs of the joints that carry these segments; what lies between two of them only in sum, so not."""
    felt = np.zeros(model.nv, dtype=bool)
    for segment in segments:
        felt[model.joint(segment).v] = True
    return felt
