"""Misfit between a body and the readings of its sensors, which decides between ways of mounting them.

A body whose sensors are exchanged, or strapped on the other way round than it takes them to be, cannot stand on feet
that rest while its sensors turn as they do. The gyroscopes' innovations times the motion of feet
that should rest is least for the true mounting. Innovations only add to their sum of squares, so that most wrong
mountings are refused long before the end.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.sensors.block import AnyBlock, Rows
from mbkf.sensors.body_sensors import BodySensors
from mbkf.sensors.standing_feet import FOOT_REST, RESTING_ROWS, ROLLING_ROWS, StandingFeet

MOVING_RAD_S = 1.0
"""A sensor that turns faster shows that the person moves."""

LOOKED_AT_S = 5.0
"""So much of a movement is looked at."""

SETTLED_S = 0.3
"""The first frames still find out how fast the body moves."""


class _Squares:
    """Innovations as they come, and the least root mean square that they can end with."""

    def __init__(self, most: Array) -> None:
        """Args: (T,) the most innovations of each frame."""
        self._most = most
        self._values: list[Array] = []
        self._sum, self._count = 0.0, 0

    def add(self, values: Array) -> None:
        """Adds a frame's."""
        self._values.append(values)
        self._sum += float(values @ values)
        self._count += len(values)

    def least(self, t: int) -> float:
        """Least root mean square at the end, when the innovations up to frame t are in."""
        return float(np.sqrt(self._sum / max(self._count + self._most[t + 1 :].sum(), 1)))

    def rms(self) -> float:
        """The root mean square; 0 without innovations."""
        values = np.concatenate([np.zeros(0), *self._values])
        return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0


class Misfit:
    """Gyroscopes' innovations (root mean square, whitened) times those of feet that stand, frame by frame.

    Attributes:
        frames: Number of frames that are looked at, from the first on.
    """

    def __init__(self, filter: TrackingFilter, recording: Recording) -> None:
        """Args: the filter and its readings."""
        assert recording.imus is not None
        self.frames = looked_at(recording)
        self._filter, self._first, self._seen = filter, round(SETTLED_S / recording.dt_s), False
        self._rates = _Squares(np.full(self.frames, 3 * recording.imus.shape[1]))
        self._feet = _Squares(_most_rows(recording)[: self.frames])

    def add(self, t: int, posterior: Posterior) -> None:
        """Adds the filtered estimate of frame t; frames beyond :attr:`frames` do not count."""
        if self._first <= t < self.frames:
            assert posterior.record.step is not None
            parts, self._seen = posterior.record.step.readings.parts, True
            self._rates.add(_of(self._filter, parts, BodySensors).reshape(-1, 2, 3)[:, 0].ravel())
            self._feet.add(_of(self._filter, parts, StandingFeet))

    def least(self, t: int) -> float:
        """Least value at the end, when the estimates up to frame t are in."""
        return self._rates.least(t) * self._feet.least(t)

    @property
    def value(self) -> float:
        """The misfit; inf without an estimate."""
        return self._rates.rms() * (self._feet.rms() or 1.0) if self._seen else np.inf


def misfit(filter: TrackingFilter, recording: Recording, beyond: float = np.inf) -> float:
    """The value of :class:`Misfit`; inf: implausible.

    Args:
        filter: The filter.
        recording: Its readings; their beginning is looked at.
        beyond: The answer is inf, too, as soon as the misfit is certain to exceed this.
    """
    found = Misfit(filter, recording)
    for t, posterior, _ in followed(TrackingLoop(filter), recording):
        if t >= found.frames:
            break
        found.add(t, posterior)
        if found.least(t) > beyond:
            return np.inf
    return found.value


def _most_rows(recording: Recording) -> Array:
    """(T,) the most innovations of standing feet."""
    rest = recording.readings.get(FOOT_REST)
    if rest is None:
        return np.full(len(recording), 2 * ROLLING_ROWS)
    return np.where(rest > 0.5, RESTING_ROWS, ROLLING_ROWS).sum(axis=1)


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
