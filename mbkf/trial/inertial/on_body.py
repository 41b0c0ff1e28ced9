"""Inertial sensors on a tracked body: read at its frames, and calibrated on its motion.

Where a sensor sits and how it is turned follow from a motion that markers have shown: the segment's angular velocity
gives the rotation (Wahba 1965, by singular values) and the bias, its specific force at any point, which is linear in
the point, gives the place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.filters.estimate import Recording
from mbkf.filters.record import Track
from mbkf.filters.tracking import track
from mbkf.imu.checks import problems, refuse_fatal
from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.placement import usual_place
from mbkf.imu.segments import segment_of
from mbkf.io.imu.mount import ImuMount
from mbkf.io.imu.readings import ImuReadings, on_regular_grid
from mbkf.model.body import Body
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.trial.preparation.filters import FilterInputs, tracking_filter

LEAST_TURNING_RAD_S = 0.3
"""A sensor whose segment turns less than this (root mean square) is not calibrated on its motion."""

PLACE_SD_M, BIAS_SD_RAD_S = 0.04, 0.01
"""Spread of a sensor about its usual place, and of gyroscopes' readings at rest, before any measurement."""

_ROUNDS = 5
_FORCE_WEIGHT = 0.1
_FORCE_SD = 2.0
_REPEATED = 10


@dataclass(frozen=True)
class ImuOnBody:
    """Readings of sensors and, where known, their mounts; without mounts a sensor's name gives its segment."""

    readings: tuple[ImuReadings, ...]
    mounts: tuple[ImuMount, ...] = ()


def with_imus(
    inputs: FilterInputs, recording: Recording, times_s: Array, imus: ImuOnBody
) -> tuple[FilterInputs, Recording, tuple[str, ...]]:
    """A trial's inputs and recording with its sensors, and warnings about them.

    The trial is first tracked by markers alone, to calibrate the sensors on its motion: mounts that are given keep
    their place, only their gyroscopes' biases are found.

    Args:
        inputs: The trial's inputs without sensors.
        recording: Its markers and plates.
        times_s: (T,) times of its frames, s.
        imus: The sensors' readings, and their mounts where known.

    Raises:
        InvalidInput: Readings are not plausible, do not overlap with the trial, or are too still to be calibrated.
        UnknownName: A sensor's segment is not known.
    """
    warnings = refuse_fatal(problems(imus.readings))
    model = inputs.sensor.model
    measured = frame_readings([on_regular_grid(one) for one in imus.readings], times_s)
    if not np.isfinite(measured).any():
        raise InvalidInput(
            "the inertial readings do not overlap with the trial in time; both need the same clock"
        )
    first = track(tracking_filter("dynamic", inputs), recording)
    mounts, biases = calibrated(model, first, measured, imus)
    measured[:, :, :3] -= biases
    return (
        replace(inputs, inertial=InertialSensor(model, mounts)),
        replace(recording, imus=measured),
        warnings,
    )


def frame_readings(readings: Sequence[ImuReadings], times_s: Array) -> Array:
    """(T, S, 6) angular velocity and specific force at the frames' times, NaN outside or inside a gap.

    A sensor faster than the frames is averaged over each frame, a slower one joined by straight lines.
    """
    step = float(np.median(np.diff(times_s))) if len(times_s) > 1 else 1.0
    found = np.full((len(times_s), len(readings), 6), np.nan)
    for k, one in enumerate(readings):
        values = np.hstack([one.angular_velocity_rad_s, one.specific_force_mps2])
        width = max(1, round(step * one.rate_hz))
        if width > 1:
            kernel = np.ones(width) / width
            values = np.column_stack([np.convolve(column, kernel, mode="same") for column in values.T])
        # An even window has its middle half a sample later than its own sample.
        times = one.time_s - (0.5 / one.rate_hz if width % 2 == 0 else 0.0)
        for c in range(6):
            found[:, k, c] = np.interp(times_s, times, values[:, c], left=np.nan, right=np.nan)
    return found


