"""Records of every filter: readings of a trial, posterior and prediction of a frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, TypeAlias, cast

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.filter import Memory, Prior, Step
from mbkf.filters.plant import StateT
from mbkf.sensors.block import NO_READINGS, Frame
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.marker_sensor import MarkerPrediction


@dataclass(frozen=True)
class Recording:
    """Readings of the instruments in the frames of a trial.

    Attributes:
        markers_m: (T, M, 3) positions, NaN where missing.
        plates: (T, K, 6) force N and moment N m about the world's origin per plate, world axes; NaN where not recorded.
        dt_s: Time between frames.
        imus: (T, S, 6) angular velocity rad/s and specific force m/s² of inertial sensors in their own axes, NaN where
            missing; None where there are none.
        readings: (T, …) of a user's own instruments, by the name that their block knows.
    """

    markers_m: Array
    plates: Array
    dt_s: float
    imus: Array | None = None
    readings: Mapping[str, Array] = field(default_factory=dict)

    def frame(self, t: int) -> Frame:
        """The readings of frame t."""
        imus = None if self.imus is None else self.imus[t]
        own = {name: read[t] for name, read in self.readings.items()} if self.readings else NO_READINGS
        return Frame(self.markers_m[t], self.plates[t], imus, own)

    @classmethod
    def of(cls, frames: Sequence[Frame], dt_s: float) -> Recording:
        """Frames (at least one) that follow each other, ``dt_s`` apart."""
        first = frames[0]
        own = {name: np.array([frame.readings[name] for frame in frames]) for name in first.readings}
        return cls(
            np.array([frame.markers_m for frame in frames]),
            np.array([frame.plates for frame in frames]),
            dt_s,
            None if first.imus is None else np.array([frame.imus for frame in frames]),
            own,
        )

    def __len__(self) -> int:
        return len(self.markers_m)


class Record(NamedTuple, Generic[StateT]):
    """A filter's own record of a frame.

    Attributes:
        state: Mean and covariance, corrected by later frames where they are known.
        step: The step to it; None at a start without readings, and where no step could be computed.
        kept: Memory for the next step where no step led here.
        detail: Further record of the filter's report.
    """

    state: StateT
    step: Step[StateT] | None
    kept: Memory | None
    detail: object

    @property
    def memory(self) -> Memory:
        """Memory for the next step."""
        return cast("Memory", self.kept) if self.step is None else self.step.memory


AnyRecord: TypeAlias = Record[Any]
AnyPrior: TypeAlias = Prior[Any]


class Posterior(NamedTuple):
    """A filter's posterior of one frame.

    Attributes:
        q: (nq,) configuration.
        v, a: (nv,) velocity and acceleration.
        wrench: (2, 6) estimated wrench on right and left foot about the world's origin, NaN where the filter has none.
        contact: Support of right and left foot; None where the filter does not decide it.
        refused: (M,) markers seen but outside their gate.
        tracked: Enough instruments read.
        started: The filter was started in this frame.
        record: The filter's own record of the frame.
        support: (B, 6) wrench about the world's origin on each part of the body that may bear load besides the feet
            (``description.bearings``), 0 on one that bears none; None where the filter has no such state.
        lost: The body is elsewhere than it was predicted: most markers, and at least half of all, lie far off.
        uncorrected: Smoothing failed here (:mod:`mbkf.filters.plausibility`); the estimate is the filtered one.
        placed: Instruments show at once where the body is; without cameras later frames may move it far.
        rejoined: The step into this frame began from another estimate of the frame before than was given: a contact had
            opened there.
    """

    q: Array
    v: Array
    a: Array
    wrench: Array
    contact: tuple[Contact, Contact] | None
    refused: BoolArray
    tracked: bool
    started: bool
    record: AnyRecord
    support: Array | None = None
    lost: bool = False
    uncorrected: bool = False
    placed: bool = True
    rejoined: bool = False


class Prediction(NamedTuple):
    """Prediction of the next frame, before it is known which point is which marker.

    Attributes:
        q: (nq,) predicted configuration.
        markers: Its markers, in the filter's order.
        prior: The filter's predicted state, from which the step goes on and which it uses up; None where the step
            predicts anew.
    """

    q: Array
    markers: MarkerPrediction
    prior: AnyPrior | None


NO_WRENCH = np.full((2, 6), np.nan)
"""The wrench of a filter that estimates none."""
