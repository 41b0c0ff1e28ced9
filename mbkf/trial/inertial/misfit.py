"""Misfit between a body and the readings of its sensors, which decides between ways of mounting them.

A body whose sensors are exchanged, or strapped on the other way round than it takes them to be, cannot stand on feet
that rest while its sensors turn as they do. The gyroscopes' innovations times the motion of feet
that should rest is least for the true mounting.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.sensors.block import AnyBlock, Rows
from mbkf.sensors.body_sensors import BodySensors
from mbkf.sensors.standing_feet import StandingFeet

MOVING_RAD_S = 1.0
"""A sensor that turns faster shows that the person moves."""

LOOKED_AT_S = 5.0
"""So much of a movement is looked at."""

SETTLED_S = 0.3
"""The first frames still find out how fast the body moves."""


def misfit(filter: TrackingFilter, recording: Recording) -> float:
    """Gyroscopes' innovations (root mean square, whitened) times those of feet that stand; inf: implausible.

    Args:
        filter: The filter.
        recording: Its readings; their beginning is looked at.
    """
    first, last = round(SETTLED_S / recording.dt_s), looked_at(recording)
    rates, feet = [], []
    for t, posterior, _ in followed(TrackingLoop(filter), recording):
        if t >= last:
            break
        if t >= first:
            assert posterior.record.step is not None
            parts = posterior.record.step.readings.parts
            rates.append(_of(filter, parts, BodySensors).reshape(-1, 2, 3)[:, 0].ravel())
            feet.append(_of(filter, parts, StandingFeet))
    if not rates:
        return np.inf
    return _rms(np.concatenate(rates)) * (_rms(np.concatenate(feet)) or 1.0)


def looked_at(recording: Recording) -> int:
    """Number of frames to look at: standing before a movement does not count."""
    assert recording.imus is not None
    turning = np.linalg.norm(np.nan_to_num(recording.imus[:, :, :3]), axis=2).max(axis=1) > MOVING_RAD_S
    begin = int(np.argmax(turning)) if turning.any() else 0
    return min(len(recording), begin + max(2, round(LOOKED_AT_S / recording.dt_s)))


def _of(filter: TrackingFilter, parts: Sequence[Sequence[Rows]], kind: type[AnyBlock]) -> Array:
    """(k,) whitened innovations of a filter's first block of a kind."""
    for block, own in zip(filter.kalman.blocks, parts, strict=True):
        if isinstance(block, kind):
            return np.concatenate([np.zeros(0), *(one.innovation for one in own)])
    return np.zeros(0)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
