"""Madgwick's orientation filter: the gyroscope, corrected by a gradient step towards gravity and magnetic north.

Madgwick, *An efficient orientation filter for inertial and inertial/magnetic sensor arrays*, 2010. The steps are those
of De Miguel Pueyo's thesis (docs/references.md, key ``Madgwick``), eqs. 22–37. Departs from Madgwick eq. 28 in two
misprints: the third row of f has a_z, and the last row for the field has 2 b₃ (½ − q₁² − q₂²). Departs from Madgwick
eq. 34, which corrects each sample for itself: the corrections add up to the bias. The steps are written in components,
which may be floats (one sensor, live) or arrays over many sensors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.frames import attitude

Component = Any
"""A float, or an array over sensors."""

Vector = tuple[Component, Component, Component]
Quaternion = tuple[Component, Component, Component, Component]

_TINY = 1e-30


@dataclass(frozen=True)
class MadgwickSettings:
    """Gains.

    Attributes:
        beta: Speed of the correction towards gravity and field, rad/s.
        zeta: Gain of the gyroscope's bias, rad/s²; 0 leaves the bias alone.
    """

    beta: float = 0.1
    zeta: float = 0.0

    def __post_init__(self) -> None:
        for name in ("beta", "zeta"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) >= 0.0):
                raise InvalidInput(f"{name} must be 0 or more, got {getattr(self, name)}")


class MadgwickState(NamedTuple):
    """Orientation sensor → NWU as (w, x, y, z), the order of the equations, and gyroscope bias, rad/s."""

    q: Quaternion
    bias: Vector

    @property
    def quaternion(self) -> Array:
        """(…, 4) the orientation as (x, y, z, w)."""
        w, x, y, z = self.q
        return np.stack([x, y, z, w], axis=-1)

    @property
    def gyro_bias(self) -> Array:
        """(…, 3) rad/s."""
        return np.stack(self.bias, axis=-1)


class MadgwickFilter:
    """The filter with its gains, for one sensor or many at once; its steps are pure.

    Attributes:
        dt_s: Time between samples.
        settings: Gains.
    """

    def __init__(self, dt_s: float, settings: MadgwickSettings | None = None) -> None:
        self.dt_s, self.settings = dt_s, settings or MadgwickSettings()

    def begin(self, specific_force: Array, magnetic_field: Array | None = None) -> MadgwickState:
        """State of sensors at rest: (…, 3) specific force and field, any unit.

        Departs from Madgwick section 5.3, which begins with the sensors' own quaternion, as :meth:`begin_at` does.
        """
        return self.begin_at(attitude(np.asarray(specific_force), magnetic_field))

    def begin_at(self, quaternion: Array) -> MadgwickState:
        """State with given orientations (…, 4), sensor → NWU."""
        x, y, z, w = _components(quaternion)
        return MadgwickState((w, x, y, z), (0.0 * w, 0.0 * w, 0.0 * w))

    def step(
        self, state: MadgwickState, gyro: Array, specific_force: Array, magnetic_field: Array | None = None
    ) -> MadgwickState:
        """The state one sample later.

        Args:
            state: Before the sample.
            gyro: (…, 3) angular velocity, rad/s, NaN if missing.
            specific_force: (…, 3) any unit, NaN if missing.
            magnetic_field: (…, 3) any unit, NaN if missing; None for the filter without it.
        """
        acc, gain = _direction(np.asarray(specific_force))
        mag = None if magnetic_field is None else _direction(np.asarray(magnetic_field))[0]
        beta = self.settings.beta * gain
        rate = np.nan_to_num(np.asarray(gyro))
        return advance(
            state,
            _components(rate),
            _components(acc),
            None if mag is None else _components(mag),
            self.dt_s,
            float(beta) if beta.ndim == 0 else beta,
            self.settings.zeta,
        )

    def run(
        self,
        gyro: Array,
        specific_force: Array,
        magnetic_field: Array | None = None,
        start: MadgwickState | None = None,
    ) -> Iterator[MadgwickState]:
        """States after each of T samples; the first is the start itself.

        Args:
            gyro: (T, 3) or (T, N, 3) angular velocity, rad/s.
            specific_force: Same shape, any unit.
            magnetic_field: Same shape, any unit, or None.
            start: State at the first sample; by default the one of a sensor at rest with its readings.
        """
        field = None if magnetic_field is None else magnetic_field[0]
        state = self.begin(specific_force[0], field) if start is None else start
        yield state
        acc, gain = _direction(specific_force)
        gains = self.settings.beta * gain
        rates, accs = _samples(np.nan_to_num(gyro)), _samples(acc)
        betas = gains.tolist() if gains.ndim == 1 else list(gains)
        mags = None if magnetic_field is None else _samples(_direction(magnetic_field)[0])
        for k in range(1, len(gyro)):
            mag = None if mags is None else mags[k]
            state = advance(state, rates[k], accs[k], mag, self.dt_s, betas[k], self.settings.zeta)
            yield state


def advance(
    state: MadgwickState,
    gyro: Vector,
    acc: Vector,
    mag: Vector | None,
    dt_s: float,
    beta: Component,
    zeta: float,
) -> MadgwickState:
    """One step of the filter in components (Madgwick eqs. 26–37).

    Args:
        state: Before.
        gyro: Angular velocity, rad/s.
        acc: Direction of the specific force, normalised (Madgwick eq. 22).
        mag: Direction of the field, normalised (Madgwick eq. 23); zeros where missing; None for the filter without it.
        dt_s: Time step.
        beta: Gain; 0 where gravity is missing.
        zeta: Gain of the bias.
    """
    (q0, q1, q2, q3), (bias_x, bias_y, bias_z) = state
    ax, ay, az = acc
    # f and Jᵀ f for gravity (Madgwick eqs. 28 and 29, third row with a_z).
    f1 = 2.0 * (q1 * q3 - q0 * q2) - ax
    f2 = 2.0 * (q0 * q1 + q2 * q3) - ay
    f3 = 1.0 - 2.0 * (q1 * q1 + q2 * q2) - az
    s0 = 2.0 * (q1 * f2 - q2 * f1)
    s1 = 2.0 * (q3 * f1 + q0 * f2) - 4.0 * q1 * f3
    s2 = 2.0 * (q3 * f2 - q0 * f1) - 4.0 * q2 * f3
    s3 = 2.0 * (q1 * f1 + q2 * f2)
    if mag is not None:
        m0, m1, m2, m3 = _magnetic_step(state.q, mag)
        s0, s1, s2, s3 = s0 + m0, s1 + m1, s2 + m2, s3 + m3
    scale = (s0 * s0 + s1 * s1 + s2 * s2 + s3 * s3 + _TINY) ** -0.5
    s0, s1, s2, s3 = scale * s0, scale * s1, scale * s2, scale * s3
    gx, gy, gz = gyro
    if zeta:
        # ω_ε = 2 q* ⊗ step; its integral is the bias (Madgwick 2010, eqs. 47–49; Madgwick omits the integral).
        rate = 2.0 * zeta * dt_s * (beta > 0.0)
        bias_x = bias_x + rate * (q0 * s1 - q1 * s0 - q2 * s3 + q3 * s2)
        bias_y = bias_y + rate * (q0 * s2 + q1 * s3 - q2 * s0 - q3 * s1)
        bias_z = bias_z + rate * (q0 * s3 - q1 * s2 + q2 * s1 - q3 * s0)
        gx, gy, gz = gx - bias_x, gy - bias_y, gz - bias_z
    p0 = q0 + dt_s * (0.5 * (-q1 * gx - q2 * gy - q3 * gz) - beta * s0)
    p1 = q1 + dt_s * (0.5 * (q0 * gx + q2 * gz - q3 * gy) - beta * s1)
    p2 = q2 + dt_s * (0.5 * (q0 * gy - q1 * gz + q3 * gx) - beta * s2)
    p3 = q3 + dt_s * (0.5 * (q0 * gz + q1 * gy - q2 * gx) - beta * s3)
    norm = (p0 * p0 + p1 * p1 + p2 * p2 + p3 * p3) ** -0.5
    return MadgwickState((norm * p0, norm * p1, norm * p2, norm * p3), (bias_x, bias_y, bias_z))


def _magnetic_step(q: Quaternion, mag: Vector) -> Quaternion:
    """Jᵀ f of the field's three rows (Madgwick eqs. 26–29, last row put right); 0 for a missing field."""
    q0, q1, q2, q3 = q
    mx, my, mz = mag
    # Columns of the rotation matrix give h = q ⊗ m ⊗ q*.
    xx, yy, zz = (
        1.0 - 2.0 * (q2 * q2 + q3 * q3),
        1.0 - 2.0 * (q1 * q1 + q3 * q3),
        1.0 - 2.0 * (q1 * q1 + q2 * q2),
    )
    xy, xz, yx = 2.0 * (q1 * q2 - q0 * q3), 2.0 * (q1 * q3 + q0 * q2), 2.0 * (q1 * q2 + q0 * q3)
    yz, zx, zy = 2.0 * (q2 * q3 - q0 * q1), 2.0 * (q1 * q3 - q0 * q2), 2.0 * (q2 * q3 + q0 * q1)
    hx, hy = xx * mx + xy * my + xz * mz, yx * mx + yy * my + yz * mz
    bx, bz = (hx * hx + hy * hy) ** 0.5, zx * mx + zy * my + zz * mz
    f4, f5, f6 = bx * xx + bz * zx - mx, bx * xy + bz * zy - my, bx * xz + bz * zz - mz
    bx, bz = 2.0 * bx, 2.0 * bz
    return (
        -bz * q2 * f4 + (bz * q1 - bx * q3) * f5 + bx * q2 * f6,
        bz * q3 * f4 + (bx * q2 + bz * q0) * f5 + (bx * q3 - 2.0 * bz * q1) * f6,
        -(2.0 * bx * q2 + bz * q0) * f4 + (bx * q1 + bz * q3) * f5 + (bx * q0 - 2.0 * bz * q2) * f6,
        (bz * q1 - 2.0 * bx * q3) * f4 + (bz * q2 - bx * q0) * f5 + bx * q1 * f6,
    )


def _direction(vectors: Array) -> tuple[Array, Array]:
    """Unit vectors (…, 3), zero where missing or zero, and 1.0 where there is one, else 0.0 (…)."""
    length = np.sqrt((vectors * vectors).sum(axis=-1))
    there = np.isfinite(length) & (length > 0.0)
    safe = np.where(there, length, 1.0)
    return np.where(there[..., None], vectors, 0.0) / safe[..., None], there.astype(float)


def _components(array: Array) -> tuple[Component, ...]:
    """Last axis taken apart: floats of a vector, arrays over sensors of many."""
    values = np.asarray(array, dtype=float)
    return tuple(values.tolist()) if values.ndim == 1 else tuple(np.moveaxis(values, -1, 0))


def _samples(series: Array) -> list[Any]:
    """Per sample its components: (T, 3) to lists of floats, (T, N, 3) to three arrays over sensors."""
    return series.tolist() if series.ndim == 2 else list(np.ascontiguousarray(np.moveaxis(series, -1, 1)))
