"""A simulated foot: it rests, swings forwards with lift and pitch, rests again; its readings and truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.imu.readings import ImuReadings

FIRST_REST_S, REST_S, SWING_S = 1.5, 0.4, 0.7
LIFT_M, PITCH_RAD = 0.12, 0.9

_U = Polynomial([0.0, 1.0])
_ONWARDS = 10 * _U**3 - 15 * _U**4 + 6 * _U**5
_BUMP = 64 * _U**3 * (1 - _U) ** 3
_NODDING = 2 * _BUMP * (1 - 2 * _U)


@dataclass(frozen=True)
class FootWalk:
    """Readings, and the truth of every sample: position (T, 3), orientation, rests (T,), and lengths of the strides."""

    readings: ImuReadings
    position_m: Array
    orientation: Rotation
    still: BoolArray
    lengths_m: Array


def foot_walk(
    lengths_m: tuple[float, ...] = (1.2, 1.3, 1.1),
    *,
    name: str = "left_foot",
    rate_hz: float = 100.0,
    mounting_rad: tuple[float, float, float] = (0.3, -0.2, 0.1),
    heading_rad: float = 0.0,
    wait_s: float = 0.0,
    first_rest_s: float = FIRST_REST_S,
    rest_s: float = REST_S,
    swing_s: float = SWING_S,
    pitch_rad: float = PITCH_RAD,
    gyro_bias_rad_s: tuple[float, float, float] = (0.0, 0.0, 0.0),
    force_noise_m_s2: float = 0.0,
    rate_noise_rad_s: float = 0.0,
    seed: int = 0,
) -> FootWalk:
    """A straight walk of some strides.

    Args:
        lengths_m: Of the strides.
        name: Of the sensor.
        rate_hz: Of its readings.
        mounting_rad: Turns of the sensor on the foot about x, y and z.
        heading_rad: Of the walk, from x.
        wait_s: Lengthens the first rest and shortens the last.
        first_rest_s: First and last rest.
        rest_s: Rest between two strides.
        swing_s: Time of a swing.
        pitch_rad: Scale of the foot's pitch in a swing, which goes to 0.4 of it either way.
        gyro_bias_rad_s: Constant of the gyroscope.
        force_noise_m_s2: Standard deviation of white noise on each axis.
        rate_noise_rad_s: The same of the gyroscope.
        seed: Of the noise.
    """
    start, cycle = first_rest_s + wait_s, rest_s + swing_s
    t = np.arange(round((2 * first_rest_s + cycle * len(lengths_m)) * rate_hz)) / rate_hz
    along, height, pitch = (np.zeros((3, len(t))) for _ in range(3))
    moving = np.zeros(len(t), dtype=bool)
    for k, length in enumerate(lengths_m):
        u = (t - start - k * cycle) / swing_s
        swings = (u > 0.0) & (u < 1.0)
        moving |= swings
        for order in range(3):
            for target, size, curve in (
                (along, length, _ONWARDS),
                (height, LIFT_M, _BUMP),
                (pitch, pitch_rad, _NODDING),
            ):
                value = (curve.deriv(order) if order else curve)(u)
                target[order] += np.where(swings, size * value / swing_s**order, 0.0)
        along[0] += np.where(u >= 1.0, length, 0.0)
    turned = Rotation.from_euler("z", heading_rad) * Rotation.from_rotvec(pitch[0][:, None] * [0, 1, 0])
    orientation = turned * Rotation.from_euler("xyz", mounting_rad)
    forwards = np.array([np.cos(heading_rad), np.sin(heading_rad), 0.0])
    position, acceleration = (
        along[n][:, None] * forwards + height[n][:, None] * [0.0, 0.0, 1.0] for n in (0, 2)
    )
    nod = pitch[1][:, None] * np.array([-np.sin(heading_rad), np.cos(heading_rad), 0.0])
    rng = np.random.default_rng(seed)
    force = orientation.inv().apply(acceleration + np.array([0.0, 0.0, GRAVITY_M_S2]))
    rates = orientation.inv().apply(nod) + gyro_bias_rad_s
    readings = ImuReadings(
        name,
        t,
        force + force_noise_m_s2 * rng.normal(size=force.shape),
        rates + rate_noise_rad_s * rng.normal(size=rates.shape),
        None,
        rate_hz,
    )
    return FootWalk(readings, position, orientation, ~moving, np.array(lengths_m))
