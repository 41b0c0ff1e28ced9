"""A sensor that turns and shakes in a known way, for tests of orientation filters."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.imu.readings import ImuReadings

RATE_HZ = 100.0
FIELD_NWU = np.array([24.0, 0.0, -39.0])


@dataclass(frozen=True)
class Turning:
    """Readings without errors and the true orientation (T, 4) in NWU."""

    gyro: np.ndarray
    force: np.ndarray
    field: np.ndarray
    truth: np.ndarray

    def readings(self, name="a", **changes):
        parts = {"gyro": self.gyro, "force": self.force, "field": self.field} | changes
        times = np.arange(len(self.gyro)) / RATE_HZ
        return ImuReadings(
            name, times, parts["force"], parts["gyro"], parts["field"], RATE_HZ, "NWU", self.truth
        )


@cache
def turning(seconds=20.0, seed=0, shake_mps2=1.0, still_s=1.0, rate_rad_s=1.0):
    """Sums of sines in all axes; each rate is the mean since the sample before, as digital sensors give it."""
    rng = np.random.default_rng(seed)
    count = round(seconds * RATE_HZ)
    t = np.arange(count) / RATE_HZ
    ramp = np.clip((t - still_s) / 0.5, 0.0, 1.0)[:, None]

    def waves(low, high, size):
        frequency, phase = rng.uniform(low, high, (2, 3)), rng.uniform(0, 2 * np.pi, (2, 3))
        return size * np.sin(2 * np.pi * frequency * t[:, None, None] + phase).sum(axis=1) / np.sqrt(2)

    gyro = ramp * waves(0.2, 1.0, rate_rad_s)
    linear = ramp * waves(0.8, 2.0, shake_mps2)
    turned = Rotation.from_rotvec(rng.normal(0.0, 0.5, 3))
    course = []
    for k in range(count):
        turned = turned * Rotation.from_rotvec(gyro[k] / RATE_HZ) if k else turned
        course.append(turned.as_quat())
    course = Rotation.from_quat(course)
    force = course.inv().apply(linear + np.array([0.0, 0.0, GRAVITY_M_S2]))
    return Turning(gyro, force, course.inv().apply(np.tile(FIELD_NWU, (count, 1))), course.as_quat())


def apart_deg(a, b):
    """(T,) angle between orientations, degrees."""
    return np.degrees((Rotation.from_quat(a) * Rotation.from_quat(b).inv()).magnitude())
