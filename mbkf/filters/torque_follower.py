"""The thesis's torque-state filter on trials: started by the kinematic one, linearly smoothed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Estimate, Foresight, Recording
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.kinematic_follower import warm_start
from mbkf.filters.prediction import steady_motion
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.filters.torque import TorqueFilter, TorqueState, TorqueStep
from mbkf.filters.torque_plant import ForcedState
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactMemory


@dataclass(frozen=True)
class _Followed:
    """Inner record: state, its step (None at a start) and what the contact decision remembers."""

    state: TorqueState
    step: TorqueStep | None
    before: ForcedState | None
    memory: ContactMemory


class TorqueFollower:
    """Drives a :class:`TorqueFilter`; see :class:`mbkf.filters.estimate.Follower`."""

    def __init__(self, kalman: TorqueFilter, feet: ContactDetector, starter: KinematicFilter) -> None:
        self.kalman, self.feet, self._starter = kalman, feet, starter
        self.model, self.dt_s = kalman.sensor.model, kalman.plant.dt_s
        self.restart_after_s = starter.settings.restart_after_s
        self._reader = SpreadReader(self.model)

    def start(self, recording: Recording, t: int, guess: Array | None) -> Estimate | None:
        """The kinematic filter's warm start; torques by inverse dynamics under this frame's plates."""
        found = warm_start(self._starter, recording, t, guess)
        if found is None:
            return None
        motion, a = found.state, found.accelerations.mean(axis=0)
        load = self.feet.decide(self.feet.begin(), motion.q, motion.v, a, recording.plates[t])
        state = self.kalman.start(motion, a, load.wrench, *_known(load.contacts))
        nobody = np.zeros(recording.markers_m.shape[1], dtype=bool)
        return self._estimate(_Followed(state, None, None, load.memory), load.contacts, nobody, True)

    def expect(self, before: Estimate) -> Foresight:
        """By steady motion: the filter's own plant waits for the plates, which say what the torques do."""
        return steady_motion(before, self.covariance(before), self.kalman.sensor, self.dt_s)

    def step(
        self, before: Estimate, recording: Recording, t: int, foresight: Foresight | None = None
    ) -> Estimate:
        """One frame on; the feet's footing is decided where the motion before would carry them."""
        del foresight
        was: _Followed = before.inner
        state = was.state
        q = self.model.integrate(state.q, self.dt_s * state.v)
        load = self.feet.decide(was.memory, q, state.v + self.dt_s * state.a, state.a, recording.plates[t])
        step = self.kalman.step(state, recording.markers_m[t], load.wrench, *_known(load.contacts))
        inner = _Followed(step.state, step, state.filtered, load.memory)
        return self._estimate(inner, load.contacts, step.refused, step.tracked)

    def _estimate(
        self, inner: _Followed, footing: tuple[Contact, Contact], refused: BoolArray, tracked: bool
    ) -> Estimate:
        state = inner.state
        feet = (int(footing[0]), int(footing[1]))
        return Estimate(
            state.q, state.v, state.a, state.foot_wrench, feet, refused, tracked, inner.step is None, inner
        )

    def covariance(self, estimate: Estimate) -> Array:
        """(2 nv, 2 nv) of (q, v)."""
        nv = self.model.nv
        return estimate.inner.state.filtered.P[: 2 * nv, : 2 * nv]

    def spread(self, estimate: Estimate) -> Spread:
        """Standard deviations; torques are states of this filter."""
        state: TorqueState = estimate.inner.state
        P, nv = self.covariance(estimate), self.model.nv
        return Spread(
            self._reader, state.q, np.diagonal(P)[:nv], np.diagonal(P)[nv:], state.tau_sd, lambda: P[:nv, :nv]
        )

    def wrench_sd(self, estimate: Estimate) -> Array:
        """(2, 6) of the state's wrenches, carried to the world's origin."""
        return estimate.inner.state.foot_wrench_sd

    def innovation(self, estimate: Estimate) -> tuple[float, int]:
        """Of markers and plates."""
        step: TorqueStep | None = estimate.inner.step
        return (np.nan, 0) if step is None else (step.nis, step.readings)

    def smooth(
        self, run: Sequence[Estimate], recording: Recording, first: int, wanted: int
    ) -> list[Estimate]:
        """Linear smoother about the filter's own course."""
        del recording, first
        found: list[Estimate] = []
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

    def _smoothed(self, estimate: Estimate, step: Array, P: Array) -> Estimate:
        here: ForcedState = estimate.inner.state.filtered
        nv = self.model.nv
        q = self.model.integrate(here.q, step[:nv])
        moved = ForcedState(q, here.v + step[nv : 2 * nv], here.u + step[2 * nv :], P)
        state = self.kalman.report(moved)
        inner = replace(estimate.inner, state=state)
        return replace(estimate, q=state.q, v=state.v, a=state.a, wrench=state.foot_wrench, inner=inner)


def _known(footing: tuple[Contact, Contact]) -> tuple[BoolArray, BoolArray]:
    """Feet (2,) whose wrench is known, and those in the air. A shared plate is no reading of either foot."""
    airborne = np.array([foot == Contact.AIR for foot in footing])
    return np.array([foot == Contact.MEASURED for foot in footing]) | airborne, airborne
