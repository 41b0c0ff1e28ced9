"""A textbook Kalman filter of orientation: accelerometer and magnetometer as directions, as Madgwick's has them.

The source's sensors run an EKF of their maker that is not described. This one uses the same information as Madgwick's
filter (gravity is the accelerometer's direction, north the field's horizontal part) after Sabatini, IEEE Trans. Biomed.
Eng. 53 (2006) 1346-1356, and so shows the gain of a Kalman filter by itself. Errors are small rotations in the world.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import exponential, multiply
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.rotations import skew

UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class PlainSettings:
    """Noise: of the gyroscope rad/s/√Hz, its bias rad/s/√s, and of a direction (per sample, both instruments)."""

    direction_sd: float
    gyro_noise: float = 2e-3
    bias_walk: float = 5e-5
    start_sd_rad: float = 0.03
    start_bias_sd_rad_s: float = 0.01


def plain_ekf(one: ImuReadings, settings: PlainSettings, start: Array) -> Array:
    """(T, 4) orientations sensor → NWU.

    Args:
        one: The sensor, no sample missing.
        settings: Noise.
        start: (4,) orientation at the first sample.
    """
    dt = 1.0 / one.rate_hz
    force = one.specific_force_mps2 / np.linalg.norm(one.specific_force_mps2, axis=1, keepdims=True)
    field = None
    if one.magnetic_field is not None:
        field = one.magnetic_field / np.linalg.norm(one.magnetic_field, axis=1, keepdims=True)
    q, bias = np.array(start), np.zeros(3)
    P = np.diag([settings.start_sd_rad**2] * 3 + [settings.start_bias_sd_rad_s**2] * 3)
    Q = np.diag([settings.gyro_noise**2 * dt] * 3 + [settings.bias_walk**2 * dt] * 3)
    course = np.empty((one.samples, 4))
    course[0] = q
    F = np.eye(6)
    for k in range(1, one.samples):
        F[:3, 3:] = -dt * quaternion_matrices(q)
        q = multiply(q, exponential(dt * (one.angular_velocity_rad_s[k] - bias)))
        P = F @ P @ F.T + Q
        q, bias, P = _read(q, bias, P, force[k], None if field is None else field[k], settings.direction_sd)
        course[k] = q
    return course


def _read(
    q: Array, bias: Array, P: Array, force: Array, field: Array | None, sd: float
) -> tuple[Array, Array, Array]:
    """State and covariance after both directions: 0 = e - d - δ × d for a direction d in the world that should be e."""
    R = quaternion_matrices(q)
    seen, wanted = [R @ force], [UP]
    if field is not None:
        north = R @ field
        seen.append(north)
        wanted.append(np.array([np.hypot(north[0], north[1]), 0.0, north[2]]))
    H = np.zeros((3 * len(seen), 6))
    H[:, :3] = -np.concatenate([skew(one) for one in seen])
    S = H @ P @ H.T + sd**2 * np.eye(len(H))
    K = np.linalg.solve(S, H @ P).T
    dx = K @ (np.concatenate(wanted) - np.concatenate(seen))
    P = P - K @ H @ P
    q = multiply(exponential(dx[:3]), q)
    return q / np.linalg.norm(q), bias + dx[3:], 0.5 * (P + P.T)
