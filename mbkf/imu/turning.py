"""Angular velocities of sensors whose file holds orientations and no gyroscope."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import conjugate, multiply
from mbkf.io.imu.readings import ImuReadings


def with_turning(one: ImuReadings) -> ImuReadings:
    """The readings with the angular velocity of their orientations where they have none of their own."""
    if one.orientation is None or has_gyroscope(one):
        return one
    return replace(one, angular_velocity_rad_s=turning(one.orientation, one.time_s))


def has_gyroscope(one: ImuReadings) -> bool:
    """True where any angular velocity was read."""
    return bool(np.isfinite(one.angular_velocity_rad_s).any())


def turning(orientation: Array, time_s: Array) -> Array:
    """(T, 3) angular velocities, rad/s in sensor axes, of orientations sensor → world; central differences.

    Args:
        orientation: (T, 4) unit quaternions (x, y, z, w), NaN where missing.
        time_s: (T,) times.
    """
    steps = np.arange(len(time_s))
    before, after = np.maximum(steps - 1, 0), np.minimum(steps + 1, len(time_s) - 1)
    between = multiply(conjugate(orientation[before]), orientation[after])
    between = np.where(between[:, 3:] < 0.0, -between, between)
    half = np.linalg.norm(between[:, :3], axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(half, between[:, 3:])
    # Half a turn and less: the axis is that of the shorter way.
    vectors = between[:, :3] * np.where(half > 1e-9, angle / np.maximum(half, 1e-9), 2.0)
    lasted = np.maximum(time_s[after] - time_s[before], 1e-9)
    return np.asarray(vectors / lasted[:, None])
