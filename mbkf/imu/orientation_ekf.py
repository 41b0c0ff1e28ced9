"""Error-state Kalman filter of orientation, gyroscope bias and velocity, for many sensors side by side.

Gravity is split from linear acceleration because a limb stays about where it is: the specific force, turned into the
world and less gravity, is integrated to a velocity, and a pseudo-reading of zero velocity has a spread that follows the
present movement (adaptive to linear acceleration). The field is read as a heading only, so that it cannot
tilt the estimate, and with less weight the more its strength and dip differ from their running means (adaptive to
magnetic disturbance). Errors are small rotations in the world: R = Exp(δ) R̂. Departs from Madgwick eqs. 17–20, whose
state is the quaternion alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.frames import attitude, exponential, multiply
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.rotations import skew

ERRORS = 9
"""Components of the error: rotation in the world (rad), gyroscope bias (rad/s), velocity (m/s)."""

MOST_HEADING_SD_RAD = 1.8
"""Spread of a heading of which nothing is known: even over all directions."""

_NO_READING = 1e9
"""Variance of a reading that is not there."""


@dataclass(frozen=True)
class OrientationSettings:
    """Noise and disturbances that the filter assumes; one set for every sensor, from data sheets and human movement.

    Attributes:
        gyro_noise: White noise of the gyroscope, misalignment of its axes included, rad/s/√Hz.
        gyro_scale_noise: Further noise per rad/s of turning (scale error), 1/√Hz.
        bias_walk: Random walk of the gyroscope's bias, rad/s/√s.
        accelerometer_noise: White noise of the accelerometer, m/s²/√Hz.
        start_tilt_sd_rad, start_heading_sd_rad, start_bias_sd_rad_s: Spread at the first sample.
        moving_start_s: Further tilt at the first sample per rad/s of turning.
        limb_m: Further speed at the first sample per rad/s of turning.
        moving_start_m_s: Further speed at the first sample per g by which the specific force differs from gravity.
        velocity_sd_m_s: Usual speed of a moving body part; its readings are independent after ``velocity_memory_s``.
        velocity_memory_s: See above.
        still_velocity_sd_m_s: The same for a body part whose specific force is that of rest.
        acceleration_memory_s: How long a movement is remembered to last; short enough to notice a foot that stands.
        turning_mps: Acceleration that a turn of 1 rad/s counts for as movement, m/s.
        heading_sd_rad: Error of a magnetic heading, correlated over ``heading_memory_s``.
        heading_memory_s: See above.
        field_tolerance: Relative change of the field's strength that counts as a disturbance of size 1.
        dip_tolerance_rad: Change of its dip that does.
        field_memory_s: Time in which a new field becomes the usual one.
        spread_scale: Factor on the filter's own spread. All noises are larger than they are by its inverse; only their
            ratios matter to estimates. This and the following five make the stated spread
            (:mod:`mbkf.imu.orientation_spread`); estimates do not depend on them.
        accelerometer_offset_mps2: Offset that a calibration leaves, m/s².
        field_offset: Offset of the magnetometer, by iron that turns with it, as a share of the field's strength.
        field_direction_sd_rad: Lasting bend of the field's direction by iron in a room.
        field_delay_s: Delay of fields behind angular velocities.
        clock_sd_s: Delay of the sensor's times behind those of its motion, by its low-pass filter and its clock.
        integrating: Whether a reading is the mean since the one before, as digital sensors give it (on BROAD this
            halves the error that the other reading leaves), or the value at its time, as virtual sensors have it.
        rest_bias: Whether a sensor that lies still is taken not to turn at all. A slow steady turn looks the same:
            leave it out for a sensor on a turntable.
        rest_rate_rad_s, rest_force_mps2, rest_after_s: A sensor lies still when neither reading differs from its own
            running mean by more than these for that long.
    """

    gyro_noise: float = 2e-3
    gyro_scale_noise: float = 1.75e-3
    bias_walk: float = 5e-5
    accelerometer_noise: float = 0.05
    start_tilt_sd_rad: float = 0.1
    start_heading_sd_rad: float = 0.2
    start_bias_sd_rad_s: float = 0.01
    moving_start_s: float = 0.06
    limb_m: float = 0.8
    moving_start_m_s: float = 2.0
    velocity_sd_m_s: float = 0.6
    velocity_memory_s: float = 0.2
    still_velocity_sd_m_s: float = 0.1
    acceleration_memory_s: float = 0.15
    turning_mps: float = 3.0
    heading_sd_rad: float = 0.1
    heading_memory_s: float = 1.0
    field_tolerance: float = 0.1
    dip_tolerance_rad: float = 0.15
    field_memory_s: float = 20.0
    spread_scale: float = 0.75
    accelerometer_offset_mps2: float = 0.022
    field_offset: float = 0.0185
    field_direction_sd_rad: float = 0.012
    field_delay_s: float = 0.01
    clock_sd_s: float = 0.0018
    integrating: bool = True
    rest_bias: bool = True
    rest_rate_rad_s: float = 0.035
    rest_force_mps2: float = 0.5
    rest_after_s: float = 1.5


class OrientationState(NamedTuple):
    """N sensors after a sample.

    Attributes:
        quaternion: (N, 4) sensor → NWU.
        gyro_bias: (N, 3) rad/s.
        velocity: (N, 3) in the world, m/s.
        P: (N, 9, 9) covariance of the error.
        movement: (N,) mean square of recent movement: departure of the specific force from gravity, and turning, m²/s⁴.
        field: (N, 2) usual strength and dip (rad) of the field; NaN where the sensor saw no field.
        calm: (N, 7) running mean of gyroscope and accelerometer, and for how long they have been near it, s.
        last: (N, 6) the sample's angular velocity (sensor axes, bias included) and specific force (world axes).
    """

    quaternion: Array
    gyro_bias: Array
    velocity: Array
    P: Array
    movement: Array
    field: Array
    calm: Array
    last: Array


class Passage(NamedTuple):
    """One step, as a smoother needs it: posterior, prior covariance, Φ (N, 9, 9) and the correction (N, 9)."""

    state: OrientationState
    prior: Array
    transition: Array
    correction: Array


class OrientationFilter:
    """The filter for N sensors sampled together; its steps are pure.

    Attributes:
        dt_s: Time between samples.
        settings: Its noise model.
    """

    def __init__(self, dt_s: float, settings: OrientationSettings | None = None) -> None:
        self.dt_s, self.settings = dt_s, settings or OrientationSettings()
        s = self.settings
        self._velocity = s.velocity_memory_s / dt_s
        self._heading = s.heading_sd_rad**2 * s.heading_memory_s / dt_s
        self._gravity = np.array([0.0, 0.0, GRAVITY_M_S2])
        self._noise = np.repeat([0.0, s.bias_walk**2 * dt_s, s.accelerometer_noise**2 * dt_s], 3)
        self._moved = 1.0 - np.exp(-dt_s / s.acceleration_memory_s)
        self._calm = 1.0 - np.exp(-dt_s / (0.5 * s.rest_after_s))

    def begin(
        self, specific_force: Array, magnetic_field: Array | None = None, gyro: Array | None = None
    ) -> OrientationState:
        """State from one reading of each sensor, no NaN; a moving sensor's direction of gravity is doubted.

        Args:
            specific_force: (N, 3) m/s².
            magnetic_field: (N, 3) µT, or None.
            gyro: (N, 3) rad/s; None for sensors at rest.
        """
        quaternion = attitude(specific_force, magnetic_field)
        n, s = len(quaternion), self.settings
        heading = s.start_heading_sd_rad
        sd = np.repeat([s.start_tilt_sd_rad, s.start_bias_sd_rad_s, s.velocity_sd_m_s], 3)
        sd[2] = heading
        nothing = np.zeros((n, 3))
        spread = np.tile(sd, (n, 1))
        rate = nothing if gyro is None else np.asarray(gyro)
        shaken = np.sqrt((specific_force**2).sum(axis=1)) / GRAVITY_M_S2 - 1.0
        doubt = np.abs(shaken) + s.moving_start_s * np.sqrt((rate**2).sum(axis=1))
        spread[:, :2] = np.minimum(np.hypot(spread[:, :2], doubt[:, None]), 1.0)
        tilted = spread[:, 0] ** 2
        swing = s.limb_m * np.sqrt((rate**2).sum(axis=1))
        spread[:, 6:] = np.hypot(
            spread[:, 6:], (swing + s.moving_start_m_s * np.minimum(np.abs(shaken), 1.0))[:, None]
        )
        field = np.full((n, 3), np.nan)
        if magnetic_field is not None:
            field[:, :2] = _strength_and_dip(
                (quaternion_matrices(quaternion) @ magnetic_field[:, :, None])[:, :, 0]
            )
            field[:, 2] = self.dt_s * self._upright(tilted)
            # A wrong tilt turns the level part of the field.
            spread[:, 2] = np.minimum(
                np.sqrt(spread[:, 2] ** 2 + tilted * _steepness(field[:, 1])), MOST_HEADING_SD_RAD
            )
        calm = np.hstack([nothing, specific_force, np.zeros((n, 1))])
        return OrientationState(
            quaternion,
            nothing,
            nothing,
            spread[:, :, None] ** 2 * np.eye(ERRORS),
            (GRAVITY_M_S2 * shaken) ** 2 + (s.turning_mps * rate) ** 2 @ np.ones(3),
            field,
            calm,
            np.hstack([rate, np.tile(self._gravity, (n, 1))]),
        )

    def step(
        self,
        state: OrientationState,
        gyro: Array,
        specific_force: Array,
        magnetic_field: Array | None = None,
    ) -> OrientationState:
        """The state one sample later.

        Args:
            state: Before the sample.
            gyro: (N, 3) angular velocity, rad/s, NaN where missing.
            specific_force: (N, 3) m/s², NaN where missing.
            magnetic_field: (N, 3) µT, NaN where missing; None without magnetometers.
        """
        return self.passage(state, gyro, specific_force, magnetic_field).state

    def run(
        self,
        gyro: Array,
        specific_force: Array,
        magnetic_field: Array | None = None,
        start: OrientationState | None = None,
    ) -> Iterator[Passage]:
        """The steps of all samples after the first.

        Args:
            gyro: (T, N, 3) angular velocity, rad/s, NaN where missing.
            specific_force: (T, N, 3) m/s², NaN where missing.
            magnetic_field: (T, N, 3) µT, NaN where missing; None without magnetometers.
            start: State at the first sample; by default that of sensors at rest with its readings.
        """
        field = None if magnetic_field is None else magnetic_field[0]
        state = self.begin(specific_force[0], field) if start is None else start
        for k in range(1, len(gyro)):
            mag = None if magnetic_field is None else magnetic_field[k]
            passage = self.passage(state, gyro[k], specific_force[k], mag)
            state = passage.state
            yield passage

    def passage(
        self, state: OrientationState, gyro: Array, specific_force: Array, magnetic_field: Array | None
    ) -> Passage:
        """One step with all that a smoother needs.

        Args:
            state: Before the sample.
            gyro: (N, 3) angular velocity, rad/s, NaN where missing.
            specific_force: (N, 3) m/s², NaN where missing.
            magnetic_field: (N, 3) µT, NaN where missing; None without magnetometers.
        """
        s, dt = self.settings, self.dt_s
        turning = np.all(np.isfinite(gyro), axis=1)
        forced = np.all(np.isfinite(specific_force), axis=1)
        now = np.where(turning[:, None], gyro, state.gyro_bias)
        mean = now if s.integrating else 0.5 * (now + state.last[:, :3])
        rate = mean - state.gyro_bias
        q = multiply(state.quaternion, exponential(dt * rate))
        R = quaternion_matrices(q)
        force = np.where(
            forced[:, None], (R @ np.nan_to_num(specific_force)[:, :, None])[:, :, 0], self._gravity
        )
        pushed = force if s.integrating else 0.5 * (force + state.last[:, 3:])
        velocity = state.velocity + dt * (pushed - self._gravity)
        phi = np.zeros((len(q), ERRORS, ERRORS))
        phi.reshape(len(q), -1)[:, :: ERRORS + 1] = 1.0
        phi[:, :3, 3:6] = -dt * R
        phi[:, 6:, :3] = -dt * skew(force)
        P = phi @ state.P @ phi.transpose(0, 2, 1)
        P = 0.5 * (P + P.transpose(0, 2, 1))  # rounding that is not symmetric would grow
        diagonal = P.reshape(len(q), -1)[:, :: ERRORS + 1]
        diagonal += self._noise
        turned = (rate * rate).sum(axis=1) * s.gyro_scale_noise**2 + s.gyro_noise**2
        diagonal[:, :3] += (dt * np.where(turning, turned, 1.0))[:, None]
        prior = P
        size = np.sqrt((force * force).sum(axis=1)) - GRAVITY_M_S2
        present = size * size + s.turning_mps * s.turning_mps * (rate * rate).sum(axis=1)
        movement = state.movement + self._moved * (present - state.movement)
        P, dx = self._held_back(P, velocity, movement)
        field = state.field
        if magnetic_field is not None:
            P, dx, field = self._headed(P, dx, R, magnetic_field, field)
        calm = state.calm
        if s.rest_bias:
            P, dx, calm = self._rested(P, dx, state, gyro, specific_force)
        q = multiply(exponential(dx[:, :3]), q)
        q /= np.sqrt((q * q).sum(axis=1, keepdims=True))
        after = OrientationState(
            q, state.gyro_bias + dx[:, 3:6], velocity + dx[:, 6:], P, movement, field, calm,
            np.hstack([now, force]),
        )  # fmt: skip
        return Passage(after, prior, phi, dx)

    def _held_back(self, P: Array, velocity: Array, movement: Array) -> tuple[Array, Array]:
        """The velocity read as zero, with the spread that the present movement gives it."""
        s = self.settings
        spread = np.minimum(
            s.still_velocity_sd_m_s**2 + s.velocity_memory_s**2 * movement, s.velocity_sd_m_s**2
        )
        PH = P[:, :, 6:]
        S = PH[:, 6:] + (spread * self._velocity)[:, None, None] * np.eye(3)
        K = np.linalg.solve(S, PH.transpose(0, 2, 1)).transpose(0, 2, 1)
        P = P - K @ PH.transpose(0, 2, 1)
        return P, -(K @ velocity[:, :, None])[:, :, 0]

    def _headed(
        self, P: Array, dx: Array, R: Array, magnetic_field: Array, usual: Array
    ) -> tuple[Array, Array, Array]:
        """The field read as a heading."""
        s = self.settings
        seen = np.all(np.isfinite(magnetic_field), axis=1)
        field = (R @ np.nan_to_num(magnetic_field)[:, :, None])[:, :, 0]
        found = _strength_and_dip(field)
        first = np.isnan(usual[:, 0]) & seen
        known = np.where(first[:, None], found, usual[:, :2])
        tilted = 0.5 * (P[:, 0, 0] + P[:, 1, 1])
        strength = (found[:, 0] / known[:, 0] - 1.0) / s.field_tolerance
        dip = (found[:, 1] - known[:, 1]) ** 2 / (s.dip_tolerance_rad**2 + tilted)
        disturbance = strength * strength + dip
        noise = self._heading * (1.0 + disturbance) ** 2
        noise += s.heading_memory_s / self.dt_s * tilted * _steepness(known[:, 1])
        noise = np.where(seen, noise, _NO_READING)
        weight = seen * self.dt_s * self._upright(tilted)
        lasted = np.minimum(np.where(first, 0.0, np.nan_to_num(usual[:, 2])) + weight, s.field_memory_s)
        gain = weight / np.maximum(lasted, 1e-12)
        learnt = np.column_stack([known + gain[:, None] * (found - known), lasted])
        innovation = np.where(seen, -np.arctan2(field[:, 1], field[:, 0]) - dx[:, 2], 0.0)
        return *_read_one(P, dx, 2, _turned_back(innovation), noise), np.where(seen[:, None], learnt, usual)

    def _upright(self, tilted: Array) -> Array:
        """(N,) weight of a field's strength and dip while the tilt has a variance (N,), rad²."""
        s = self.settings
        return np.asarray(s.dip_tolerance_rad**2 / (s.dip_tolerance_rad**2 + tilted))

    def _rested(
        self, P: Array, dx: Array, state: OrientationState, gyro: Array, force: Array
    ) -> tuple[Array, Array, Array]:
        """A still gyroscope reads its bias."""
        s, calm = self.settings, state.calm
        now = np.hstack([gyro, force])
        apart = np.abs(now - calm[:, :6])
        near = (apart[:, :3] < s.rest_rate_rad_s).all(axis=1) & (apart[:, 3:] < s.rest_force_mps2).all(axis=1)
        mean = calm[:, :6] + self._calm * (np.nan_to_num(now, nan=0.0) - calm[:, :6])
        mean = np.where(np.isfinite(now), mean, calm[:, :6])
        since = np.where(near, calm[:, 6] + self.dt_s, 0.0)
        noise = np.where(since >= s.rest_after_s, s.gyro_noise**2 / self.dt_s, _NO_READING)
        for axis in range(3):
            innovation = np.nan_to_num(gyro[:, axis] - state.gyro_bias[:, axis]) - dx[:, 3 + axis]
            P, dx = _read_one(P, dx, 3 + axis, innovation, noise)
        return P, dx, np.hstack([mean, since[:, None]])


def _read_one(P: Array, dx: Array, index: int, innovation: Array, variance: Array) -> tuple[Array, Array]:
    """One error component read: covariance (N, 9, 9) and estimate (N, 9) after it."""
    column = P[:, :, index]
    gain = column / (column[:, index] + variance)[:, None]
    return P - gain[:, :, None] * column[:, None, :], dx + gain * innovation[:, None]


def _strength_and_dip(field: Array) -> Array:
    """(N, 2) of fields in the world (N, 3)."""
    level = np.hypot(field[:, 0], field[:, 1])
    return np.stack([np.hypot(level, field[:, 2]), np.arctan2(field[:, 2], level)], axis=1)


def _steepness(dip: Array) -> Array:
    """(N,) squared change of a heading by tilt at a dip, rad: as at 60 deg or more, and less than at the poles."""
    return np.tan(np.clip(np.abs(dip), 1.05, 1.4)) ** 2


def _turned_back(angle: Array) -> Array:
    return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
