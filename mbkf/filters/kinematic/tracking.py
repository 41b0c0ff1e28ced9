"""The kinematic filter on trials: warm start, accelerations by differences (thesis eq. 3.7), linear smoother."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, cast

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import NO_WRENCH, Posterior, Prediction, Recording, TrackingFilter
from mbkf.filters.filter import Memory, Prior, Step
from mbkf.filters.innovations import Innovations
from mbkf.filters.kinematic.filter import KinematicFilter, VelocityStep
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.kernel.smoothing import SparseBackwardPass
from mbkf.numerics.passage import LinearStep
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.block import Frame
from mbkf.sensors.marker_prediction import MarkerPrediction
from mbkf.sensors.markers import Markers

KinematicStep = Step[KinematicState]
"""A step of the kinematic filter."""

WARM_UP_S = 0.25
"""Stretch of a trial that is first run through backwards to start with a velocity."""

SETTLING_S = 0.05
"""While a started filter settles, accelerations are those of the backward run."""


def warm_up_frames(dt_s: float) -> int:
    """How many frames after its own a warm start looks at."""
    return round(WARM_UP_S / dt_s)


@dataclass(frozen=True)
class WarmStart:
    """A first state, and the accelerations (n, nv) of the n frames from it on while the filter settles."""

    state: KinematicState
    accelerations: Array


class KinematicRecord(NamedTuple):
    """The filter's own record of a frame.

    Attributes:
        state: Its state.
        step: The step to it, None at a start.
        before: State of the frame before, None at a start.
        settling: (n, nv) accelerations of the first frames after a start.
        since: Frames since the start.
    """

    state: KinematicState
    step: KinematicStep | None
    before: KinematicState | None
    settling: Array
    since: int


def warm_start(
    kalman: KinematicFilter, recording: Recording, t: int, guess: Array | None
) -> WarmStart | None:
    """A state at frame t that already knows its velocity: the next frames are run through backwards first.

    Args:
        kalman: The filter.
        recording: The readings.
        t: The frame.
        guess: (nq,) configuration to start the pose fit from besides the segment-by-segment one.

    Returns:
        None where the frame's markers do not fit the body.
    """
    markers, dt = recording.markers_m, recording.dt_s
    last = min(t + warm_up_frames(dt), len(markers) - 1)
    here = kalman.start(markers[t], guess)
    state = None if here is None else kalman.start(markers[last], here.q)
    if here is None:
        return None
    if state is None or last == t:
        return WarmStart(here, np.zeros((1, len(here.v))))
    backwards, memory, no_plates = [state.v], kalman.begin(), np.zeros((0, 6))
    for seen in markers[t:last][::-1]:
        state = kalman.step(state, memory, Frame(seen, no_plates)).state
        backwards.append(state.v)
    accelerations = -np.diff(np.array(backwards)[::-1], axis=0) / dt
    return WarmStart(state.reversed_in_time(), accelerations[: max(1, round(SETTLING_S / dt))])


def _record(estimate: Posterior) -> KinematicRecord:
    """The kinematic filter's own record of a frame."""
    return cast(KinematicRecord, estimate.inner)


