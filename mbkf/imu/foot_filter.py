"""Error-state Kalman filter of a foot: the readings are integrated, and whenever the foot stands its velocity is zero.

Foxlin, *Pedestrian tracking with shoe-mounted inertial sensors*, IEEE CG&A 25 (2005). The error state is
(δv, δp, δθ, δb_g, δb_a): velocity and position in the world (z up, heading free), rotation in the sensor's axes,
R = R̂ exp(δθ), and the biases of gyroscope and accelerometer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.imu.frames import attitude
from mbkf.imu.zero_velocity import phases
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.kalman import Information, correct

SIZE = 15
V, P, ROTATION, GYRO_BIAS, ACC_BIAS = (slice(k, k + 3) for k in range(0, SIZE, 3))
"""Places of the parts in the error state."""

READ = P.stop
"""Readings are of the first components, velocity and position."""

LEVEL_M = 0.02
"""Usual standard deviation of a resting foot's height on a level floor: its posture differs from stride to stride."""

_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class FootFilterSettings:
    """Noise of a foot-mounted sensor, and how much a standing foot may move.

    Attributes:
        acceleration_noise: Random walk of the velocity, (m/s²)/√Hz. Far above the sensor's white noise: it stands for
            heel strikes, which ordinary sensors clip and alias.
        angular_noise: Random walk of the orientation, (rad/s)/√Hz.
        gyro_bias_walk: Random walk of the gyroscope's bias, (rad/s)/√s.
        standing_speed_m_s: Standard deviation of a standing foot's velocity, per component and sample.
        tilt_rad, gyro_bias_rad_s, acceleration_bias_m_s2: Standard deviations at the start.
        rest_for_bias_s: If the capture starts with a rest at least this long, the gyroscope's median in it is its bias.
        rested_gyro_bias_rad_s: Standard deviation of that median.
        gate: Bound on the normalised innovation squared (3 degrees of freedom) of a zero velocity; above it the foot
            does not count as standing, since steady motion without rotation looks like rest.
        insist_s: A rest that lasts longer is accepted at any estimated velocity; so is the second of two in a row.
        level_m: On level ground, the standard deviation of the height of a resting foot, per sample; None where the
            ground may rise.
    """

    acceleration_noise: float = 0.25
    angular_noise: float = 0.01
    gyro_bias_walk: float = 1e-4
    standing_speed_m_s: float = 0.03
    tilt_rad: float = 0.03
    gyro_bias_rad_s: float = 0.02
    acceleration_bias_m_s2: float = 0.1
    rest_for_bias_s: float = 0.5
    rested_gyro_bias_rad_s: float = 0.003
    gate: float = 50.0
    insist_s: float = 0.5
    level_m: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None and not (np.isfinite(value) and value > 0.0):
                raise InvalidInput(f"{name} must be positive, got {value}")


class FootState(NamedTuple):
    """Velocity (3,) m/s and position (3,) m in the world, rotation sensor → world (3, 3), biases (3,)."""

    velocity: Array
    position: Array
    rotation: Array
    gyro_bias: Array
    acceleration_bias: Array

    def moved(self, error: Array) -> FootState:
        """The state that differs by an error (15,)."""
        return FootState(
            self.velocity + error[V],
            self.position + error[P],
            self.rotation @ pin.exp3(error[ROTATION]),
            self.gyro_bias + error[GYRO_BIAS],
            self.acceleration_bias + error[ACC_BIAS],
        )

    def error_of(self, other: FootState) -> Array:
        """(15,) the error that moves this state to the other."""
        return np.concatenate(
            [
                other.velocity - self.velocity,
                other.position - self.position,
                pin.log3(self.rotation.T @ other.rotation),
                other.gyro_bias - self.gyro_bias,
                other.acceleration_bias - self.acceleration_bias,
            ]
        )


def predict(state: FootState, f: Array, w: Array, dt_s: float) -> tuple[FootState, Array]:
    """One step of strapdown integration, and its transition matrix.

    Args:
        state: Before the step.
        f: (3,) mean specific force over the step, m/s².
        w: (3,) mean angular velocity over the step, rad/s.
        dt_s: Length of the step.

    Returns:
        The state after it, and Φ (15, 15), the derivative of its error by the error before.
    """
    turn = dt_s * (w - state.gyro_bias)
    half = pin.exp3(0.5 * turn)
    middle = state.rotation @ half
    own = f - state.acceleration_bias
    a = middle @ own - GRAVITY_M_S2 * _UP
    after = FootState(
        state.velocity + dt_s * a,
        state.position + dt_s * (state.velocity + 0.5 * dt_s * a),
        middle @ half,
        state.gyro_bias,
        state.acceleration_bias,
    )
    Phi = np.eye(SIZE)
    Phi[V, ROTATION] = -dt_s * state.rotation @ pin.skew(half @ own)
    Phi[V, GYRO_BIAS] = 0.5 * dt_s**2 * middle @ pin.skew(own) @ pin.Jexp3(0.5 * turn)
    Phi[V, ACC_BIAS] = -dt_s * middle
    Phi[ROTATION, ROTATION] = (half @ half).T
    Phi[ROTATION, GYRO_BIAS] = -dt_s * pin.Jexp3(turn)
    Phi[P, READ:] = 0.5 * dt_s * Phi[V, READ:]
    Phi[P, V] = dt_s * np.eye(3)
    return after, Phi


