"""The dynamic filter on trials: started by the kinematic one, smoothed until Newton's law holds again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic import NOWHERE, DynamicFilter
from mbkf.filters.dynamic_records import DynamicStep
from mbkf.filters.dynamic_smoothing import Frame, smooth
from mbkf.filters.estimate import Estimate, Foresight, Recording
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.kinematic_follower import warm_start
from mbkf.filters.singer import DynamicState
from mbkf.filters.spread import Spread, SpreadReader, root
from mbkf.filters.stated import StatedErrors

ROUNDS = 2
"""How often a smoothed stretch is linearised; a third round changes the residual by less than 0.1 N."""


class DynamicFollower:
    """Drives a :class:`DynamicFilter`; see :class:`mbkf.filters.estimate.Follower`."""

    def __init__(self, kalman: DynamicFilter, starter: KinematicFilter) -> None:
        self.kalman, self._starter = kalman, starter
        self.model, self.dt_s = kalman.model, kalman.dt_s
        self.restart_after_s = starter.settings.restart_after_s
        self._reader = SpreadReader(self.model)
        self._held = np.flatnonzero(kalman.held)
        self._anywhere = self.model.posture_sd[self._held] ** 2

    def start(self, recording: Recording, t: int, guess: Array | None) -> Estimate | None:
        """The kinematic filter's warm start, corrected by this frame's plates and Newton's law."""
        found = warm_start(self._starter, recording, t, guess)
        if found is None:
            return None
        state, a = found.state, found.accelerations.mean(axis=0)
        first = self.kalman.first(state.q, state.v, a, state.P, recording.markers_m[t], recording.plates[t])
        return replace(_estimate(first), tracked=True, started=True)

    def expect(self, before: Estimate) -> Foresight:
        """By the filter's own plant."""
        was: DynamicStep = before.inner
        return self.kalman.expect(was.state, was.memory)

    def step(
        self, before: Estimate, recording: Recording, t: int, foresight: Foresight | None = None
    ) -> Estimate:
        """One frame on."""
        was: DynamicStep = before.inner
        imus = None if recording.imus is None else recording.imus[t]
        markers, plates = recording.markers_m[t], recording.plates[t]
        return _estimate(self.kalman.step(was.state, was.memory, markers, plates, imus, foresight))

    def covariance(self, estimate: Estimate) -> Array:
        """(2 nv, 2 nv) of (q, v); dofs that are held may be anywhere a posture is."""
        nv = self.model.nv
        return self._configuration(self.errors(estimate).covariance()[: 2 * nv, : 2 * nv])

    def spread(self, estimate: Estimate) -> Spread:
        """Standard deviations; torques' from the whole state through Newton–Euler."""
        state: DynamicState = estimate.inner.state
        torque = self.kalman.balance.torques(state.q, state.v, state.a, state.w)
        errors = self.errors(estimate)
        variance = errors.position_variance
        variance[self._held] += self._anywhere
        return Spread(
            self._reader,
            state.q,
            variance,
            errors.velocity_variance,
            root(errors.variance_of(torque.by_state)),
            lambda: self._configuration(errors.position),
        )

    def _configuration(self, P: Array) -> Array:
        """A covariance (nv, nv) or more with what held dofs may be, in place."""
        P[self._held, self._held] += self._anywhere
        return P

    def errors(self, estimate: Estimate) -> StatedErrors:
        """Those of the whole state; what the filter itself says where only white noise is expected."""
        step: DynamicStep = estimate.inner
        s, P, decision = self.kalman.settings, estimate.inner.state.P, step.decision
        if s.innovation_share <= 0.0:
            return StatedErrors(P, step.frame.matrix, NOWHERE, 0.0, 1.0, 0.0)
        known = ~self.kalman.held
        known[decision.unseen if decision.unmarked is None else decision.unmarked] = False
        seen = np.flatnonzero(known)
        # A pose takes up part of what its markers err by, so innovations show less than that.
        readings = 3 * int(np.count_nonzero(decision.trusted))
        over = max(readings - len(seen), readings // 4)
        skin = s.innovation_share * readings / max(over, 1)
        return StatedErrors(P, step.frame.matrix, seen, skin, s.new_share, s.skin_rate_rad_s)

    def wrench_sd(self, estimate: Estimate) -> Array:
        """(2, 6) from the state's covariance."""
        return np.sqrt(np.diag(estimate.inner.state.P)[3 * self.model.nv :]).reshape(2, 6)

    def innovation(self, estimate: Estimate) -> tuple[float, int]:
        """Of markers, plates and Newton's law."""
        if estimate.started:
            return np.nan, 0
        step: DynamicStep = estimate.inner
        return step.nis, step.readings

    def smooth(
        self, run: Sequence[Estimate], recording: Recording, first: int, wanted: int
    ) -> list[Estimate]:
        """Iterated smoother; see :mod:`mbkf.filters.dynamic_smoothing`."""
        frames = [
            Frame(e.inner.state, e.inner.decision, recording.markers_m[first + k]) for k, e in enumerate(run)
        ]
        states = smooth(self.kalman, run[0].inner.state, frames, ROUNDS, wanted)
        return [
            replace(e, q=s.q, v=s.v, a=s.a, wrench=s.w.reshape(2, 6), inner=replace(e.inner, state=s))
            for e, s in zip(run, states, strict=False)
        ]


def _estimate(step: DynamicStep) -> Estimate:
    state, (right, left) = step.state, step.decision.load.contacts
    return Estimate(
        state.q,
        state.v,
        state.a,
        state.w.reshape(2, 6),
        (int(right), int(left)),
        step.refused,
        step.tracked,
        False,
        step,
    )
