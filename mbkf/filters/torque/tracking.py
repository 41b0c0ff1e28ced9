"""The thesis's torque-state filter on trials: started by the kinematic one, linearly smoothed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.tracking import warm_start
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.filters.torque.filter import TorqueFilter, TorqueState, TorqueStep
from mbkf.filters.torque.plant import ForcedState
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactMemory
from mbkf.sensors.marker_prediction import MarkerPrediction
from mbkf.sensors.marker_sensor import MarkerSensor


@dataclass(frozen=True)
class _Followed:
    """Inner record: state, its step (None at a start) and what the contact decision remembers."""

    state: TorqueState
    step: TorqueStep | None
    before: ForcedState | None
    memory: ContactMemory


class TorqueTracking:
    """Drives a :class:`TorqueFilter`; see :class:`mbkf.filters.estimate.TrackingFilter`."""

    def __init__(self, kalman: TorqueFilter, feet: ContactDetector, starter: KinematicFilter) -> None:
        self.kalman, self.feet, self._starter = kalman, feet, starter
        self.model, self.dt_s = kalman.sensor.model, kalman.plant.dt_s
        self.restart_after_s = starter.settings.restart_after_s
        self._reader = SpreadReader(self.model)
        self.clinical = self._reader.clinical

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """The kinematic filter's warm start; torques by inverse dynamics under this frame's plates."""
        found = warm_start(self._starter, recording, t, guess)
        if found is None:
            return None
        motion, a = found.state, found.accelerations.mean(axis=0)
        load = self.feet.decide(self.feet.begin(), motion.q, motion.v, a, recording.plates[t])
        state = self.kalman.start(motion, a, load.wrench, *_known(load.contacts))
        nobody = np.zeros(recording.markers_m.shape[1], dtype=bool)
        return self._estimate(_Followed(state, None, None, load.memory), load.contacts, nobody, True)

    def predict(self, before: Posterior) -> Prediction:
        """By steady motion: the filter's own plant waits for the plates, which say what the torques do."""
        return steady_motion(before, self.covariance(before), self.kalman.sensor, self.dt_s)

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """One frame on; the feet's footing is decided where the motion before would carry them."""
        del prediction
        was: _Followed = before.inner
        state = was.state
        q = self.model.integrate(state.q, self.dt_s * state.v)
        load = self.feet.decide(was.memory, q, state.v + self.dt_s * state.a, state.a, recording.plates[t])
        step = self.kalman.step(state, recording.markers_m[t], load.wrench, *_known(load.contacts))
        inner = _Followed(step.state, step, state.filtered, load.memory)
        return self._estimate(inner, load.contacts, step.refused, step.tracked)

    def _estimate(
        self, inner: _Followed, footing: tuple[Contact, Contact], refused: BoolArray, tracked: bool
    ) -> Posterior:
        state = inner.state
        feet = (int(footing[0]), int(footing[1]))
        return Posterior(
            state.q, state.v, state.a, state.foot_wrench, feet, refused, tracked, inner.step is None, inner
        )

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) of (q, v)."""
        nv = self.model.nv
        return estimate.inner.state.filtered.P[: 2 * nv, : 2 * nv]

    def spread(self, estimate: Posterior) -> Spread:
        """Standard deviations; torques are states of this filter."""
        state: TorqueState = estimate.inner.state
        P, nv = self.covariance(estimate), self.model.nv
        return Spread(
            self._reader, state.q, np.diagonal(P)[:nv], np.diagonal(P)[nv:], state.tau_sd, lambda: P[:nv, :nv]
        )

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) of the state's wrenches, carried to the world's origin."""
        return estimate.inner.state.foot_wrench_sd

    def innovation(self, estimate: Posterior) -> tuple[float, int]:
        """Of markers and plates."""
        step: TorqueStep | None = estimate.inner.step
        return (np.nan, 0) if step is None else (step.nis, step.readings)

    def smooth(
        self, run: Sequence[Posterior], recording: Recording, first: int, wanted: int
    ) -> list[Posterior]:
        """Linear smoother about the filter's own course."""
        del recording, first
        found: list[Posterior] = []
        back = BackwardPass(len(run[0].inner.state.filtered.P))
        for k in range(len(run) - 1, -1, -1):
            inner: _Followed = run[k].inner
            here = inner.state.filtered
            if k < wanted:
                found.append(self._smoothed(run[k], back.step(here.P), back.covariance(here.P)))
            if k and inner.step is not None and inner.step.evidence is not None:
                known = inner.step.evidence
                back.through_readings(here.P, known.matrix, known.vector)
                back.through_plant(inner.step.prediction.phi)
        return found[::-1]

    def _smoothed(self, estimate: Posterior, step: Array, P: Array) -> Posterior:
        here: ForcedState = estimate.inner.state.filtered
        nv = self.model.nv
        q = self.model.integrate(here.q, step[:nv])
        moved = ForcedState(q, here.v + step[nv : 2 * nv], here.u + step[2 * nv :], P)
        state = self.kalman.report(moved)
        inner = replace(estimate.inner, state=state)
        return estimate._replace(q=state.q, v=state.v, a=state.a, wrench=state.foot_wrench, inner=inner)


def _known(footing: tuple[Contact, Contact]) -> tuple[BoolArray, BoolArray]:
    """Feet (2,) whose wrench is known, and those in the air. A shared plate is no reading of either foot."""
    airborne = np.array([foot == Contact.AIR for foot in footing])
    return np.array([foot == Contact.MEASURED for foot in footing]) | airborne, airborne


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