def calibrated(
    model: Body, motion: Track, measured: Array, imus: ImuOnBody
) -> tuple[tuple[ImuMount, ...], Array]:
    """Mounts, and biases of the gyroscopes (S, 3), of sensors on a body whose motion is known.

    Args:
        model: The scaled body.
        motion: Its motion, tracked by markers.
        measured: (T, S, 6) readings at the motion's frames: angular rate rad/s, specific force m/s².
        imus: The sensors, with their mounts where known.

    Raises:
        InvalidInput: A sensor without a mount hardly turned.
        UnknownName: A sensor's segment is not known, or a mount is missing.
    """
    given = {mount.name: mount for mount in imus.mounts}
    mounts, biases = [], []
    good = np.all(np.isfinite(np.hstack([motion.q, motion.a])), axis=1) & motion.tracked
    for k, one in enumerate(imus.readings):
        segment = given[one.name].segment if one.name in given else segment_of(one.name, model.joints)
        there = np.flatnonzero(good & np.isfinite(measured[:, k]).all(axis=1))
        if len(there) < 20:
            raise InvalidInput(
                f"sensor {one.name}: only {len(there)} frames have markers and readings together"
            )
        known = _segment_readings(model, segment, motion, there)
        usual = usual_place(model, segment)
        mount, bias = _calibrate(one.name, segment, known, measured[there, k], given.get(one.name), usual)
        mounts.append(mount)
        biases.append(bias)
    return tuple(mounts), np.array(biases)


def _segment_readings(model: Body, segment: str, motion: Track, frames: NDArray[np.intp]) -> Array:
    """(T, 4, 6) in segment axes: at the segment's origin, then 1 m along each axis."""
    straight = np.array([0.0, 0.0, 0.0, 1.0])
    points = [np.zeros(3), *np.eye(3)]
    sensor = InertialSensor(model, [ImuMount(segment, segment, point, straight) for point in points])
    return np.array([sensor.values(motion.q[t], motion.v[t], motion.a[t]) for t in frames])


def _calibrate(
    name: str, segment: str, known: Array, measured: Array, given: ImuMount | None, usual: Array
) -> tuple[ImuMount, Array]:
    omega, force = known[:, 0, :3], known[:, 0, 3:]
    by_place = (known[:, 1:, 3:] - force[:, None]).transpose(0, 2, 1)
    gyro, felt = measured[:, :3], measured[:, 3:]
    turning = float(np.sqrt((omega**2).sum(axis=1).mean()))
    if given is None and turning < LEAST_TURNING_RAD_S:
        raise InvalidInput(
            f"sensor {name}: its segment hardly turns in this trial; give its mount with --imu-mounts"
        )
    centred_omega, centred_gyro = omega - omega.mean(axis=0), gyro - gyro.mean(axis=0)
    place, count = usual, len(gyro)
    R = np.eye(3) if given is None else quaternion_matrices(given.rotation)
    for _ in range(_ROUNDS if given is None else 0):
        here = force + by_place @ place
        B = centred_omega.T @ centred_gyro + _FORCE_WEIGHT * here.T @ felt
        u, _, vt = np.linalg.svd(B)
        R = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
        # Both sides are known only roughly: the usual place counts as a reading, and samples repeat their errors.
        rows, short = by_place.reshape(-1, 3), (felt @ R.T - force).reshape(-1)
        certainty = 1.0 / (_FORCE_SD**2 * _REPEATED)
        information = certainty * rows.T @ rows + np.eye(3) / PLACE_SD_M**2
        place = np.linalg.solve(information, certainty * rows.T @ short + usual / PLACE_SD_M**2)
    apart = gyro - omega @ R
    spread = apart.var(axis=0) * _REPEATED / count
    bias = apart.mean(axis=0) * BIAS_SD_RAD_S**2 / (BIAS_SD_RAD_S**2 + spread)
    return given or ImuMount(name, segment, place, matrix_quaternion(R)), bias
