"""Orientations of sensors over a whole recording: by the compiled kernel, or step by step without it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.orientation_ekf import OrientationFilter, OrientationState, Passage
from mbkf.imu.orientation_smoothing import SmoothedOrientation, smoothed
from mbkf.kernel.loading import library
from mbkf.kernel.state_functions import OrientationNoise


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
        rates, force = _numbers(gyro), _numbers(specific_force)
        field = None if magnetic_field is None else _numbers(magnetic_field)
        state = OrientationState(*map(_numbers, start))
        positive, *course = kernel.orientation_course(
            _noise(kalman),
            state.quaternion,
            state.gyro_bias,
            state.velocity,
            state.P,
            state.movement,
            state.field,
            state.calm,
            state.last,
            rates,
            force,
            field,
            smooth,
        )
        if positive:
            for _ in range(len(gyro) - 1 if count_one is not None else 0):
                count_one()  # type: ignore[misc]
            return SmoothedOrientation(*course)
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


def _noise(kalman: OrientationFilter) -> OrientationNoise:
    """The filter's settings as numbers per step."""
    s, dt = kalman.settings, kalman.dt_s
    return OrientationNoise(
        dt_s=dt,
        gravity_m_s2=GRAVITY_M_S2,
        gyro_noise=s.gyro_noise**2,
        gyro_scale_noise=s.gyro_scale_noise**2,
        bias_walk=s.bias_walk**2 * dt,
        accelerometer_noise=s.accelerometer_noise**2 * dt,
        moved=1.0 - np.exp(-dt / s.acceleration_memory_s),
        turning=s.turning_mps**2,
        still_variance=s.still_velocity_sd_m_s**2,
        memory_squared=s.velocity_memory_s**2,
        most_variance=s.velocity_sd_m_s**2,
        velocity_samples=s.velocity_memory_s / dt,
        heading=s.heading_sd_rad**2 * s.heading_memory_s / dt,
        heading_samples=s.heading_memory_s / dt,
        field_tolerance=s.field_tolerance,
        dip_variance=s.dip_tolerance_rad**2,
        field_memory_s=s.field_memory_s,
        calm=1.0 - np.exp(-dt / (0.5 * s.rest_after_s)),
        rest_rate_rad_s=s.rest_rate_rad_s,
        rest_force_m_s2=s.rest_force_mps2,
        rest_after_s=s.rest_after_s,
        rest_variance=s.gyro_noise**2 / dt,
        resting=s.rest_bias,
        integrating=s.integrating,
    )
