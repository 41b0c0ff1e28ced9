"""Difference of two orientations of one sensor over time: of their quaternions and angles, and the turn between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import ShapeError
from mbkf.imu.orientation import euler_angles
from mbkf.imu.orientation_error import error_angles


@dataclass(frozen=True)
class OrientationDifference:
    """The second orientation against the first, at each of T samples; NaN where one is missing.

    Attributes:
        quaternion: (T, 4) the second one, with that sign of q and −q which is nearer to the first.
        components: (T, 4) difference of the components x, y, z, w.
        euler_rad: (T, 3) difference of roll, pitch and yaw without whole turns, rad.
        angle_rad, heading_rad, inclination_rad: (T,) the turn between them, its part about the vertical, the rest, rad.
    """

    quaternion: Array
    components: Array
    euler_rad: Array
    angle_rad: Array
    heading_rad: Array
    inclination_rad: Array


def orientation_difference(first: Array, second: Array) -> OrientationDifference:
    """Second minus first.

    Args:
        first: (T, 4) orientations sensor → world, z of which is vertical.
        second: (T, 4) the others, in the same world.

    Raises:
        ShapeError: The two differ in length.
    """
    if first.shape != second.shape:
        raise ShapeError("second", str(first.shape), second.shape)
    near = np.where((second * first).sum(axis=1, keepdims=True) < 0.0, -second, second)
    angles = euler_angles(near) - euler_angles(first)
    turn, heading, tilt = error_angles(near, first)
    return OrientationDifference(
        near, near - first, angles - 2.0 * np.pi * np.round(angles / (2.0 * np.pi)), turn, heading, tilt
    )
