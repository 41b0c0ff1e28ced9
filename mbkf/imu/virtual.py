"""Virtual inertial sensors on any segment of a motion, from its own velocities and accelerations, with their errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.frames import matrix_quaternion
from mbkf.io.imu.mount import ImuMount
from mbkf.io.imu.readings import ImuReadings
from mbkf.model.body import Body
from mbkf.sensors.inertial_sensor import InertialSensor

FIELD_UT = (24.0, 0.0, -39.0)
"""A field of middle Europe in NWU, µT: 46 µT, dip 58°."""


@dataclass(frozen=True)
class ImuErrors:
    """Errors of a sensor; the defaults are a consumer MEMS unit after its factory calibration.

    Attributes:
        gyro_noise: White noise, rad/s/√Hz (0.01 °/s/√Hz).
        gyro_bias_sd_rad_s: Spread of the constant bias per axis (0.3 °/s).
        gyro_drift: Random walk of the bias, rad/s/√s (0.003 °/s/√s).
        accelerometer_noise: White noise, m/s²/√Hz (200 µg/√Hz).
        accelerometer_bias_sd_mps2: Spread of the constant bias per axis (4 mg).
        magnetometer_noise_ut: White noise per sample, µT.
        magnetometer_bias_sd_ut: Spread of the constant bias per axis.
        gyro_range_rad_s, accelerometer_range_mps2: Greatest reading; beyond it the sensor is clipped.
    """

    gyro_noise: float = 1.75e-4
    gyro_bias_sd_rad_s: float = 5e-3
    gyro_drift: float = 5e-5
    accelerometer_noise: float = 2e-3
    accelerometer_bias_sd_mps2: float = 0.04
    magnetometer_noise_ut: float = 0.3
    magnetometer_bias_sd_ut: float = 0.5
    gyro_range_rad_s: float = 35.0
    accelerometer_range_mps2: float = 157.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (np.isfinite(value) and value >= 0.0):
                raise InvalidInput(f"{name} must be 0 or more, got {value}")

    @classmethod
    def none(cls) -> ImuErrors:
        """A perfect sensor."""
        return cls(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e6, 1e6)


def virtual_imus(
    model: Body,
    times_s: Array,
    q: Array,
    v: Array,
    a: Array,
    mounts: Sequence[ImuMount],
    *,
    errors: ImuErrors | None = None,
    seed: int = 0,
    rate_hz: float | None = None,
    field_ut: Sequence[float] = FIELD_UT,
) -> tuple[ImuReadings, ...]:
    """Readings of virtual sensors during a motion; ``orientation`` holds the truth, in NWU.

    The world's x axis counts as magnetic north. At another rate than the motion's the error-free readings are joined
    by cubic splines.

    Args:
        model: The body.
        times_s: (T,) regular times, s.
        q: (T, nq) configurations.
        v: (T, nv) velocities.
        a: (T, nv) accelerations.
        mounts: The sensors.
        errors: Their errors; None: a consumer unit's.
        seed: Chooses them.
        rate_hz: Sample rate; None: the motion's.
        field_ut: (3,) the Earth's field in the world, µT.

    Raises:
        InvalidInput: Fewer than four frames, or a frame is missing.
        UnknownName: A mount's segment does not exist.
    """
    chosen = errors or ImuErrors()
    if len(times_s) < 4 or not all(np.isfinite(one).all() for one in (q, v, a)):
        raise InvalidInput("virtual sensors need a motion of four frames or more, with every frame tracked")
    sensor = InertialSensor(model, mounts)
    readings = np.array([sensor.values(*state) for state in zip(q, v, a, strict=True)])
    rotations = np.array([sensor.orientations(one) for one in q])
    own_rate = (len(times_s) - 1) / float(times_s[-1] - times_s[0])
    rate, times = own_rate, np.asarray(times_s)
    if rate_hz is not None and abs(rate_hz / own_rate - 1.0) > 1e-9:
        rate = float(rate_hz)
        times = times_s[0] + np.arange(int(np.floor((times_s[-1] - times_s[0]) * rate + 1e-9)) + 1) / rate
        from scipy.interpolate import make_interp_spline

        readings = make_interp_spline(times_s, readings, k=3, axis=0)(times)
        rotations = _orthonormal(make_interp_spline(times_s, rotations, k=3, axis=0)(times))
    field = np.asarray(field_ut, dtype=float) @ rotations
    return tuple(
        _with_errors(
            mount.name, times, rate, readings[:, k], field[:, k], rotations[:, k], chosen, [seed, 11, k]
        )
        for k, mount in enumerate(mounts)
    )


def _with_errors(
    name: str,
    times: Array,
    rate: float,
    readings: Array,
    field: Array,
    rotations: Array,
    errors: ImuErrors,
    seed: Sequence[int],
) -> ImuReadings:
    """Constant biases by the seed alone, for any motion: the same seed is the same sensor."""
    rng, root, shape = np.random.default_rng(seed), np.sqrt(rate), (len(times), 3)
    gyro_bias, force_bias, field_bias = rng.normal(0.0, 1.0, (3, 3))
    walk = np.cumsum(rng.normal(0.0, errors.gyro_drift / root, shape), axis=0)
    gyro = readings[:, :3] + errors.gyro_bias_sd_rad_s * gyro_bias + walk - walk[0]
    gyro += rng.normal(0.0, errors.gyro_noise * root, shape)
    force = readings[:, 3:] + errors.accelerometer_bias_sd_mps2 * force_bias
    force += rng.normal(0.0, errors.accelerometer_noise * root, shape)
    seen = field + errors.magnetometer_bias_sd_ut * field_bias
    seen += rng.normal(0.0, errors.magnetometer_noise_ut, shape)
    return ImuReadings(
        name,
        times,
        np.clip(force, -errors.accelerometer_range_mps2, errors.accelerometer_range_mps2),
        np.clip(gyro, -errors.gyro_range_rad_s, errors.gyro_range_rad_s),
        seen,
        rate,
        "NWU, x of the motion's world as north",
        matrix_quaternion(rotations),
    )


def _orthonormal(R: Array) -> Array:
    """The rotations nearest to matrices (…, 3, 3)."""
    u, _, vt = np.linalg.svd(R)
    return u @ vt
