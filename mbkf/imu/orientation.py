"""Orientations of sensors over a recording, by any of the filters, in the world frame that is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mbkf.conventions import Array, StageCallback, read_only
from mbkf.errors import InvalidInput, UnknownName
from mbkf.imu.frames import FRAMES, change_frame, exponential, multiply, rotate
from mbkf.imu.madgwick import MadgwickFilter, MadgwickSettings
from mbkf.imu.madgwick_course import madgwick_course
from mbkf.imu.orientation_course import orientation_course
from mbkf.imu.orientation_ekf import OrientationFilter, OrientationSettings
from mbkf.imu.orientation_spread import stated_sd
from mbkf.imu.soft_saturation import soft_limits
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.cardan import cardan_angles, quaternion_matrices
from mbkf.numerics.runs import runs

METHODS = ("madgwick", "ekf", "smooth")
"""Madgwick's filter, the error-state Kalman filter, and its offline version."""

START_S = 2.0
"""The first state is that of the mean reading over this time, turned back by the gyroscope."""

REST_S = 0.25
"""A sensor that hardly turns over this time starts at rest."""

BRIDGED_S = 0.05
"""Where later samples are known, gyroscopes are interpolated over packets that were lost for so long."""

GIVEN_SD_RAD = 0.03
"""Standard deviation of a given start."""

SATURATED_SCALE_NOISE = 0.15
"""Noise of a gyroscope that clips softly, per rad/s of turning, 1/√Hz. Chosen on 12 s of one RepoIMU trial, where tilts
then err by 0.6 and 1.2 times their stated spreads (by 34 and 55 times with the noise of a sound one)."""

MOST_SMOOTHED = 120_000
"""A smoother keeps about 3 kB per sample; it takes so many at a time."""


