"""Sensors of one session on one clock: recordings that begin and end at different times, at different rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.imu.readings import ImuReadings, on_regular_grid
from mbkf.io.imu.signals import Signal, resampled

EPOCH_S = 1e6
"""Times beyond this count from a date, not from the start of a recording."""

_LEAST_COMMON_S = 0.5
_SAME_S = 1e-6


def on_one_clock(
    sensors: Sequence[ImuReadings], *, started_together: bool = False, from_zero: bool = False
) -> tuple[ImuReadings, ...]:
    """The sensors at the same times: those of the slowest one within the time that all of them cover.

    Readings between samples are interpolated; sensors that have the same times already stay as they are.

    Args:
        sensors: The sensors.
        started_together: The first samples of all of them are simultaneous, whatever their clocks say.
        from_zero: Times begin at 0; by default they do where they count from a date.

    Raises:
        InvalidInput: The sensors have no time in common.
    """
    if started_together:
        sensors = [replace(one, time_s=one.time_s - one.time_s[0]) for one in sensors]
    if not _in_step(sensors):
        sensors = _common(sensors)
    first = min((float(one.time_s[0]) for one in sensors), default=0.0)
    if (from_zero or first > EPOCH_S) and first != 0.0:
        sensors = [replace(one, time_s=one.time_s - first) for one in sensors]
    return tuple(sensors)


def _in_step(sensors: Sequence[ImuReadings]) -> bool:
    """True for sensors with the same times."""
    return all(
        len(one.time_s) == len(sensors[0].time_s)
        and bool((np.abs(one.time_s - sensors[0].time_s) < _SAME_S).all())
        for one in sensors[1:]
    )


def _common(sensors: Sequence[ImuReadings]) -> list[ImuReadings]:
    first = max(float(one.time_s[0]) for one in sensors)
    last = min(float(one.time_s[-1]) for one in sensors)
    if last - first < _LEAST_COMMON_S and last - first < 0.5 * min(
        float(one.time_s[-1] - one.time_s[0]) for one in sensors
    ):
        early = min(sensors, key=lambda one: float(one.time_s[-1]))
        late = max(sensors, key=lambda one: float(one.time_s[0]))
        raise InvalidInput(
            f"sensor {early.name} ends at {early.time_s[-1]:.2f} s, {late.name} begins at {late.time_s[0]:.2f} s: the "
            "sensors have no time in common; export one trial only, or say --started-together"
        )
    slowest = on_regular_grid(min(sensors, key=lambda one: one.rate_hz))
    margin = 0.5 / slowest.rate_hz
    times = slowest.time_s[(slowest.time_s >= first - margin) & (slowest.time_s <= last + margin)]
    return [_at(one, times, slowest.rate_hz) for one in sensors]


def _at(one: ImuReadings, times: Array, rate_hz: float) -> ImuReadings:
    """A sensor at other times."""
    own = np.round((times - one.time_s[0]) * one.rate_hz).astype(int)
    kept = np.clip(own, 0, one.samples - 1)
    own_samples = bool((np.abs(one.time_s[kept] - times) < _SAME_S).all())

    def pick(values: Array, kind: str) -> Array:
        own_signal = Signal(one.name, kind, one.time_s, values)
        found = values[kept] if own_samples else resampled(own_signal, times)
        return found / np.linalg.norm(found, axis=1, keepdims=True) if kind == "quat" else found

    moving = None if one.moving is None else one.moving[kept]
    return replace(one.at(times, pick, moving), rate_hz=rate_hz)
