"""Error-state Kalman filter of a foot: the readings are integrated, and whenever the foot stands its velocity is zero.

Foxlin, *Pedestrian tracking with shoe-mounted inertial sensors*, IEEE CG&A 25 (2005). The error state is
(δv, δp, δr, δθ, δb_g, δb_a): velocity and position in the world (z up, heading free), the lever r in the sensor's axes
from where the foot rolls on the ground to the sensor, rotation in the sensor's axes, R = R̂ exp(δθ), and the biases of
gyroscope and accelerometer. A foot in stance turns about a place on the ground, so that v = R ((ω − b_g) × r): zero
where it stands, and known where it rolls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.imu.frames import attitude
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.kalman import Information, correct
from mbkf.numerics.runs import runs

SIZE = 18
V, P, LEVER, ROTATION, GYRO_BIAS, ACC_BIAS = (slice(k, k + 3) for k in range(0, SIZE, 3))
"""Places of the parts in the error state."""

READ = LEVER.stop
"""Readings are of the first components: velocity, position and lever."""

LEVEL_M = 0.02
"""Usual standard deviation of a resting foot's height on a level floor: its posture differs from stride to stride."""

_UP = np.array([0.0, 0.0, 1.0])
_EARLY_S = 3.0
"""Time in which a foot that never rests stands at least once."""


@dataclass(frozen=True)
class FootFilterSettings:
    """Noise of a foot-mounted sensor, and how much a standing foot may move.

    Attributes:
        acceleration_noise: Random walk of the velocity, (m/s²)/√Hz, in smooth motion.
        roughness: Share of the second difference of the specific force that is not known of a sample: heel strikes are
            shorter than samples, and ordinary sensors clip and alias them.
        angular_noise: Random walk of the orientation, (rad/s)/√Hz.
        gyro_bias_walk: Random walk of the gyroscope's bias, (rad/s)/√s.
        standing_speed_m_s: Standard deviation of a standing foot's velocity, per component.
        rolling_m: The same per angular velocity of the foot, m: the place on which it rolls changes.
        standing_memory_s: Velocities of a standing foot further apart than this are independent.
        rolling_speed_m_s, rolling_tilt_rad: Standard deviations of velocity and tilt at the start of a capture in which
            the foot never rests.
        lost_speed_m_s: Standard deviation of the velocity where a rest is believed against it.
        lever_m, lever_walk_m: Standard deviation of the lever at the start, and its random walk, m/√s.
        tilt_rad, gyro_bias_rad_s, acceleration_bias_m_s2: Standard deviations at the start.
        rest_for_bias_s: If the capture starts with a rest at least this long, the gyroscope's median in it is its bias.
        rested_gyro_bias_rad_s: Standard deviation of that median.
        gate: Bound on the normalised innovation squared (3 degrees of freedom) of a zero velocity; above it the foot
            does not count as standing, since steady motion without rotation looks like rest.
        rolling_gate: The same of a stance in which the foot turns.
        insist_s: A rest that lasts longer is accepted at any estimated velocity; so is the second of two in a row.
        level_m: On level ground, the standard deviation of the height of a resting foot, per sample; None where the
            ground may rise.
    """

    acceleration_noise: float = 0.03
    roughness: float = 0.1
    angular_noise: float = 0.005
    gyro_bias_walk: float = 1e-4
    standing_speed_m_s: float = 0.01
    rolling_m: float = 0.03
    standing_memory_s: float = 0.1
    rolling_speed_m_s: float = 0.3
    rolling_tilt_rad: float = 0.2
    lost_speed_m_s: float = 2.0
    lever_m: float = 0.1
    lever_walk_m: float = 0.03
    tilt_rad: float = 0.03
    gyro_bias_rad_s: float = 0.02
    acceleration_bias_m_s2: float = 0.1
    rest_for_bias_s: float = 0.5
    rested_gyro_bias_rad_s: float = 0.003
    gate: float = 50.0
    rolling_gate: float = 12.0
    insist_s: float = 0.5
    level_m: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is not None and not (np.isfinite(value) and value > 0.0):
                raise InvalidInput(f"{name} must be positive, got {value}")


