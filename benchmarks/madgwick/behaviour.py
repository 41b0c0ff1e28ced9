"""Statements on Madgwick's filter itself: convergence and noise by β, ζ by the letter, Cardan's lock, known starts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.madgwick.as_printed import madgwick_as_printed
from benchmarks.madgwick.scenes import (
    FOOT,
    RATE_HZ,
    SHOWN_ON,
    STANDING,
    THIGH,
    WALKING,
    filtered,
    rms_deg,
    scene,
    truth_of,
)  # fmt: skip
from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.madgwick import MadgwickSettings
from mbkf.imu.orientation import OrientSettings, euler_angles, orientations
from mbkf.imu.orientation_error import error_angles
from mbkf.imu.virtual import FIELD_UT
from mbkf.io.imu.readings import ImuReadings

BETAS = (0.03, 0.1, 0.35, 1.0)
NEAR_DEG = 5.0
"""Error from which a start counts as forgotten."""

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Behaviour:
    """Measured properties.

    Attributes:
        settling_s: By β the time after which a thigh's error stays below 5°, begun at (1, 0, 0, 0); inf without one.
        jitter_deg: Root mean square of the change from sample to sample less the true one, a person standing, by β.
        start_error_deg: Error of the start that the first readings give, by movement.
        unknown_deg: Root mean square error of the walking thigh from (1, 0, 0, 0) and from the true start, β 0.35.
        zeta_change_deg: Largest change of a foot's orientation by ζ 0.07: Madgwick eq. 34 as printed, and integrated.
        lock_quaternion_deg, lock_yaw_deg: Largest errors of orientation and of yaw alone as pitch passes 90°.
        wrap_deg, unwrapped_deg: Largest step of an Euler angle between samples, before and after unwrapping.
        round_trip: Largest change of a quaternion by way to Euler angles and back.
        printed_deg: Largest angle between the source's filter by the letter (ζ 0) and mbkf's.
    """

    settling_s: dict[float, float]
    jitter_deg: dict[float, float]
    start_error_deg: dict[str, float]
    unknown_deg: tuple[float, float]
    zeta_change_deg: tuple[float, float]
    lock_quaternion_deg: float
    lock_yaw_deg: float
    wrap_deg: float
    unwrapped_deg: float
    round_trip: float
    printed_deg: float


def measure_behaviour() -> Behaviour:
    """All of them, on one of the persons shown."""
    person = SHOWN_ON[0]
    walk, stand = scene(person, WALKING), scene(person, STANDING)
    foot, thigh, still = walk.sensor(FOOT), walk.sensor(THIGH), stand.sensor(THIGH)
    lock = _through_the_lock()
    wrapped, unwrapped = _steps(foot)
    return Behaviour(
        {beta: settling_s(still, beta) for beta in BETAS},
        {beta: _jitter_deg(still, beta) for beta in BETAS},
        {one.movement: _start_error_deg(one.sensor(FOOT)) for one in (walk, stand)},
        (_from(thigh, IDENTITY), _from(thigh, truth_of(thigh)[0])),
        _zeta_changes(foot),
        *lock,
        wrapped,
        unwrapped,
        _round_trip(truth_of(foot)),
        _largest_deg(madgwick_as_printed(foot, 0.35, 0.0, truth_of(foot)[0]), course(foot, 0.35)),
    )


def course(one: ImuReadings, beta: float, zeta: float = 0.0) -> Array:
    """(T, 4) Madgwick's orientations from the true start.

    Args:
        one: The sensor.
        beta: Gain of the gradient step.
        zeta: Gain of the gyroscope's bias.
    """
    settings = OrientSettings("madgwick", madgwick=MadgwickSettings(beta, zeta))
    return filtered([one], settings)[0].quaternion


def unknown_start(one: ImuReadings, beta: float, start: Array = IDENTITY) -> Array:
    """(T, 4) Madgwick's orientations from a given start.

    Args:
        one: The sensor.
        beta: Gain of the gradient step.
        start: (4,) orientation at the first sample.
    """
    settings = OrientSettings("madgwick", madgwick=MadgwickSettings(beta))
    (found,) = orientations([one], frame="NWU", settings=settings, start=start[None])
    return found.quaternion


def settling_s(one: ImuReadings, beta: float) -> float:
    """Time after which the error from the start (1, 0, 0, 0) stays below 5°, s; inf where it never does.

    Args:
        one: The sensor.
        beta: Gain of the gradient step.
    """
    error = np.degrees(error_angles(unknown_start(one, beta), truth_of(one))[0])
    late = np.flatnonzero(error > NEAR_DEG)
    if not len(late):
        return 0.0
    return float(one.time_s[late[-1] + 1] - one.time_s[0]) if late[-1] + 1 < one.samples else np.inf


def _jitter_deg(one: ImuReadings, beta: float) -> float:
    """Over the second half, when the start is forgotten."""
    half = one.samples // 2
    off = (
        Rotation.from_quat(course(one, beta)[half:])
        * Rotation.from_quat(np.array(truth_of(one)[half:])).inv()
    )
    return float(np.degrees(np.sqrt(np.mean((off[1:] * off[:-1].inv()).magnitude() ** 2))))


def _start_error_deg(one: ImuReadings) -> float:
    (found,) = orientations([one], frame="NWU", settings=OrientSettings("madgwick"))
    return float(np.degrees(error_angles(found.quaternion[:1], truth_of(one)[:1])[0][0]))


def _from(one: ImuReadings, start: Array) -> float:
    return rms_deg([unknown_start(one, 0.35, start)], [one])


def _zeta_changes(one: ImuReadings) -> tuple[float, float]:
    start, without = truth_of(one)[0], course(one, 0.35)
    letter, own = madgwick_as_printed(one, 0.35, 0.07, start), course(one, 0.35, 0.07)
    return _largest_deg(letter, without), _largest_deg(own, without)


def _largest_deg(first: Array, second: Array) -> float:
    return float(np.degrees(error_angles(first, second)[0].max()))


def turning_through_the_lock() -> ImuReadings:
    """A perfect sensor that pitches from 0 to 170° and back at a steady roll of 10°."""
    time = np.arange(round(6.0 * RATE_HZ)) / RATE_HZ
    pitch = np.radians(85.0) * (1.0 - np.cos(2.0 * np.pi * time / 6.0))
    turns = Rotation.from_euler("ZYX", np.column_stack([0.0 * time + 0.5, pitch, 0.0 * time + 0.17]))
    steps = (turns[:-1].inv() * turns[1:]).as_rotvec() * RATE_HZ
    rates = np.vstack([steps[:1], steps])
    up, field = np.array([0.0, 0.0, GRAVITY_M_S2]), np.array(FIELD_UT)
    return ImuReadings(
        "turning",
        time,
        turns.inv().apply(up),
        rates,
        turns.inv().apply(field),
        RATE_HZ,
        "NWU",
        turns.as_quat(),
    )


def _through_the_lock() -> tuple[float, float]:
    one = turning_through_the_lock()
    noise = np.random.default_rng(0).normal(0.0, 0.02, (one.samples, 3))
    found = course(replace(one, angular_velocity_rad_s=one.angular_velocity_rad_s + noise), 0.1)
    yaw = euler_angles(found)[:, 2] - euler_angles(truth_of(one))[:, 2]
    yaw = yaw - 2.0 * np.pi * np.round(yaw / (2.0 * np.pi))
    return _largest_deg(found, truth_of(one)), float(np.degrees(np.abs(yaw).max()))


def wrapped_euler_deg(q: Array) -> Array:
    """(T, 3) roll, pitch and yaw as arc tangents give them, degrees."""
    return Rotation.from_quat(np.array(q)).as_euler("ZYX", degrees=True)[:, ::-1]


def _steps(one: ImuReadings) -> tuple[float, float]:
    """A walk whose heading lies near 180°: there an arc tangent jumps."""
    turned = Rotation.from_euler("z", 180.0, degrees=True) * Rotation.from_quat(course(one, 0.35))
    wrapped, smooth = wrapped_euler_deg(turned.as_quat()), np.degrees(euler_angles(turned.as_quat()))
    return float(np.abs(np.diff(wrapped, axis=0)).max()), float(np.abs(np.diff(smooth, axis=0)).max())


def _round_trip(q: Array) -> float:
    angles = euler_angles(q)
    back = Rotation.from_euler("ZYX", angles[:, ::-1]).as_quat()
    near = np.where((back * q).sum(axis=1, keepdims=True) < 0.0, -back, back)
    return float(np.abs(near - q).max())