@dataclass(frozen=True)
class Orientation:
    """One sensor's course.

    Attributes:
        name: Sensor name.
        time_s: (T,) s.
        quaternion: (T, 4) sensor → world, (x, y, z, w); NaN where the gyroscope was missing.
        frame: World frame: ENU, NED or NWU. Without a magnetometer its heading is the first sample's.
        gyro_bias_rad_s: (T, 3).
        sd_rad: (T, 3) standard deviation of the error's rotation about the axes of NWU; None for Madgwick's filter.
        method: One of :data:`METHODS`.
    """

    name: str
    time_s: Array
    quaternion: Array
    frame: str
    gyro_bias_rad_s: Array
    sd_rad: Array | None
    method: str

    def __post_init__(self) -> None:
        for name in ("time_s", "quaternion", "gyro_bias_rad_s", "sd_rad"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def euler_rad(self) -> Array:
        """(T, 3) unwrapped angles roll, pitch, yaw (R = R_z(yaw) R_y(pitch) R_x(roll)), rad."""
        return euler_angles(self.quaternion)


@dataclass(frozen=True)
class OrientSettings:
    """Settings of the orientation filters.

    Attributes:
        method: One of :data:`METHODS`.
        magnetometer: Whether fields are used where there are any.
        madgwick: Gains of Madgwick's filter.
        ekf: Noise model of the Kalman filter.
    """

    method: str = "ekf"
    magnetometer: bool = True
    madgwick: MadgwickSettings = field(default_factory=MadgwickSettings)
    ekf: OrientationSettings = field(default_factory=OrientationSettings)

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise UnknownName("orientation filter", self.method, METHODS)


def orientations(
    readings: Sequence[ImuReadings],
    *,
    frame: str,
    settings: OrientSettings | None = None,
    start: Array | None = None,
    progress: StageCallback | None = None,
) -> tuple[Orientation, ...]:
    """Orientation of every sensor at every sample; sensors sampled together run side by side.

    Args:
        readings: Sensors; each at a regular rate, NaN where a sample is missing.
        frame: World frame of the result: ENU, NED or NWU.
        settings: Method, gains and noise.
        start: (N, 4) orientation at the first sample in ``frame``; by default that of sensors at rest.
        progress: Called as samples are done.

    Raises:
        UnknownName: Unknown frame.
        InvalidInput: A sensor starts without a reading or has no gyroscope.
    """
    chosen = settings or OrientSettings()
    if frame not in FRAMES:
        raise UnknownName("world frame", frame, FRAMES)
    for one in readings:
        _check(one)
    found: dict[int, Orientation] = {}
    for group in _together(readings, chosen):
        begins = None if start is None else change_frame(np.asarray(start)[group], frame, "NWU")
        own = _widened(chosen) if soft_limits(readings[group[0]]) else chosen
        courses = _run([readings[k] for k in group], own, begins, progress)
        for k, (q, bias, sd) in zip(group, courses, strict=True):
            lost = np.any(np.isnan(readings[k].angular_velocity_rad_s), axis=1)
            turned = np.where(lost[:, None], np.nan, change_frame(q, "NWU", frame))
            found[k] = Orientation(
                readings[k].name, readings[k].time_s, turned, frame, bias, sd, chosen.method
            )
    return tuple(found[k] for k in range(len(readings)))


def euler_angles(quaternion: Array) -> Array:
    """(T, 3) unwrapped roll, pitch, yaw, rad, of quaternions (T, 4); NaN where one is missing."""
    yaw_pitch_roll = cardan_angles(quaternion_matrices(quaternion)[:, ::-1, ::-1], np.array(-1.0))
    angles = yaw_pitch_roll[:, ::-1].copy()
    there = np.isfinite(angles).all(axis=1)
    angles[there] = np.unwrap(angles[there], axis=0)
    return angles


def first_readings(one: ImuReadings, seconds: float = START_S) -> tuple[Array, Array | None]:
    """Mean specific force (3,) and field (3,) or None over the first part of a recording, in the first sample's axes.

    Readings are turned back by the gyroscope, so that a sensor in motion shows the vertical, too: a force that
    accelerates it one way soon accelerates it back.

    Args:
        one: The readings.
        seconds: Length of that part.
    """
    count = max(1, round(seconds * one.rate_hz))
    rates = np.nan_to_num(one.angular_velocity_rad_s[:count])
    turns = exponential(0.5 * (rates[1:] + rates[:-1]) / one.rate_hz)
    course = [np.array([0.0, 0.0, 0.0, 1.0])]
    for turn in turns:
        course.append(multiply(course[-1], turn))
    since = np.array(course)
    force = np.nanmean(rotate(since, one.specific_force_mps2[:count]), axis=0)
    if one.magnetic_field is None or not np.isfinite(one.magnetic_field[:count]).all(axis=1).any():
        return force, None
    return force, np.nanmean(rotate(since, one.magnetic_field[:count]), axis=0)


def _resting_rate(one: ImuReadings) -> Array:
    """(3,) root mean square rate over the first part of a recording, rad/s; 0 without samples."""
    rates = one.angular_velocity_rad_s[: max(1, round(REST_S * one.rate_hz))]
    rates = rates[np.isfinite(rates).all(axis=1)]
    return np.sqrt((rates**2).mean(axis=0)) if len(rates) else np.zeros(3)


def _check(one: ImuReadings) -> None:
    count = max(1, round(REST_S * one.rate_hz))
    if not np.isfinite(one.angular_velocity_rad_s).all(axis=1).any():
        raise InvalidInput(f"sensor {one.name}: no gyroscope; its orientation cannot be followed without one")
    if not np.isfinite(one.specific_force_mps2[:count]).all(axis=1).any():
        raise InvalidInput(
            f"sensor {one.name}: the accelerometer is missing at the start; cut the recording there"
        )


def _together(readings: Sequence[ImuReadings], settings: OrientSettings) -> list[list[int]]:
    """Indices of sensors with the same number of samples, rate and instruments, and alike in clipping."""
    groups: dict[tuple[int, float, bool, bool], list[int]] = {}
    for k, one in enumerate(readings):
        magnetic = settings.magnetometer and first_readings(one)[1] is not None
        groups.setdefault((one.samples, one.rate_hz, magnetic, bool(soft_limits(one))), []).append(k)
    if settings.method != "smooth":
        return list(groups.values())
    split = []
    for (samples, *_), group in groups.items():
        many = max(1, MOST_SMOOTHED // max(samples, 1))
        split += [group[k : k + many] for k in range(0, len(group), many)]
    return split


def _widened(settings: OrientSettings) -> OrientSettings:
    """Settings for a gyroscope that clips softly."""
    noise = max(settings.ekf.gyro_scale_noise, SATURATED_SCALE_NOISE)
    return replace(settings, ekf=replace(settings.ekf, gyro_scale_noise=noise))


def _bridged(gyro: Array, most: int) -> Array:
    """(T, N, 3) angular velocities whose gaps of at most so many samples are interpolated."""
    found = gyro.copy()
    for n in range(gyro.shape[1]):
        lost = np.any(np.isnan(gyro[:, n]), axis=1)
        known = np.flatnonzero(~lost)
        gaps = [range(a, b) for a, b in runs(lost) if a > 0 and b < len(gyro) and b - a <= most]
        rows = [row for gap in gaps for row in gap]
        for axis in range(3):
            found[rows, n, axis] = np.interp(rows, known, gyro[known, n, axis]) if rows else 0.0
    return found


def _run(
    group: Sequence[ImuReadings],
    settings: OrientSettings,
    start: Array | None,
    progress: StageCallback | None,
) -> list[tuple[Array, Array, Array | None]]:
    """Per sensor its quaternions (T, 4) in NWU, bias (T, 3) and standard deviations (T, 3) or None."""
    smooth = settings.method == "smooth"
    gyro = np.stack([one.angular_velocity_rad_s for one in group], axis=1)
    if smooth:
        gyro = _bridged(gyro, round(BRIDGED_S * group[0].rate_hz))
    force = np.stack([one.specific_force_mps2 for one in group], axis=1)
    rest = [first_readings(one) for one in group]
    first, magnetic = np.array([f for f, _ in rest]), settings.magnetometer and rest[0][1] is not None
    fields = [one.magnetic_field for one in group if one.magnetic_field is not None]
    field = np.stack(fields, axis=1) if magnetic else None
    first_field = np.array([m for _, m in rest]) if magnetic else None
    dt = 1.0 / group[0].rate_hz
    samples, done = len(gyro), 0

    def count_one() -> None:
        nonlocal done
        done += 1
        if progress is not None and (done % 1000 == 0 or done == samples - 1):
            progress("Orientation", done, samples)

    if settings.method == "madgwick":
        filter_ = MadgwickFilter(dt, settings.madgwick)
        begins = filter_.begin(first, first_field) if start is None else filter_.begin_at(start)
        course = madgwick_course(filter_, begins, gyro, force, field, count_one=count_one)
        return [(course.quaternion[:, n], course.gyro_bias[:, n], None) for n in range(len(group))]
    kalman = OrientationFilter(dt, settings.ekf)
    begin = kalman.begin(first, first_field, np.array([_resting_rate(one) for one in group]))
    if start is not None:
        P = begin.P.copy()
        P[:, [0, 1, 2], [0, 1, 2]] = GIVEN_SD_RAD**2
        begin = begin._replace(quaternion=start, P=P)
    q, bias, variance = orientation_course(
        kalman, begin, gyro, force, field, smooth=smooth, count_one=count_one
    )
    return [
        (
            q[:, n],
            bias[:, n],
            stated_sd(
                variance[:, n, :3],
                q[:, n],
                gyro[:, n] - bias[:, n],
                None if field is None else field[:, n],
                group[n].rate_hz,
                settings.ekf,
                smooth=smooth,
            ),
        )
        for n in range(len(group))
    ]