class FootState(NamedTuple):
    """Velocity (3,) m/s and position (3,) m in the world, lever (3,) m, rotation sensor → world (3, 3), biases (3,)."""

    velocity: Array
    position: Array
    lever: Array
    rotation: Array
    gyro_bias: Array
    acceleration_bias: Array

    def moved(self, error: Array) -> FootState:
        """The state that differs by an error (18,)."""
        return FootState(
            self.velocity + error[V],
            self.position + error[P],
            self.lever + error[LEVER],
            self.rotation @ pin.exp3(error[ROTATION]),
            self.gyro_bias + error[GYRO_BIAS],
            self.acceleration_bias + error[ACC_BIAS],
        )

    def error_of(self, other: FootState) -> Array:
        """(18,) the error that moves this state to the other."""
        return np.concatenate(
            [
                other.velocity - self.velocity,
                other.position - self.position,
                other.lever - self.lever,
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
        The state after it, and Φ (18, 18), the derivative of its error by the error before.
    """
    turn = dt_s * (w - state.gyro_bias)
    half = pin.exp3(0.5 * turn)
    middle = state.rotation @ half
    own = f - state.acceleration_bias
    a = middle @ own - GRAVITY_M_S2 * _UP
    after = FootState(
        state.velocity + dt_s * a,
        state.position + dt_s * (state.velocity + 0.5 * dt_s * a),
        state.lever,
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
    Phi[P, ROTATION.start :] = 0.5 * dt_s * Phi[V, ROTATION.start :]
    Phi[P, V] = dt_s * np.eye(3)
    return after, Phi


@dataclass(frozen=True)
class FootStep:
    """One sample of the filter's run.

    Attributes:
        state: After the sample's reading.
        P: (18, 18) its covariance.
        Phi: (18, 18) transition from the sample before.
        reading: Information of the stance on (δv, δp, δr); None: the foot did not stand.
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
        still: (T,) samples that the filter accepted as stance.
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
    rolling: BoolArray | None = None,
    turn_variance: Array | None = None,
) -> FootRun:
    """Runs the filter from the first rest to the end.

    Args:
        specific_force_mps2: (T, 3) sensor axes, without gaps.
        angular_velocity_rad_s: (T, 3) sensor axes, without gaps.
        rate_hz: Sample rate.
        still: (T,) samples that look like rest.
        settings: Noise.
        rolling: (T,) samples in which the foot may stand though it turns; by default, never.
        turn_variance: (T, 3) variance of each sample's turn beyond the gyroscope's noise, rad²; by default, zero.

    Raises:
        InvalidInput: The foot never rests.
    """
    f, w, dt = specific_force_mps2, angular_velocity_rad_s, 1.0 / rate_hz
    first, stop = _first_stance(f, w, rate_hz, still, rolling)
    state, covariance = _start(f[first:stop], w[first:stop], rate_hz, settings, bool(still[first]))
    noises = _plant_noises(f, settings, dt)
    memory = max(1.0, settings.standing_memory_s * rate_hz)
    insist = round(settings.insist_s * rate_hz)
    accepted = np.zeros(len(still), dtype=bool)
    steps: list[FootStep] = []
    doubted = refused = 0
    Phi = np.eye(SIZE)
    for k in range(first, len(f)):
        if k > first:
            state, Phi = predict(state, 0.5 * (f[k - 1] + f[k]), 0.5 * (w[k - 1] + w[k]), dt)
            covariance = Phi @ covariance @ Phi.T
            _add_noise(covariance, noises[k], settings, dt)
            if turn_variance is not None:
                covariance[ROTATION, ROTATION] += np.diag(turn_variance[k])
        reading = None
        if still[k] or (rolling is not None and rolling[k]):
            stance = _stance(state, w[k], settings)
            gate = settings.gate if still[k] else settings.rolling_gate
            fits = _innovation_squared(covariance, stance) <= gate
            if still[k] and not fits:  # a second rest that contradicts the velocity is believed at once
                doubted = insist + 1 if doubted and not still[k - 1] else doubted + 1
            elif still[k]:
                doubted = 0
            believed = still[k] and doubted > insist
            if not fits and not believed:
                refused += 1
            else:
                if not fits:  # the filter's estimate was wrong
                    covariance += _lost(settings)
                reading = _reading(state, stance, settings, memory)
                found = correct(covariance, reading)
                state, covariance = state.moved(found.step), found.covariance
        accepted[k] = reading is not None
        steps.append(FootStep(state, covariance, Phi, reading))
    return FootRun(first, tuple(steps), accepted, refused)


class _Stance(NamedTuple):
    """Velocity (3,) that the state has beyond that of rolling, its derivative (3, 3) by the lever, and its spread."""

    beyond: Array
    by_lever: Array
    sd_m_s: float


def _stance(state: FootState, w: Array, settings: FootFilterSettings) -> _Stance:
    """Readings of a state by a stance."""
    turning = w - state.gyro_bias
    by_lever = -state.rotation @ pin.skew(turning)
    sd = np.hypot(settings.standing_speed_m_s, settings.rolling_m * np.linalg.norm(turning))
    return _Stance(state.velocity + by_lever @ state.lever, by_lever, float(sd))


def _innovation_squared(covariance: Array, stance: _Stance) -> float:
    """Normalised innovation squared of a stance."""
    H = np.hstack([np.eye(3), np.zeros((3, 3)), stance.by_lever])
    S = H @ covariance[:READ, :READ] @ H.T + stance.sd_m_s**2 * np.eye(3)
    return float(stance.beyond @ np.linalg.solve(S, stance.beyond))


def _reading(state: FootState, stance: _Stance, settings: FootFilterSettings, memory: float) -> Information:
    """Pseudo-reading of a stance: no velocity beyond rolling, and on level ground height zero.

    Samples of one stance err alike; each of them counts for its share of the ``memory`` samples that do.
    """
    H = np.hstack([np.eye(3), np.zeros((3, 3)), stance.by_lever])
    certainty = 1.0 / (stance.sd_m_s**2 * memory)
    matrix = certainty * (H.T @ H)
    vector = -certainty * (H.T @ stance.beyond)
    cost, rows = certainty * float(stance.beyond @ stance.beyond), 3
    if settings.level_m is not None:
        up, weight, height = P.stop - 1, settings.level_m**-2, float(state.position[2])
        matrix[up, up] += weight
        vector[up] -= weight * height
        cost, rows = cost + weight * height**2, rows + 1
    return Information(matrix, vector, cost, rows)


def _first_stance(
    f: Array, w: Array, rate_hz: float, still: BoolArray, rolling: BoolArray | None
) -> tuple[int, int]:
    """First sample, and the one after the last, of the first rest; without any, of the calmest of early stances."""
    rests = runs(still)
    if rests:
        return rests[0]
    stances = [] if rolling is None else runs(rolling)
    if not stances:
        raise InvalidInput("the foot never stands still, so nothing holds its velocity; check rate and units")
    early = [one for one in stances if one[0] <= stances[0][0] + _EARLY_S * rate_hz]

    def stance_statistic(one: tuple[int, int]) -> float:
        off = np.linalg.norm(f[slice(*one)], axis=1) - GRAVITY_M_S2
        return float((off**2 + GRAVITY_M_S2 * (w[slice(*one)] ** 2).sum(axis=1)).mean())

    return min(early, key=stance_statistic)


def _start(
    f: Array, w: Array, rate_hz: float, settings: FootFilterSettings, rested: bool
) -> tuple[FootState, Array]:
    """State and covariance in the first stance: level by the accelerometer, heading and place by definition.

    Medians, because a rest often ends with the first shift of weight.
    """
    long = rested and len(w) >= settings.rest_for_bias_s * rate_hz
    rotation = quaternion_matrices(attitude(np.median(f, axis=0)))
    zero = np.zeros(3)
    state = FootState(zero, zero, zero, rotation, np.median(w, axis=0) if long else zero, zero)
    sd = np.zeros(SIZE)
    sd[V] = settings.standing_speed_m_s if rested else settings.rolling_speed_m_s
    sd[GYRO_BIAS] = settings.rested_gyro_bias_rad_s if long else settings.gyro_bias_rad_s
    sd[ACC_BIAS] = settings.acceleration_bias_m_s2
    sd[P] = 1e-6
    sd[LEVER] = settings.lever_m
    covariance = np.diag(sd**2)
    tilt = settings.tilt_rad if rested else settings.rolling_tilt_rad
    level = tilt**2 * (np.eye(3) - np.outer(_UP, _UP)) + 1e-12 * np.eye(3)
    covariance[ROTATION, ROTATION] = rotation.T @ level @ rotation
    return state, covariance


def _plant_noises(f: Array, settings: FootFilterSettings, dt: float) -> Array:
    """(T,) spectral density of the specific force over the step to each sample, (m/s²)²/Hz.

    The force between a sample and its neighbours that the sample misses is a share of the second difference.
    """
    rough = np.zeros(len(f))
    rough[1:-1] = settings.roughness * np.linalg.norm(f[2:] - 2.0 * f[1:-1] + f[:-2], axis=1)
    rough[1:] = np.maximum(rough[1:], rough[:-1])
    return settings.acceleration_noise**2 + rough**2 * dt


def _lost(settings: FootFilterSettings) -> Array:
    """(18, 18) covariance of a state that a rest has shown to be wrong: velocity and orientation."""
    sd = np.zeros(SIZE)
    sd[V], sd[ROTATION] = settings.lost_speed_m_s, settings.rolling_tilt_rad
    return np.diag(sd**2)


def _add_noise(covariance: Array, density: float, settings: FootFilterSettings, dt: float) -> None:
    """Adds the process noise of one step to the covariance."""
    places = np.arange(SIZE)
    own = np.zeros(SIZE)
    own[V] = density * dt
    own[P] = density * dt**3 / 3.0
    own[LEVER] = settings.lever_walk_m**2 * dt
    own[ROTATION] = settings.angular_noise**2 * dt
    own[GYRO_BIAS] = settings.gyro_bias_walk**2 * dt
    covariance[places, places] += own
    covariance[places[V], places[P]] += density * dt**2 / 2.0
    covariance[places[P], places[V]] += density * dt**2 / 2.0
