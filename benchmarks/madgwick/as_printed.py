"""Formulas by the letter: the filter (Madgwick eqs. 22-37), virtual sensors (38-43), gains (44-48).

Only the two misprints of Madgwick eq. 28 that no program can hold are put right (docs/theory/inertial.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.imu.readings import ImuReadings


def madgwick_as_printed(one: ImuReadings, beta: float, zeta: float, start: Array) -> Array:
    """(T, 4) orientations sensor → NWU as (x, y, z, w), by Madgwick eqs. 22 to 37, without an integral of the bias.

    Args:
        one: The sensor, no sample missing.
        beta: Gain of the gradient step.
        zeta: Gain of the gyroscope's correction.
        start: (4,) orientation at the first sample.
    """
    assert one.magnetic_field is not None
    q, dt = np.asarray(start)[[3, 0, 1, 2]], 1.0 / one.rate_hz
    course = [q]
    readings = zip(one.angular_velocity_rad_s, one.specific_force_mps2, one.magnetic_field, strict=True)
    for gyro, force, field in list(readings)[1:]:
        step = _step(q, force / np.linalg.norm(force), field / np.linalg.norm(field))
        rate = np.array([0.0, *gyro]) - 2.0 * dt * zeta * _product(_conjugate(q), step)
        q = q + dt * (0.5 * _product(q, rate) - beta * step)
        q = q / np.linalg.norm(q)
        course.append(q)
    return np.array(course)[:, [1, 2, 3, 0]]


def _step(q: Array, a: Array, m: Array) -> Array:
    """The normalised gradient: Madgwick eqs. 26 to 31."""
    h = _product(_product(q, np.array([0.0, *m])), _conjugate(q))
    b1, b3 = np.hypot(h[1], h[2]), h[3]
    q0, q1, q2, q3 = q
    f = np.array(
        [
            2 * (q1 * q3 - q0 * q2) - a[0],
            2 * (q0 * q1 + q2 * q3) - a[1],
            2 * (0.5 - q1**2 - q2**2) - a[2],
            2 * b1 * (0.5 - q2**2 - q3**2) + 2 * b3 * (q1 * q3 - q0 * q2) - m[0],
            2 * b1 * (q1 * q2 - q0 * q3) + 2 * b3 * (q0 * q1 + q2 * q3) - m[1],
            2 * b1 * (q0 * q2 + q1 * q3) + 2 * b3 * (0.5 - q1**2 - q2**2) - m[2],
        ]
    )
    J = np.array(
        [
            [-2 * q2, 2 * q3, -2 * q0, 2 * q1],
            [2 * q1, 2 * q0, 2 * q3, 2 * q2],
            [0.0, -4 * q1, -4 * q2, 0.0],
            [-2 * b3 * q2, 2 * b3 * q3, -4 * b1 * q2 - 2 * b3 * q0, -4 * b1 * q3 + 2 * b3 * q1],
            [2 * (b3 * q1 - b1 * q3), 2 * (b1 * q2 + b3 * q0), 2 * (b1 * q1 + b3 * q3), 2 * (b3 * q2 - b1 * q0)],
            [2 * b1 * q2, 2 * b1 * q3 - 4 * b3 * q1, 2 * b1 * q0 - 4 * b3 * q2, 2 * b1 * q1],
        ]
    )  # fmt: skip
    step = J.T @ f
    length = np.linalg.norm(step)
    normed: Array = step / length if length > 0.0 else step
    return normed


def _product(a: Array, b: Array) -> Array:
    (aw, ax, ay, az), (bw, bx, by, bz) = a, b
    return np.array(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ]
    )


def _conjugate(q: Array) -> Array:
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def printed_rates(rotations: Array, dt_s: float) -> Array:
    """(T − 1, 3) angular velocities of rotations (T, 3, 3) by Madgwick eqs. 39 to 43."""
    rate = (rotations[1:] - rotations[:-1]) / dt_s
    turned = np.swapaxes(rotations[:-1], 1, 2) @ rate
    return np.stack(
        [
            turned[:, 2, 1] - turned[:, 1, 2],
            turned[:, 0, 2] - turned[:, 2, 0],
            turned[:, 1, 0] - turned[:, 0, 1],
        ],
        axis=1,
    )


def printed_accelerations(places_m: Array, dt_s: float) -> Array:
    """(T − 2, 3) accelerations of places (T, 3) by Madgwick eq. 38."""
    found: Array = (places_m[:-2] + places_m[2:] - 2.0 * places_m[1:-1]) / dt_s**2
    return found


@dataclass(frozen=True)
class PrintedGains:
    """β and ζ of a still stretch by Madgwick eqs. 46 and 48, which take the root of the product."""

    beta: float
    zeta: float


def printed_gains(rates: Array, rate_hz: float) -> PrintedGains:
    """Gains of still readings by Madgwick eqs. 44 to 48: root mean square over axes, drift between two halves.

    Args:
        rates: (T, 3) the readings in their own unit.
        rate_hz: Their sample rate.
    """
    noise = np.sqrt(np.mean(rates.std(axis=0, ddof=1) ** 2))
    half = len(rates) // 2
    drift = (rates[half : 2 * half].mean(axis=0) - rates[:half].mean(axis=0)) / (half / rate_hz)
    return PrintedGains(float(np.sqrt(0.75 * noise)), float(np.sqrt(0.75 * np.sqrt(np.mean(drift**2)))))


def printed_noise(beta: float) -> float:
    """The noise whose β by Madgwick eq. 46 is the given one, in the readings' unit."""
    return beta**2 / 0.75
