"""Stated spread of an orientation: the filter's own, and errors of a sensor that its readings cannot show.

Calibration leaves an offset in accelerometer and magnetometer (Titterton 2004). It turns with the sensor, so that only
the mean of the sensor's directions over the filter's memory bends tilt and heading: an offset b bends the vertical by
mean(R) b / g. A field that is read late by τ appears turned by ω in between, so that the heading is off by
τ (ω × h)_west / h_level in the mean. A sample that is late by τ belongs to an orientation that differs by τ ω.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_banded

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.frames import rotate
from mbkf.imu.orientation_ekf import OrientationSettings
from mbkf.numerics.cardan import quaternion_matrices


def stated_sd(
    variance: Array,
    quaternion: Array,
    angular_velocity_rad_s: Array,
    magnetic_field: Array | None,
    rate_hz: float,
    settings: OrientationSettings,
    *,
    smooth: bool,
) -> Array:
    """(T, 3) standard deviations of one sensor's error about north, west and up, rad.

    Args:
        variance: (T, 3) of the filter, rad².
        quaternion: (T, 4) sensor → NWU.
        angular_velocity_rad_s: (T, 3) in the sensor's axes without bias, NaN where missing.
        magnetic_field: (T, 3) in the sensor's axes, µT, NaN where missing; None where it was not used.
        rate_hz: Sample rate.
        settings: Offsets, delays and the noise that makes the filter's memory.
        smooth: True where later samples count as earlier ones do.
    """
    s = settings
    turning = np.nan_to_num(rotate(quaternion, angular_velocity_rad_s))
    found = s.spread_scale**2 * np.maximum(variance, 0.0) + (s.clock_sd_s * turning) ** 2
    rotation = quaternion_matrices(quaternion)
    means = _recent_mean(rotation, tilt_memory_s(s) * rate_hz, smooth)
    # An offset along north turns the estimate about west, and the other way round.
    bent = (s.accelerometer_offset_mps2 / GRAVITY_M_S2) ** 2 * (means**2).sum(axis=2)
    found[:, 0] += bent[:, 1]
    found[:, 1] += bent[:, 0]
    if magnetic_field is not None:
        found[:, 2] += _heading_variance(rotation, turning, magnetic_field, rate_hz, s, smooth)
    return np.sqrt(found)


def tilt_memory_s(settings: OrientationSettings) -> float:
    """Time over which readings make up the tilt of a moving sensor, (r / (q g²))^¼, velocities read with density r."""
    s = settings
    read = s.velocity_sd_m_s * np.sqrt(s.velocity_memory_s)
    return float(np.sqrt(read / (s.gyro_noise * GRAVITY_M_S2)))


def heading_memory_s(settings: OrientationSettings) -> float:
    """Time over which fields make up the heading: √(r / q) of headings read with density r."""
    s = settings
    return float(s.heading_sd_rad * np.sqrt(s.heading_memory_s) / s.gyro_noise)


def _heading_variance(
    rotation: Array,
    turning: Array,
    magnetic_field: Array,
    rate_hz: float,
    settings: OrientationSettings,
    smooth: bool,
) -> Array:
    """(T,) variance of a heading that all fields of its memory have in common."""
    s, samples = settings, heading_memory_s(settings) * rate_hz
    seen = np.asarray(np.isfinite(magnetic_field).all(axis=1))
    field = (rotation @ np.nan_to_num(magnetic_field)[:, :, None])[:, :, 0]
    # Rows of missing fields are zero and leave ratios of means as they are.
    level = np.hypot(field[:, 0], field[:, 1])
    west = np.cross(turning, field)[:, 1]
    parts = np.column_stack([level, np.hypot(level, field[:, 2]), west, seen[:, None] * rotation[:, 1], seen])
    mean = _recent_mean(parts, samples, smooth)
    least = np.maximum(mean[:, 0], 1e-9)
    offset = s.field_offset * mean[:, 1] / least * np.sqrt((mean[:, 3:6] ** 2).sum(axis=1))
    offset = offset / np.maximum(mean[:, 6], 1e-9)
    late = s.field_delay_s * mean[:, 2] / least
    return np.asarray(
        s.field_direction_sd_rad**2 + np.minimum(offset, np.pi) ** 2 + np.minimum(late**2, np.pi**2)
    )


def _recent_mean(values: Array, samples: float, smooth: bool) -> Array:
    """Means (T, …) of values that count less, by e, with each ``samples`` of distance: past ones, or all of them."""
    bands = np.ones((2, len(values)))
    bands[1] = -np.exp(-1.0 / samples)

    def sums(series: Array) -> Array:
        # y_t − exp(−1 / samples) y_{t−1} = x_t, as a banded system: scipy.signal loads slowly.
        return np.asarray(solve_banded((1, 0), bands, series.reshape(len(series), -1)).reshape(series.shape))

    def total(series: Array) -> Array:
        past = sums(series)
        return past + sums(series[::-1])[::-1] - series if smooth else past

    weight = total(np.ones(len(values)))
    return total(values) / weight.reshape(-1, *[1] * (values.ndim - 1))
