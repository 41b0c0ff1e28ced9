"""The thesis's torque-state filter on trials: started by the kinematic one, linearly smoothed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import cast

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Prediction, Recording, TrackingFilter
from mbkf.filters.filter import Memory
from mbkf.filters.innovations import Innovations
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.tracking import warm_start
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.filters.torque.filter import TorqueFilter, TorqueStep
from mbkf.filters.torque.plant import ForcedPrediction
from mbkf.filters.torque.report import TorqueState
from mbkf.numerics.passage import LinearStep
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.records import ContactDecision
from mbkf.sensors.marker_prediction import MarkerPrediction
from mbkf.sensors.marker_sensor import MarkerSensor


@dataclass(frozen=True)
class TorqueRecord:
    """The filter's own record of a frame.

    Attributes:
        state: Its state, with what follows from it.
        memory: For the next step.
        step: The step to it; None at a start, and where nothing could be computed.
    """

    state: TorqueState
    memory: Memory
    step: TorqueStep | None


def _record(estimate: Posterior) -> TorqueRecord:
    """The torque filter's own record of a frame."""
    return cast(TorqueRecord, estimate.inner)


class TorqueTracking(TrackingFilter):
    """Drives a :class:`TorqueFilter`; see :class:`mbkf.filters.estimate.TrackingFilter`."""

    def __init__(self, kalman: TorqueFilter, starter: KinematicFilter) -> None:
        self.kalman, self._starter = kalman, starter
        self.model, self.dt_s = kalman.sensor.model, kalman.plant.dt_s
        self.restart_after_s = starter.settings.restart_after_s
        self._reader = SpreadReader(self.model)
        self.clinical = self._reader.clinical

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """The kinematic filter's warm start; torques by inverse dynamics under this frame's plates."""
        found = warm_start(self._starter, recording, t, guess)
        if found is None:
            return None
        first = self.kalman.first(found.state, found.accelerations.mean(axis=0), recording.frame(t))
        record = TorqueRecord(self.kalman.report(first.state), first.memory, None)
        return self._untouched(record, first.contact, recording)._replace(tracked=True, started=True)

    def predict(self, before: Posterior) -> Prediction:
        """By steady motion: the filter's own plant waits for the plates, which say what the torques do."""
        return steady_motion(before, self.covariance(before), self.kalman.sensor, self.dt_s)

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """One frame on. A filter that has diverged until nothing can be computed keeps its state and is untracked."""
        del prediction
        was = _record(before)
        frame = recording.frame(t)
        try:
            record = self._advanced(was, frame)
        except (np.linalg.LinAlgError, ValueError):
            record = None
        if record is not None and record.step is not None and record.state.finite:
            return _posterior(record, record.step)
        stayed = self.kalman.stayed(was.state.filtered, was.memory, frame)
        return self._untouched(TorqueRecord(was.state, stayed.memory, None), stayed.contact, recording)

    def _advanced(self, was: TorqueRecord, frame: Frame) -> TorqueRecord:
        step = self.kalman.step(was.state.filtered, was.memory, frame)
        state = self.kalman.report(step.state)
        return TorqueRecord(state, step.memory, step)

    def _untouched(self, record: TorqueRecord, contact: ContactDecision, recording: Recording) -> Posterior:
        """A posterior that no step led to."""
        state, refused = record.state, np.zeros(recording.markers_m.shape[1], dtype=bool)
        feet = _numbers(contact)
        return Posterior(state.q, state.v, state.a, state.foot_wrench, feet, refused, False, False, record)

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) of (q, v)."""
        nv = self.model.nv
        return _record(estimate).state.filtered.P[: 2 * nv, : 2 * nv]

    def spread(self, estimate: Posterior, torques: bool = True) -> Spread:
        """Standard deviations; torques are states of this filter."""
        del torques
        state = _record(estimate).state
        P, nv = self.covariance(estimate), self.model.nv
        return Spread(
            self._reader,
            state.q,
            np.diagonal(P)[:nv],
            np.diagonal(P)[nv:],
            state.tau_sd**2,
            partial(self._reader.parts, state.q, P[:nv, :nv]),
        )

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) of the state's wrenches, carried to the world's origin."""
        return _record(estimate).state.foot_wrench_sd

    def innovations(self, estimate: Posterior) -> Innovations | None:
        """Of markers and plates."""
        step = _record(estimate).step
        return None if step is None else step.innovations

    def smooth(
        self, run: Sequence[Posterior], recording: Recording, first: int, wanted: int
    ) -> list[Posterior]:
        """Linear smoother about the filter's own course."""
        del recording, first
        found: list[Posterior] = []
        back = BackwardPass(len(_record(run[0]).state.filtered.P))
        for k in range(len(run) - 1, -1, -1):
            inner = _record(run[k])
            here = inner.state.filtered
            if k < wanted:
                found.append(self._smoothed(run[k], back.step(here.P), back.covariance(here.P)))
            if k and inner.step is not None:
                known, predicted = inner.step.readings, inner.step.prior.state
                back.through_readings(here.P, known.whole_matrix, known.whole_vector)
                back.through_plant(cast(ForcedPrediction, predicted).phi)
        return found[::-1]

    def linear_step(self, before: Posterior, estimate: Posterior) -> LinearStep:
        """About the filter's own course; a frame in which nothing could be computed changes nothing."""
        del before
        inner = _record(estimate)
        P = inner.state.filtered.P
        if inner.step is None:
            n = len(P)
            return LinearStep(P, np.zeros((n, n)), np.zeros(n), np.eye(n))
        known, predicted = inner.step.readings, inner.step.prior.state
        phi = cast(ForcedPrediction, predicted).phi
        return LinearStep(P, known.whole_matrix, known.whole_vector, phi)

    def corrected(
        self, estimate: Posterior, later: BackwardPass | None, before: Posterior | None
    ) -> Posterior:
        """By one linear pass."""
        del before
        if later is None:
            return estimate
        P = _record(estimate).state.filtered.P
        return self._smoothed(estimate, *later.corrected(P))

    def _smoothed(self, estimate: Posterior, step: Array, P: Array) -> Posterior:
        state = self.kalman.report(self.kalman.plant.retract(_record(estimate).state.filtered, step, P))
        inner = replace(_record(estimate), state=state)
        return estimate._replace(q=state.q, v=state.v, a=state.a, wrench=state.foot_wrench, inner=inner)


