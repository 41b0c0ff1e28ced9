"""Magnetometers of sensors on a body that see another field than the others do, before any motion is known.

Gyroscope and accelerometer give a sensor's attitude but for its heading, and so the size and the dip of the field that
its magnetometer sees. Legs show their headings: they swing about the body's side-to-side axis, shanks bend to one side
only, and a foot turns with its shank. None of it depends on how sensors are strapped on.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from mbkf.conventions import Array
from mbkf.imu.frames import conjugate, multiply, rotate
from mbkf.imu.heading import turned
from mbkf.imu.orientation import OrientSettings, orientations
from mbkf.imu.sensor_to_segment import swing_axis, turn_about
from mbkf.io.imu.readings import ImuReadings
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.trial.inertial.fields import DisturbedField, Swing, fields_unlike_others

LEAST_BEND_RAD = 0.05
"""A shank that is turned by less since standing, in the mean, does not show where the left is."""

FIELDS_EVERY = 5
"""Every so many samples fields are compared."""


def disturbed_magnetometers(
    body: HumanModel, segments: Sequence[str], sensors: Sequence[ImuReadings], q: Array, upright: Array
) -> tuple[DisturbedField, ...]:
    """Magnetometers whose field differs from the others'.

    Args:
        body: The body.
        segments: (S,) segments, the pelvis first.
        sensors: They.
        q: (T, S, 4) their orientations by their fields, sensor → world, z up, at the first one's times.
        upright: (S, 4) the same while standing.
    """
    time_s = sensors[0].time_s
    free, rates = free_orientations(sensors, time_s), turning_rates(q, time_s)
    # The pelvis's turn follows from its gyroscope alone: its field may be the disturbed one.
    twist = multiply(free[:, 0], conjugate(free[0, 0]))
    back = -2.0 * np.arctan2(twist[:, 2], twist[:, 3])
    stood = turned(q, np.tile(back[:, None], (1, len(segments))))
    thinned = slice(None, None, FIELDS_EVERY)
    rotations = [quaternion_matrices(free[thinned, k]) for k in range(len(segments))]
    fields = [_field_at(one, time_s[thinned]) for one in sensors]
    # Size and dip come first: a foot's heading follows from its shank's.
    found = fields_unlike_others(fields, rotations, [None] * len(segments))
    disturbed = {one.sensor for one in found}
    sound = [k for k, one in enumerate(sensors) if one.name not in disturbed]
    swing = leg_swings(body, [segments[k] for k in sound], stood[:, sound], rates[:, sound], upright[sound])
    return found + fields_unlike_others([fields[k] for k in sound], [rotations[k] for k in sound], swing)


def leg_swings(
    body: HumanModel, segments: Sequence[str], stood: Array, rates: Array, upright: Array
) -> list[Swing | None]:
    """Swing of the legs' segments, each in the world of its own field; None: other segments and those without swing.

    Args:
        body: The body.
        segments: (S,) segments.
        stood: (T, S, 4) sensor → world, less how the pelvis has turned since standing.
        rates: (T, S, 3) angular velocities, rad/s in sensor axes.
        upright: (S, 4) sensor → world while standing.
    """
    legs = {*(one for knee in body.roles.knees for one in knee), *body.roles.feet}
    axes = {name: swing_axis(stood[:, [k]], rates[:, [k]]) for k, name in enumerate(segments) if name in legs}
    level, with_sense = np.nan_to_num(rotate(stood, rates))[..., :2], set[str]()
    for (_, shank), foot in zip(body.roles.knees, body.roles.feet, strict=True):
        left = axes.get(shank)
        bend = 0.0 if left is None else turn_about(stood[:, (k := segments.index(shank))], upright[k], left)
        if left is None or abs(bend) < LEAST_BEND_RAD:
            continue
        axes[shank] = left = left * np.sign(bend)
        with_sense.add(shank)
        own = axes.get(foot)
        if own is not None:
            together = (level[:, k] @ left) @ (level[:, segments.index(foot)] @ own)
            axes[foot] = own * (1.0 if together > 0.0 else -1.0)
            with_sense.add(foot)
    found = list[Swing | None]()
    for name in segments:
        axis = axes.get(name)
        found.append(None if axis is None else Swing(float(np.arctan2(axis[1], axis[0])), name in with_sense))
    return found


def free_orientations(sensors: Sequence[ImuReadings], time_s: Array) -> Array:
    """(T, S, 4) orientations without magnetometers at some times, each in a world of its own, z up."""
    found = orientations(sensors, frame="NWU", settings=OrientSettings("smooth", magnetometer=False))
    courses = [
        at_times(one.time_s, course.quaternion, time_s) for one, course in zip(sensors, found, strict=True)
    ]
    return np.stack(courses, axis=1)


def turning_rates(q: Array, time_s: Array) -> Array:
    """(T, S, 3) angular velocities, rad/s in sensor axes, of orientations (T, S, 4); the last one is repeated."""
    between = multiply(conjugate(q[:-1]), q[1:])
    between = np.where(between[..., 3:] < 0.0, -between, between)
    rates = 2.0 * between[..., :3] / np.diff(time_s)[:, None, None]
    return np.concatenate([rates, rates[-1:]])


def at_times(times: Array, course: Array | None, wanted: Array) -> Array:
    """(T, 4) orientations at other times; missing ones are bridged.

    Args:
        times: (N,) times, s.
        course: (N, 4) orientations then, NaN where missing.
        wanted: (T,) the other times.
    """
    assert course is not None
    there = np.all(np.isfinite(course), axis=1)
    if there.all() and len(times) == len(wanted) and np.array_equal(times, wanted):
        return course
    between = Slerp(times[there], Rotation.from_quat(course[there]))
    return np.asarray(between(np.clip(wanted, times[there][0], times[there][-1])).as_quat())


def _field_at(one: ImuReadings, times_s: Array) -> ImuReadings:
    """A sensor's field at some times; its other readings are left out."""
    assert one.magnetic_field is not None
    field = np.column_stack([np.interp(times_s, one.time_s, axis) for axis in one.magnetic_field.T])
    force, rate = np.zeros((2, len(times_s), 3))
    return ImuReadings(one.name, times_s, force, rate, field, one.rate_hz)
