"""The kinematic filter on trials: warm start, accelerations by differences (eq. 3.7), linear smoothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import NO_WRENCH, Estimate, Foresight, Recording
from mbkf.filters.kinematic import KinematicFilter, StepResult
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.filters.state import FilterState
from mbkf.numerics.smoothing import BackwardPass

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

    state: FilterState
    accelerations: Array


@dataclass(frozen=True)
class _Followed:
    """Inner record: the state, its step (None at a start), the start's accelerations and the frames since."""

    state: FilterState
    result: StepResult | None
    settling: Array
    since: int


def warm_start(
    kalman: KinematicFilter, recording: Recording, t: int, guess: Array | None
) -> WarmStart | None:
    """A state at frame t that already knows its velocity: the next frames are run through backwards first."""
    markers, dt = recording.markers_m, recording.dt_s
    last = min(t + warm_up_frames(dt), len(markers) - 1)
    here = kalman.start(markers[t], guess)
    state = None if here is None else kalman.start(markers[last], here.q)
    if here is None:
        return None
    if state is None or last == t:
        return WarmStart(here, np.zeros((1, len(here.v))))
    backwards = [state.v]
    for frame in markers[t:last][::-1]:
        state = kalman.step(state, frame).state
        backwards.append(state.v)
    accelerations = -np.diff(np.array(backwards)[::-1], axis=0) / dt
    return WarmStart(state.reversed_in_time(), accelerations[: max(1, round(SETTLING_S / dt))])


class KinematicFollower:
    """Drives a :class:`KinematicFilter`; see :class:`mbkf.filters.estimate.Follower`."""

    def __init__(self, kalman: KinematicFilter) -> None:
        self.kalman = kalman
        self.model = kalman.sensor.model
        self.dt_s = kalman.plant.dt_s
        self.restart_after_s = kalman.settings.restart_after_s
        self._reader = SpreadReader(self.model)

    def start(self, recording: Recording, t: int, guess: Array | None) -> Estimate | None:
        """A warm start."""
        found = warm_start(self.kalman, recording, t, guess)
        if found is None:
            return None
        inner = _Followed(found.state, None, found.accelerations, 0)
        nobody = np.zeros(recording.markers_m.shape[1], dtype=bool)
        q, v = found.state.q, found.state.v
        return Estimate(q, v, found.accelerations[0], NO_WRENCH, None, nobody, True, True, inner)

    def expect(self, before: Estimate) -> Foresight:
        """By the filter's own plant."""
        return self.kalman.expect(before.inner.state)

    def step(
        self, before: Estimate, recording: Recording, t: int, foresight: Foresight | None = None
    ) -> Estimate:
        """One frame on."""
        was: _Followed = before.inner
        result = self.kalman.step(was.state, recording.markers_m[t], foresight)
        since = was.since + 1
        settled = since >= len(was.settling)
        a = (result.state.v - was.state.v) / self.dt_s if settled else was.settling[since]
        inner = _Followed(result.state, result, was.settling, since)
        return Estimate(
            result.state.q, result.state.v, a, NO_WRENCH, None, result.refused, result.tracked, False, inner
        )

    def covariance(self, estimate: Estimate) -> Array:
        """(2 nv, 2 nv) of (q, v)."""
        return estimate.inner.state.P

    def spread(self, estimate: Estimate) -> Spread:
        """Standard deviations; torques as far as accelerations cause them, NaN at a start."""
        inner: _Followed = estimate.inner
        q, P, nv = inner.state.q, inner.state.P, self.model.nv
        torque = np.full(nv, np.nan)
        if inner.result is not None:
            torque = self._reader.torque(q, inner.result.velocity_step_covariance, self.dt_s)
        return Spread(self._reader, q, np.diagonal(P)[:nv], np.diagonal(P)[nv:], torque, lambda: P[:nv, :nv])

    def wrench_sd(self, estimate: Estimate) -> Array:
        """This filter estimates no wrench."""
        del estimate
        return NO_WRENCH

    def innovation(self, estimate: Estimate) -> tuple[float, int]:
        """Of the markers."""
        result: StepResult | None = estimate.inner.result
        return (np.nan, 0) if result is None else (result.nis, result.readings)

    def smooth(
        self, run: Sequence[Estimate], recording: Recording, first: int, wanted: int
    ) -> list[Estimate]:
        """Linear smoother about the filter's own course; accelerations are central differences.

        Torques keep the filter's standard deviations, which are larger than the smoothed ones.
        """
        del recording, first
        states: list[FilterState] = []
        back = BackwardPass(2 * self.model.nv)
        for k in range(len(run) - 1, -1, -1):
            inner: _Followed = run[k].inner
            state = inner.state
            states.append(self._moved(state, back.step(state.P), back.covariance(state.P)))
            if k and inner.result is not None:
                known = inner.result.evidence
                matrix = np.zeros_like(state.P)
                nv = self.model.nv
                matrix[:nv, :nv] = known.position_matrix
                every = np.arange(nv, 2 * nv)
                matrix[every, every] = known.velocity_matrix
                back.through_readings(state.P, matrix, known.vector)
                back.through_plant(known.plant.transition(known.before))
        states.reverse()
        v = np.array([state.v for state in states])
        a = np.gradient(v, self.dt_s, axis=0) if len(v) > 1 else np.zeros_like(v)
        return [
            replace(e, q=s.q, v=s.v, a=acc, inner=replace(e.inner, state=s))
            for e, s, acc in list(zip(run, states, a, strict=True))[:wanted]
        ]

    def _moved(self, state: FilterState, step: Array, P: Array) -> FilterState:
        nv = self.model.nv
        return FilterState(self.model.integrate(state.q, step[:nv]), state.v + step[nv:], P)