def _posterior(record: TorqueRecord, step: TorqueStep) -> Posterior:
    """The posterior that a step led to."""
    state, contact = record.state, step.decisions.notes.contact
    feet = None if contact is None else _numbers(contact)
    wrench = state.foot_wrench
    return Posterior(state.q, state.v, state.a, wrench, feet, step.refused, step.tracked, False, record)


def _numbers(contact: ContactDecision) -> tuple[int, int]:
    right, left = contact.contacts
    return int(right), int(left)


def steady_motion(estimate: Posterior, covariance: Array, sensor: MarkerSensor, dt_s: float) -> Prediction:
    """The frame after an estimate by steady velocity (thesis eqs. 3.1–3.3).

    P⁻ = P_qq + Δt (P_qv + P_vq) + Δt² P_vv + Δt⁴/4 σ_a², with the body's own table of accelerations.

    Args:
        estimate: A posterior.
        covariance: (2 nv, 2 nv) its covariance P of (q, v).
        sensor: The markers on the body.
        dt_s: Time step Δt.
    """
    model, P = sensor.model, covariance
    nv = model.nv
    cross = dt_s * P[:nv, nv:]
    predicted: Array = P[:nv, :nv] + cross + cross.T + dt_s**2 * P[nv:, nv:]
    predicted[np.arange(nv), np.arange(nv)] += 0.25 * dt_s**4 * model.acceleration_sd**2
    q = model.integrate(estimate.q, dt_s * estimate.v)
    return Prediction(q, MarkerPrediction(sensor.reading(q), predicted), None)
