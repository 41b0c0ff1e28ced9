"""Orientations by Madgwick's filter over a whole recording: by the compiled kernel, or step by step without it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple, TypeVar

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.madgwick import MadgwickFilter, MadgwickState
from mbkf.kernel.loading import library

SIDE_BY_SIDE = 20
"""From so many sensors on arrays over sensors beat floats."""

Item = TypeVar("Item")


class MadgwickCourse(NamedTuple):
    """Quaternions (T, N, 4), sensor → NWU as (x, y, z, w), and biases of the gyroscopes (T, N, 3), rad/s."""

    quaternion: Array
    gyro_bias: Array


def madgwick_course(
    filter_: MadgwickFilter,
    start: MadgwickState,
    gyro: Array,
    specific_force: Array,
    magnetic_field: Array | None,
    *,
    count_one: Callable[[], None] | None = None,
) -> MadgwickCourse:
    """The course of N sensors over T samples.

    Args:
        filter_: The filter.
        start: State of N sensors at the first sample, their biases 0.
        gyro: (T, N, 3) angular velocity, rad/s, NaN where missing.
        specific_force: (T, N, 3) any unit, NaN where missing.
        magnetic_field: (T, N, 3) any unit, NaN where missing; None without magnetometers.
        count_one: Called after each sample but the first.
    """
    kernel, gains = library(), filter_.settings
    if kernel is None:
        return _step_by_step(filter_, start, gyro, specific_force, magnetic_field, count_one)
    rates, force = _numbers(gyro), _numbers(specific_force)
    field = None if magnetic_field is None else _numbers(magnetic_field)
    first = _numbers(start.quaternion)
    course = kernel.madgwick_course(first, rates, force, field, filter_.dt_s, gains.beta, gains.zeta)
    for _ in range(len(gyro) - 1 if count_one is not None else 0):
        count_one()  # type: ignore[misc]
    return MadgwickCourse(*course)


def _step_by_step(
    filter_: MadgwickFilter,
    start: MadgwickState,
    gyro: Array,
    force: Array,
    field: Array | None,
    count_one: Callable[[], None] | None,
) -> MadgwickCourse:
    """Few sensors one by one in floats, many side by side in arrays."""
    first = start.quaternion
    if len(first) >= SIDE_BY_SIDE:
        states = list(_counted(filter_.run(gyro, force, field, start), count_one))
        return MadgwickCourse(
            np.array([state.quaternion for state in states]), np.array([state.gyro_bias for state in states])
        )
    courses = []
    for n, one in enumerate(first):
        run = filter_.run(
            gyro[:, n], force[:, n], None if field is None else field[:, n], filter_.begin_at(one)
        )
        states = list(_counted(run, count_one) if n == 0 else run)
        courses.append(([state.q for state in states], [state.bias for state in states]))
    q = np.array([quaternions for quaternions, _ in courses])[:, :, [1, 2, 3, 0]]
    bias = np.array([biases for _, biases in courses])
    return MadgwickCourse(q.swapaxes(0, 1), bias.swapaxes(0, 1))


def _counted(items: Iterable[Item], count_one: Callable[[], None] | None) -> Iterator[Item]:
    """The items; all but the first are counted."""
    for k, item in enumerate(items):
        if k and count_one is not None:
            count_one()
        yield item


def _numbers(values: Array) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)
