"""Orientations of sensors over a whole recording: by the compiled kernel, or step by step without it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.orientation_ekf import OrientationFilter, OrientationState, Passage
from mbkf.imu.orientation_smoothing import SmoothedOrientation, smoothed
from mbkf.kernel.loading import library


def orientation_course(
    kalman: OrientationFilter,
    start: OrientationState,
    gyro: Array,
    specific_force: Array,
    magnetic_field: Array | None,
    *,
    smooth: bool,
    count_one: Callable[[], None] | None = None,
) -> SmoothedOrientation:
    """The course of N sensors over T samples.

    Args:
        kalman: The filter.
        start: State at the first sample.
        gyro: (T, N, 3) angular velocity, rad/s, NaN where missing.
        specific_force: (T, N, 3) m/s², NaN where missing.
        magnetic_field: (T, N, 3) µT, NaN where missing; None without magnetometers.
        smooth: Whether later samples correct earlier ones.
        count_one: Called after each sample but the first.
    """
    kernel = library()
    if kernel is not None:
        course = np.empty((gyro.shape[1], len(gyro), 16))
        given = (None if one is None else _numbers(one) for one in (gyro, specific_force, magnetic_field))
        rates, force, field = given
        assert rates is not None
        assert force is not None
        if kernel.orientation_course(_noise(kalman), _start(start), rates, force, field, course, smooth):
            for _ in range(len(gyro) - 1 if count_one is not None else 0):
                count_one()  # type: ignore[misc]
            whole = course.transpose(1, 0, 2)
            return SmoothedOrientation(whole[..., :4], whole[..., 4:7], whole[..., 7:])
    passages = _counted(kalman.run(gyro, specific_force, magnetic_field, start), count_one)
    if smooth:
        return smoothed(start, passages)
    states = [start, *(passage.state for passage in passages)]
    return SmoothedOrientation(
        np.array([state.quaternion for state in states]),
        np.array([state.gyro_bias for state in states]),
        np.array([np.diagonal(state.P, axis1=1, axis2=2) for state in states]),
    )


def _counted(passages: Iterable[Passage], count_one: Callable[[], None] | None) -> Iterator[Passage]:
    for passage in passages:
        if count_one is not None:
            count_one()
        yield passage


def _numbers(values: Array) -> Array:
    return np.ascontiguousarray(values, dtype=np.float64)


def _start(state: OrientationState) -> Array:
    """(N, 108) numbers of a state, field by field."""
    n = len(state.quaternion)
    return np.ascontiguousarray(np.hstack([np.reshape(part, (n, -1)) for part in state]))


def _noise(kalman: OrientationFilter) -> Array:
    """The numbers of ``OrientationNoise`` in ``mbkf/kernel/orientation.h``, in its order."""
    s, dt = kalman.settings, kalman.dt_s
    return np.array(
        [
            dt, GRAVITY_M_S2, s.gyro_noise**2, s.gyro_scale_noise**2, s.bias_walk**2 * dt,
            s.accelerometer_noise**2 * dt, 1.0 - np.exp(-dt / s.acceleration_memory_s), s.turning_mps**2,
            s.still_velocity_sd_m_s**2,
            s.velocity_memory_s**2, s.velocity_sd_m_s**2, s.velocity_memory_s / dt,
            s.heading_sd_rad**2 * s.heading_memory_s / dt, s.heading_memory_s / dt, s.field_tolerance,
            s.dip_tolerance_rad**2, s.field_memory_s,
            1.0 - np.exp(-dt / (0.5 * s.rest_after_s)), s.rest_rate_rad_s, s.rest_force_mps2, s.rest_after_s,
            s.gyro_noise**2 / dt, float(s.rest_bias), float(s.integrating),
        ]
    )  # fmt: skip
