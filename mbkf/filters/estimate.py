"""One form of every filter's posterior and predictions, for trials, live streams and smoothers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.innovations import Innovations
from mbkf.filters.spread import Spread
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.numerics.passage import LinearStep
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.block import NO_READINGS, Frame
from mbkf.sensors.marker_prediction import MarkerPrediction
from mbkf.sensors.white_noise import WhiteNoise


@dataclass(frozen=True)
class Recording:
    """What the instruments read in the frames of a trial.

    Attributes:
        markers_m: (T, M, 3) positions, NaN where missing.
        plates: (T, K, 6) force N and moment N m about the world's origin per plate, world axes; NaN where not recorded.
        dt_s: Time between frames.
        imus: (T, S, 6) angular velocity rad/s and specific force m/s² of inertial sensors in their own axes, NaN where
            missing; None where there are none.
        readings: (T, …) of instruments of one's own, by the name that their block knows.
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
        if len(frames) == 1:
            own = (
                {name: read[None] for name, read in first.readings.items()} if first.readings else NO_READINGS
            )
            alone = None if first.imus is None else first.imus[None]
            return cls(first.markers_m[None], first.plates[None], dt_s, alone, own)
        imus = None if first.imus is None else np.array([frame.imus for frame in frames])
        return cls(
            np.array([frame.markers_m for frame in frames]),
            np.array([frame.plates for frame in frames]),
            dt_s,
            imus,
            {name: np.array([frame.readings[name] for frame in frames]) for name in first.readings},
        )

    def __len__(self) -> int:
        return len(self.markers_m)


class Posterior(NamedTuple):
    """A filter's posterior of one frame.

    Attributes:
        q: (nq,) configuration.
        v, a: (nv,) velocity and acceleration.
        wrench: (2, 6) estimated wrench on right and left foot about the world's origin, NaN where the filter has none.
        contact: (2,) what the feet stand on, see :class:`mbkf.sensors.contact.records.Contact`; None where the
            filter does not ask.
        refused: (M,) markers seen but outside their gate.
        tracked: Whether enough instruments read.
        started: Whether the filter was started in this frame.
        inner: The filter's own record of the step.
        support: (B, 6) wrench about the world's origin on each part of the body that may bear load besides the feet
            (``description.bearings``), 0 on one that bears none; None where the filter does not ask.
        lag: (nv + 12 or more,) by how much accelerations, the feet's wrenches and those on other parts may lag behind a
            change; None where that is not stated.
        changes: (2, 2, 6) change of the feet's wrenches since the frame before, and of that change, as they were known
            at once; None where they are not.
        later: Whether later frames have corrected it and its covariance.
        lost: Whether the body is elsewhere than it was predicted: most markers, and at least half of all, lie far off.
        uncorrected: Whether later frames should have, and what they made of it was no person
            (:mod:`mbkf.filters.person`).
        plate_noise: What is known of the noise of the plates' forces, N; None where the filter does not ask, or at a
            start.
        placed: Whether instruments show at once where the body is; without cameras later frames may move it far.
    """

    q: Array
    v: Array
    a: Array
    wrench: Array
    contact: tuple[int, int] | None
    refused: BoolArray
    tracked: bool
    started: bool
    inner: object
    support: Array | None = None
    lag: Array | None = None
    changes: Array | None = None
    later: bool = False
    plate_noise: WhiteNoise | None = None
    lost: bool = False
    uncorrected: bool = False
    placed: bool = True


class Prediction(NamedTuple):
    """What a filter predicts of the next frame, before it is known which point is which marker.

    Attributes:
        q: (nq,) predicted configuration.
        markers: Its markers, in the filter's order.
        prior: The filter's predicted state, which the step with it goes on from and uses up; None where it predicts
            anew.
    """

    q: Array
    markers: MarkerPrediction
    prior: object


class TrackingFilter(Protocol):
    """A filter as trials and streams drive it."""

    model: Body
    clinical: ClinicalAngles
    dt_s: float
    restart_after_s: float

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """An estimate at frame t that already knows its velocity from the next frames.

        Args:
            recording: The readings.
            t: The frame.
            guess: (nq,) configuration near which the body may be; None where nothing is known of it.

        Returns:
            None where the frame's markers do not fit the body.
        """

    def predict(self, before: Posterior) -> Prediction:
        """What the frame after an estimate should show: what a labeller needs between prediction and correction."""

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """The estimate of frame t from that of the frame before.

        Args:
            before: That estimate.
            recording: The readings.
            t: The frame.
            prediction: What :meth:`predict` made of ``before``, where it was asked; good for one step.
        """

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) covariance of (q, v)."""

    def spread(self, estimate: Posterior, torques: bool = True) -> Spread:
        """Standard deviations at an estimate; without ``torques`` those of the generalised forces may be NaN."""

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) standard deviations of the feet's wrenches, NaN where the filter estimates none."""

    def support_sd(self, estimate: Posterior) -> Array:
        """(B, 6) standard deviations of the wrenches on parts besides the feet; NaN where the filter asks for none."""
        del estimate
        return np.full((len(self.model.description.bearings), 6), np.nan)

    def innovations(self, estimate: Posterior) -> Innovations | None:
        """Of an estimate's frame against what is expected of them; None at a start."""

    def smooth(
        self, run: Sequence[Posterior], recording: Recording, first: int, wanted: int
    ) -> list[Posterior]:
        """The first ``wanted`` estimates of a run of consecutive ones, in the light of all of them.

        Args:
            run: Estimates of the frames from ``first`` on, in order, without a restart among them.
            recording: The readings.
            first: Frame of the first estimate.
            wanted: How many to return.
        """

    def linear_step(self, before: Posterior, estimate: Posterior) -> LinearStep:
        """The step into a frame, linearised as the filter did.

        Args:
            before: Estimate of the frame before.
            estimate: The frame's own, not a start.
        """

    def corrected(
        self, estimate: Posterior, later: BackwardPass | None, before: Posterior | None
    ) -> Posterior:
        """An estimate in the light of later frames.

        Args:
            estimate: The filter's own.
            later: What they tell; None where there are none.
            before: Corrected estimate of the frame before, None at a start; for differences over time.
        """


NO_WRENCH = np.full((2, 6), np.nan)
"""The wrench of a filter that estimates none."""
