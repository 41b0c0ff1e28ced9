"""Inertial sensors without markers beside them, as a block: biases and mountings are states.

    z = C(θ) (ω, f)(q, v, a) + (b, 0) + r,  r ~ N(0, diag(σ_ω² I₃, σ_f² I₃)) per sensor
    C(θ) = R₀ᵀ Exp(−θ) R₀

R₀ (sensor → segment) is the calibrated mounting, θ (segment axes) its turn since, b the gyroscope's bias. Both are slow
random walks. The joints' centres, which neighbouring sensors share, and standing feet make them observable; no
magnetometer is needed (M. Kok, J. D. Hol and T. B. Schön, IFAC Proceedings 47 (2014) 79–84).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.tree import WornTable
from mbkf.model.layout import ExtraState
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.rotations import exponential_and_left_jacobian, skew
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
from mbkf.sensors.inertial import observed_dofs
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.states import LoadedState

BIASES, TURNS = "gyroscope biases", "turns of the mounts"
"""Names of the states that the block adds, three per sensor each."""


@dataclass(frozen=True)
class BodySensorSettings:
    """Noise of sensors on skin, and random walks of biases and mounts.

    Attributes:
        worn_rate_sd_rad_s: Difference between an angular velocity and its segment's, per component and reading. It is
            integrated: a larger value lets the filter lag behind fast turns.
        worn_force_sd_m_s2: The same of a specific force. Its errors by skin, impacts and the sensor's place last.
        bias_walk: Random walk of a bias, rad/s/√s.
        turn_walk: Random walk of a mount's turn, rad/√s: a strap that slips.
    """

    worn_rate_sd_rad_s: float = 0.01
    worn_force_sd_m_s2: float = 5.0
    bias_walk: float = 5e-5
    turn_walk: float = 0.002


class BodySensors(Block[LoadedState, None, Array | None, None]):
    """Inertial sensors with their biases and mounts' turns, on a state that begins with (q, v, a).

    Attributes:
        sensor: The sensors on the body, as calibrated.
        settings: Their noise.
    """

    quantities = 2

    def __init__(
        self,
        sensor: InertialSensor,
        bias_rad_s: Array,
        bias_sd_rad_s: Array,
        turn_sd_rad: Array,
        settings: BodySensorSettings = BodySensorSettings(),
    ) -> None:
        """Makes the block.

        Args:
            sensor: The sensors on the body, as calibrated.
            bias_rad_s: (S, 3) gyroscopes' biases at the start.
            bias_sd_rad_s: (S, 3) their standard deviations.
            turn_sd_rad: (S, 3) standard deviation of each mount's turn about its segment's axes.
            settings: Noise.
        """
        s, count = settings, 3 * len(sensor.mounts)
        self.sensor, self.settings = sensor, settings
        self._states = (
            ExtraState(BIASES, bias_rad_s.ravel(), bias_sd_rad_s.ravel(), np.full(count, s.bias_walk)),
            ExtraState(TURNS, np.zeros(count), turn_sd_rad.ravel(), np.full(count, s.turn_walk)),
        )
        self._mounted = quaternion_matrices(np.array([mount.rotation for mount in sensor.mounts]))
        deviations = np.repeat([s.worn_rate_sd_rad_s, s.worn_force_sd_m_s2], 3)
        self._weight = np.tile(1.0 / deviations, len(sensor.mounts))
        self._table = WornTable(
            np.array([sensor.model.joint(mount.segment).joint_id for mount in sensor.mounts], dtype=np.int32),
            np.array([mount.position_m for mount in sensor.mounts], dtype=float).reshape(-1, 3),
            self._mounted,
            self._weight,
        )
        self._observed = observed_dofs(sensor.model, [mount.segment for mount in sensor.mounts])

    def states(self) -> Sequence[ExtraState]:
        """Biases and turns."""
        return self._states

    def decide(
        self, at: OperatingPoint[LoadedState, None], frame: Frame, memory: None, notes: Notes
    ) -> Array | None:
        """The frame's readings (S, 6), None without any; the joints that they observe are noted."""
        if frame.imus is None or not np.isfinite(frame.imus).any():
            return None
        notes.imus, notes.observed = frame.imus, True
        notes.unobserved = notes.unmarked[~self._observed[notes.unmarked]]
        return frame.imus

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: Array | None) -> Rows | None:
        """Rows on the whole state; missing readings are left out, component by component."""
        if decision is None:
            return None
        state, layout = at.state, self.layout
        bias, turn = (state.extra[layout.extra_index(name)].reshape(-1, 3) for name in (BIASES, TURNS))
        tree = self.sensor.model.tree
        if tree is None:
            rows, innovation = self._reference_rows(state, bias, turn, decision)
        else:
            places = layout[BIASES].start, layout[TURNS].start, layout.size
            rows, innovation = tree.worn(
                (state.q, state.v, state.a), self._table, (bias, turn, decision), places
            )
        there = np.isfinite(innovation)
        if not there.all():
            rows, innovation = rows[there], innovation[there]
        return Rows(rows, innovation, readings=len(innovation))

    def _reference_rows(
        self, state: LoadedState, bias: Array, turn: Array, measured: Array
    ) -> tuple[Array, Array]:
        """(6 S, N) whitened rows and (6 S,) innovations, NaN of missing readings.

        Args:
            state: The state.
            bias: (S, 3) of the gyroscopes.
            turn: (S, 3) of the mounts.
            measured: (S, 6) readings.
        """
        layout, count = self.layout, len(self.sensor.mounts)
        reading = self.sensor.reading(state.q, state.v, state.a)
        exponential, left = exponential_and_left_jacobian(turn)
        since = exponential @ self._mounted
        turned = since.transpose(0, 2, 1) @ self._mounted
        values = (turned[:, None] @ reading.values.reshape(count, 2, 3, 1))[..., 0]
        motion = reading.jacobian.reshape(count, 2, 3, -1)
        jacobian = np.zeros((count, 2, 3, layout.size))
        jacobian[..., : motion.shape[-1]] = turned[:, None] @ motion
        each = np.arange(count)
        jacobian[..., layout[BIASES]].reshape(count, 2, 3, count, 3)[each, 0, :, each] = np.eye(3)
        jacobian[..., layout[TURNS]].reshape(count, 2, 3, count, 3)[each, :, :, each] = _by_turn(
            since, left, values
        )
        values[:, 0] += bias
        short = measured.reshape(-1) - values.reshape(-1)
        return jacobian.reshape(len(short), -1) * self._weight[:, None], short * self._weight


def _by_turn(since: Array, left: Array, values: Array) -> Array:
    """(S, 2, 3, 3) derivatives of turned readings by the turns.

    With R = Exp(θ) R₀, ∂(Rᵀ x)/∂θ = Rᵀ [x]ₓ J(θ), J the left Jacobian of the exponential.

    Args:
        since: (S, 3, 3) R.
        left: (S, 3, 3) J.
        values: (S, 2, 3) the readings Rᵀ x.
    """
    in_segment = (since[:, None] @ values[..., None])[..., 0]
    return np.asarray(since.transpose(0, 2, 1)[:, None] @ skew(in_segment) @ left[:, None])