class KinematicTracking(TrackingFilter):
    """Drives a :class:`KinematicFilter`; see :class:`mbkf.filters.estimate.TrackingFilter`."""

    def __init__(self, kalman: KinematicFilter, smoothed_covariances: bool = True) -> None:
        """Makes the driver.

        Args:
            kalman: The filter.
            smoothed_covariances: Whether smoothed estimates get covariances of their own, which cost far more than
                means; without, they keep the filter's, which are never smaller.
        """
        self.kalman, self._covariances = kalman, smoothed_covariances
        self.model = kalman.model
        self.dt_s = kalman.plant.dt_s
        self.restart_after_s = kalman.settings.restart_after_s
        self._reader = SpreadReader(self.model)
        self.clinical = self._reader.clinical

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """A warm start."""
        found = warm_start(self.kalman, recording, t, guess)
        if found is None:
            return None
        inner = KinematicRecord(found.state, None, None, found.accelerations, 0)
        none = np.zeros(recording.markers_m.shape[1], dtype=bool)
        q, v = found.state.q, found.state.v
        return Posterior(q, v, found.accelerations[0], NO_WRENCH, None, none, True, True, inner)

    def predict(self, before: Posterior) -> Prediction:
        """By the filter's own plant."""
        was = _record(before)
        prior, nv = self.kalman.predict(was.state, self._memory(was)), self.model.nv
        markers = MarkerPrediction(self.kalman.prepared_by(Markers, prior), prior.state.P[:nv, :nv])
        return Prediction(prior.state.q, markers, prior)

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """One frame on."""
        was = _record(before)
        prior = None if prediction is None else cast("Prior[KinematicState] | None", prediction.prior)
        step = self.kalman.step(was.state, self._memory(was), recording.frame(t), prior)
        state, since = step.state, was.since + 1
        settled = since >= len(was.settling)
        a = (state.v - was.state.v) / self.dt_s if settled else was.settling[since]
        inner = KinematicRecord(state, step, was.state, was.settling, since)
        seen = step.refused, step.tracked, False
        return Posterior(state.q, state.v, a, NO_WRENCH, None, *seen, inner, lost=step.lost)

    def _memory(self, was: KinematicRecord) -> Memory:
        return self.kalman.begin() if was.step is None else was.step.memory

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) of (q, v)."""
        return _record(estimate).state.P

    def spread(self, estimate: Posterior, torques: bool = True) -> Spread:
        """Standard deviations; torques as far as accelerations cause them, NaN at a start."""
        inner = _record(estimate)
        q, P, nv = inner.state.q, inner.state.P, self.model.nv
        torque = np.full(nv, np.nan)
        if torques and inner.step is not None and inner.before is not None:
            change = VelocityStep(inner.before, inner.step, self.kalman.plant).covariance
            torque = self._reader.torque_variance(q, change, self.dt_s)
        variance = np.diagonal(P)
        parts = partial(self._reader.parts, q, P[:nv, :nv])
        return Spread(self._reader, q, variance[:nv], variance[nv:], torque, parts)

    def wrench_sd(self, estimate: Posterior) -> Array:
        """This filter estimates no wrench."""
        del estimate
        return NO_WRENCH

    def innovations(self, estimate: Posterior) -> Innovations | None:
        """Of the markers."""
        step = _record(estimate).step
        return None if step is None else step.innovations

    def smooth(
        self, run: Sequence[Posterior], recording: Recording, first: int, wanted: int
    ) -> list[Posterior]:
        """Linear smoother about the filter's own course; accelerations are central differences.

        Torques keep the filter's standard deviations, which are larger than the smoothed ones.
        """
        del recording, first
        states: list[KinematicState] = []
        back = SparseBackwardPass(2 * self.model.nv, self._covariances)
        for k in range(len(run) - 1, -1, -1):
            inner = _record(run[k])
            state = inner.state
            states.append(self.kalman.plant.retract(state, *back.corrected(state.P)))
            if k and inner.step is not None and inner.before is not None:
                known = inner.step.readings
                back.through_parts(state.P, known.matrix, known.rows, known.whole_vector)
                back.through_motion(self.kalman.plant.transition_parts(inner.before))
        states.reverse()
        v = np.array([state.v for state in states])
        a = np.gradient(v, self.dt_s, axis=0) if len(v) > 1 else np.zeros_like(v)
        return [
            e._replace(q=s.q, v=s.v, a=acc, inner=_record(e)._replace(state=s))
            for e, s, acc in list(zip(run, states, a, strict=True))[:wanted]
        ]

    def linear_step(self, before: Posterior, estimate: Posterior) -> LinearStep:
        """About the filter's own course.

        Raises:
            ValueError: The estimate is a start.
        """
        step = _record(estimate).step
        if step is None:
            raise ValueError("no step leads to a start")
        transition = self.kalman.plant.transition(_record(before).state)
        known = step.readings
        return LinearStep(step.state.P, known.whole_matrix, known.whole_vector, transition)

    def corrected(
        self, estimate: Posterior, later: BackwardPass | None, before: Posterior | None
    ) -> Posterior:
        """By one linear pass; accelerations are differences of corrected velocities, as the filter's own are.

        Torques keep the filter's standard deviations, as when smoothed.
        """
        inner = _record(estimate)
        state = inner.state
        if later is not None:
            state = self.kalman.plant.retract(state, *later.corrected(state.P))
        a = estimate.a
        if before is not None and inner.since >= len(inner.settling):
            a = (state.v - before.v) / self.dt_s
        return estimate._replace(q=state.q, v=state.v, a=a, inner=inner._replace(state=state))