@dataclass(frozen=True)
class FootStep:
    """One sample of the filter's run.

    Attributes:
        state: After the sample's reading.
        P: (15, 15) its covariance.
        Phi: (15, 15) transition from the sample before.
        reading: Information of the rest on (δv, δp), None where the foot did not rest.
    """

    state: FootState
    P: Array
    Phi: Array
    reading: Information | None


@dataclass(frozen=True)
class FootRun:
    """The filter's whole run.

    Attributes:
        first: Sample at which it starts, the first of the first rest.
        steps: One per sample from there on.
        still: (T,) samples that the filter accepted as rest.
        refused: Samples that looked like rest but contradicted the estimated velocity.
    """

    first: int
    steps: tuple[FootStep, ...]
    still: BoolArray
    refused: int


def follow_foot(
    specific_force_mps2: Array,
    angular_velocity_rad_s: Array,
    rate_hz: float,
    still: BoolArray,
    settings: FootFilterSettings,
) -> FootRun:
    """Runs the filter from the first rest to the end.

    Args:
        specific_force_mps2: (T, 3) sensor axes, without gaps.
        angular_velocity_rad_s: (T, 3) sensor axes, without gaps.
        rate_hz: Sample rate.
        still: (T,) samples that look like rest.
        settings: Noise.

    Raises:
        InvalidInput: The foot never rests.
    """
    f, w, dt = specific_force_mps2, angular_velocity_rad_s, 1.0 / rate_hz
    rests = phases(still)
    if not rests:
        raise InvalidInput("the foot never stands still, so nothing holds its velocity; check rate and units")
    first, stop = rests[0]
    state, covariance = _start(f[first:stop], w[first:stop], rate_hz, settings)
    noise = _plant_noise(settings, dt)
    insist = round(settings.insist_s * rate_hz)
    accepted = np.zeros(len(still), dtype=bool)
    steps: list[FootStep] = []
    doubted = refused = 0
    Phi = np.eye(SIZE)
    for k in range(first, len(f)):
        if k > first:
            state, Phi = predict(state, 0.5 * (f[k - 1] + f[k]), 0.5 * (w[k - 1] + w[k]), dt)
            covariance = Phi @ covariance @ Phi.T + noise
        reading = None
        if still[k]:
            if _may_rest(state, covariance, settings):
                doubted = 0
            elif doubted and not still[k - 1]:
                doubted = insist + 1  # the rest before contradicted the velocity, too
            else:
                doubted += 1
            if 0 < doubted <= insist:
                refused += 1
            else:
                reading = _rest(state, settings)
                found = correct(covariance, reading)
                state, covariance = state.moved(found.step), found.covariance
        accepted[k] = reading is not None
        steps.append(FootStep(state, covariance, Phi, reading))
    return FootRun(first, tuple(steps), accepted, refused)


def _may_rest(state: FootState, covariance: Array, settings: FootFilterSettings) -> bool:
    """Whether a velocity of zero is within the gate."""
    S = covariance[V, V] + settings.standing_speed_m_s**2 * np.eye(3)
    return float(state.velocity @ np.linalg.solve(S, state.velocity)) <= settings.gate


def _rest(state: FootState, settings: FootFilterSettings) -> Information:
    """Pseudo-reading of a rest: velocity zero, and on level ground height zero."""
    certainty = np.zeros(READ)
    certainty[V] = settings.standing_speed_m_s**-2
    if settings.level_m is not None:
        certainty[P.stop - 1] = settings.level_m**-2
    off = -np.concatenate([state.velocity, state.position])
    return Information(
        np.diag(certainty), certainty * off, float(off @ (certainty * off)), int((certainty > 0).sum())
    )


def _start(f: Array, w: Array, rate_hz: float, settings: FootFilterSettings) -> tuple[FootState, Array]:
    """State and covariance in the first rest: level by the accelerometer, heading and place by definition.

    Medians, because a rest often ends with the first shift of weight.
    """
    long = len(w) >= settings.rest_for_bias_s * rate_hz
    rotation = quaternion_matrices(attitude(np.median(f, axis=0)))
    zero = np.zeros(3)
    state = FootState(zero, zero, rotation, np.median(w, axis=0) if long else zero, zero)
    sd = np.zeros(SIZE)
    sd[V] = settings.standing_speed_m_s
    sd[GYRO_BIAS] = settings.rested_gyro_bias_rad_s if long else settings.gyro_bias_rad_s
    sd[ACC_BIAS] = settings.acceleration_bias_m_s2
    sd[P] = 1e-6
    covariance = np.diag(sd**2)
    level = settings.tilt_rad**2 * (np.eye(3) - np.outer(_UP, _UP)) + 1e-12 * np.eye(3)
    covariance[ROTATION, ROTATION] = rotation.T @ level @ rotation
    return state, covariance


def _plant_noise(settings: FootFilterSettings, dt: float) -> Array:
    """(15, 15) covariance that one step adds."""
    noise = np.zeros(SIZE)
    noise[V] = settings.acceleration_noise**2 * dt
    noise[ROTATION] = settings.angular_noise**2 * dt
    noise[GYRO_BIAS] = settings.gyro_bias_walk**2 * dt
    matrix = np.diag(noise)
    matrix[P, P] = np.eye(3) * settings.acceleration_noise**2 * dt**3 / 3.0
    matrix[P, V] = matrix[V, P] = np.eye(3) * settings.acceleration_noise**2 * dt**2 / 2.0
    return matrix
