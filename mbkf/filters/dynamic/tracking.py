"""The dynamic filter on trials: started by the kinematic one, smoothed until Newton's law holds again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.dynamic.smoother import smooth
from mbkf.filters.dynamic.support_loads import SupportLoads
from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.filters.estimate import Posterior, Prediction, Recording, TrackingFilter
from mbkf.filters.filter import Prior, Step
from mbkf.filters.innovations import Innovations
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.tracking import warm_start
from mbkf.filters.spread import ConfigurationParts, Spread, SpreadReader, root
from mbkf.filters.state_variances import StateVariances, state_variances
from mbkf.numerics.passage import LinearStep
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.block import NO_DOFS
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.marker_prediction import MarkerPrediction
from mbkf.sensors.markers import Markers
from mbkf.sensors.white_noise import WhiteNoise

DynamicStep = Step[DynamicState]
"""A step of the dynamic filter."""

LATER_FADES_S = 0.1
"""Time in which a later frame's influence fades; without later frames an estimate is as late as a causal one."""

LEAST_PLATE_NOISE_N = 0.1
"""Noise of a plate's forces that is taken for granted: readings are stored in steps of such a size."""

ROUNDS = 2
"""How often a smoothed window is linearised; a third round changes the residual by less than 0.1 N."""


def _record(estimate: Posterior) -> DynamicStep:
    """The dynamic filter's own record of a frame."""
    return cast(DynamicStep, estimate.inner)


class DynamicTracking(TrackingFilter):
    """Drives a :class:`DynamicFilter`; see :class:`mbkf.filters.estimate.TrackingFilter`."""

    def __init__(self, kalman: DynamicFilter, starter: KinematicFilter) -> None:
        self.kalman, self._starter = kalman, starter
        self._plate_noise = WhiteNoise(kalman.settings.contact.plate_force_n, LEAST_PLATE_NOISE_N)
        self.model, self.dt_s = kalman.model, kalman.dt_s
        self.restart_after_s = starter.settings.restart_after_s
        self._reader, self.loads = SpreadReader(self.model), SupportLoads(self.model, kalman.layout)
        self.clinical = self._reader.clinical
        self._unobservable = np.flatnonzero(kalman.unobservable)
        self._anywhere = self.model.posture_sd[self._unobservable] ** 2
        self._read: tuple[Posterior, StateVariances, bool] | None = None
        self._no_torques = np.zeros((0, 3 * self.model.nv + 12))
        self._smoothing: list[Array] = []  # memory that windows share

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """The kinematic filter's warm start, corrected by this frame's plates and Newton's law."""
        found = warm_start(self._starter, recording, t, guess)
        if found is None:
            return None
        state, a = found.state, found.accelerations.mean(axis=0)
        first = self.kalman.first(state.q, state.v, a, state.P, recording.frame(t))
        return self._estimate(first)._replace(tracked=True, started=True, lag=None, lost=False)

    def predict(self, before: Posterior) -> Prediction:
        """By the filter's own plant."""
        was = _record(before)
        prior = self.kalman.predict(was.state, was.memory)
        nv = self.model.nv
        reading = self.kalman.prepared_by(Markers, prior)
        return Prediction(prior.state.q, MarkerPrediction(reading, prior.state.P[:nv, :nv]), prior)

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """One frame on."""
        was = _record(before)
        prior = None if prediction is None else cast("Prior[DynamicState] | None", prediction.prior)
        now = self.kalman.step(was.state, was.memory, recording.frame(t), prior)
        changes = np.zeros((2, 2, 6))
        np.subtract(now.state.w.reshape(2, 6), before.wrench, out=changes[0])
        if before.changes is not None:
            np.subtract(changes[0], before.changes[0], out=changes[1])
        noise = (before.plate_noise or self._plate_noise).after(recording.plates[t, :, :3])
        return self._estimate(now, changes, noise)

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) of (q, v); dofs that no marker moves with may be anywhere a posture is."""
        nv = self.model.nv
        return self._configuration(self.errors(estimate).covariance()[: 2 * nv, : 2 * nv])

    def spread(self, estimate: Posterior, torques: bool = True) -> Spread:
        """Standard deviations; torques' from the whole state through Newton–Euler."""
        found = self._variances(estimate, torques)
        parts = ConfigurationParts(found.height, found.blocks)
        q = _record(estimate).state.q
        return Spread(self._reader, q, found.position, found.velocity, found.torque, lambda: parts)

    def _variances(self, estimate: Posterior, torques: bool = True) -> StateVariances:
        """Variances of all that is read off an estimate; kept, since they are asked for one after the other.

        Args:
            estimate: The estimate.
            torques: Whether the torques' are wanted; they may be NaN otherwise.
        """
        if self._read is not None and self._read[0] is estimate and (self._read[2] or not torques):
            return self._read[1]
        state, dofs = _record(estimate).state, self._reader.coordinates.dofs
        by_state, shared = self._torques(estimate) if torques else (self._no_torques, None)
        rise = self._reader.rise_jacobian(state.q)
        found = state_variances(self.errors(estimate), by_state, rise, dofs)
        if not torques:
            found = found._replace(torque=np.full(self.model.nv, np.nan))
        if shared is not None:
            found.torque[:] += shared
        if len(self._unobservable):
            anywhere = np.zeros(self.model.nv)
            anywhere[self._unobservable] = self._anywhere
            found.position[:] += anywhere
            found.height[:] += rise**2 @ anywhere
            np.einsum("bii->bi", found.blocks)[:] += anywhere[dofs]
        self._read = estimate, found, torques
        return found

    def _torques(self, estimate: Posterior) -> tuple[Array, Array | None]:
        """(nv, n) derivative of the torques by the state, and what sharing a load adds to their variances."""
        step, balance = _record(estimate), self.kalman.balance
        state = step.state
        torque = balance.torques(state.q, state.v, state.a, state.w)
        return self.loads.torques(balance, torque, self.loads.of(step))

    def _configuration(self, P: Array) -> Array:
        """A covariance (nv, nv) or more with what unobservable dofs may be, in place."""
        P[self._unobservable, self._unobservable] += self._anywhere
        return P

    def errors(self, estimate: Posterior) -> ErrorCovariance:
        """Those of the whole state; what the filter itself states where it knows how the noise is correlated."""
        step = _record(estimate)
        s, P, notes = self.kalman.settings, step.state.P, step.decisions.notes
        # Readings may tell of velocities and of further states, too; markers whose skin has a memory do.
        information = step.readings.matrix[: self.model.nv, : self.model.nv]
        share = s.markers.innovation_share
        if share <= 0.0 or s.markers.skin_memory_s > 0.0 or self.kalman.spread_m is not None:
            return ErrorCovariance(P, information, NO_DOFS, 0.0, 1.0, 0.0)
        known = ~self.kalman.unobservable
        known[notes.unmarked] = False
        seen = np.flatnonzero(known)
        # A pose takes up part of what its markers err by, so innovations show less than that.
        readings = 3 * int(np.count_nonzero(notes.trusted))
        over = max(readings - len(seen), readings // 4)
        skin = s.errors.skin_share * notes.lasting * share * readings / max(over, 1)
        # A limb out of sight errs as P says, and so does a reaction that rests on its acceleration.
        all_seen = len(seen) + len(self._unobservable) == self.model.nv
        contacts = () if notes.contact is None or not all_seen else notes.contact.contacts
        free = tuple(foot for foot, on in enumerate(contacts) if on == Contact.UNMEASURED)
        unread = bool(free) and not {Contact.MEASURED, Contact.SHARED} & set(contacts)
        return ErrorCovariance(
            P,
            information,
            seen,
            skin,
            s.errors.new_share,
            s.errors.skin_rate_rad_s,
            free,
            s.errors.sharing_scale,
            estimate.lag if unread or notes.supports else None,
            self._edges(estimate, free),
            self.loads.slice if notes.supports and all_seen else None,
            s.errors.smoothed_new_rates if estimate.later else s.errors.new_rates,
            self._plates(estimate, contacts),
        )

    def _plates(self, estimate: Posterior, contacts: Sequence[Contact]) -> float:
        """Noise of plates over what the filter takes for it; how two feet share a plate is no reading of it."""
        if estimate.plate_noise is None or Contact.SHARED in contacts:
            return 1.0
        return min(1.0, estimate.plate_noise.sd / self.kalman.settings.contact.plate_force_n)

    def _edges(self, estimate: Posterior, free: tuple[int, ...]) -> Array:
        """(n, 12) wrenches that feet may carry or not: see :mod:`mbkf.filters.error_covariance`."""
        contact, s = _record(estimate).decisions.notes.contact, self.kalman.settings.errors
        if contact is None:
            return np.zeros((0, 12))
        edges = np.zeros((4, 2, 6))
        for foot in (0, 1):
            if foot in free:
                size = 0.0
                if s.edge_force_n > 0.0:
                    size = float(np.exp(-0.5 * (estimate.wrench[foot, 2] / (2.0 * s.edge_force_n)) ** 2))
                x, y, _ = contact.centres_m[foot]
                edges[foot, foot] = s.edge_force_n * size * np.array([0.0, 0.0, 1.0, y, -x, 0.0])
            elif contact.contacts[foot] == Contact.AIR:
                edges[foot, foot] = 0.0 if contact.below is None else contact.below
            elif estimate.changes is not None:
                edges[foot, foot] = s.frame_share[0] * estimate.changes[0, foot]
                edges[2 + foot, foot] = s.frame_share[1] * estimate.changes[1, foot]
        return edges.reshape(4, 12)

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) standard deviations of the feet's wrenches."""
        return root(self._variances(estimate, torques=False).wrench).reshape(2, 6)

    def support_sd(self, estimate: Posterior) -> Array:
        """(B, 6) from the state's covariance, and from how the parts that bear share their load."""
        loads = self.loads.of(_record(estimate))
        return self.loads.sd(loads, self.errors(estimate) if loads is not None else None)

    def innovations(self, estimate: Posterior) -> Innovations | None:
        """Of markers, plates and Newton's law."""
        return None if estimate.started else _record(estimate).innovations

    def smooth(
        self, run: Sequence[Posterior], recording: Recording, first: int, wanted: int
    ) -> list[Posterior]:
        """Iterated smoother; see :mod:`mbkf.filters.dynamic.smoother`."""
        del recording, first
        steps = [_record(estimate) for estimate in run]
        states = list(smooth(self.kalman, steps, ROUNDS, wanted, self._smoothing))
        befores = [states[0], *states[:-1]] if states else []
        last = (len(run) - 1) * self.dt_s
        return [
            self._moved(e, s, before, last - k * self.dt_s)
            for k, (e, s, before) in enumerate(zip(run, states, befores, strict=False))
        ]

    def linear_step(self, before: Posterior, estimate: Posterior) -> LinearStep:
        """About the filter's own course."""
        step = _record(estimate)
        transition = self.kalman.plant.transition(_record(before).state)
        known = step.readings
        return LinearStep(step.state.P, known.whole_matrix, known.whole_vector, transition)

    def corrected(
        self, estimate: Posterior, later: BackwardPass | None, before: Posterior | None
    ) -> Posterior:
        """By one linear pass."""
        if later is None:
            return estimate
        state = _record(estimate).state
        moved = self.kalman.plant.retract(state, *later.corrected(state.P))
        return self._moved(estimate, moved, moved if before is None else _record(before).state)

    def _moved(
        self, estimate: Posterior, state: DynamicState, before: DynamicState, ahead_s: float = np.inf
    ) -> Posterior:
        """An estimate whose state later frames have corrected.

        Args:
            estimate: The filter's own.
            state: The corrected state.
            before: That of the frame before.
            ahead_s: Time over which later frames are known; at the end of a trial there are none.
        """
        inner, s = _record(estimate)._replace(state=state), self.kalman.settings.errors
        unknown = float(np.exp(-ahead_s / LATER_FADES_S))
        steps = (s.smoothed_lag_s + unknown * (s.lag_s - s.smoothed_lag_s)) / self.dt_s
        return estimate._replace(
            q=state.q,
            v=state.v,
            a=state.a,
            wrench=state.w.reshape(2, 6),
            inner=inner,
            support=self.loads.wrench(self.loads.of(inner)),
            lag=steps
            * np.concatenate([state.a - before.a, state.w - before.w, self.loads.change(before, state)]),
            later=state.P is not _record(estimate).state.P,
        )

    def _estimate(
        self, step: DynamicStep, changes: Array | None = None, noise: WhiteNoise | None = None
    ) -> Posterior:
        state, notes = step.state, step.decisions.notes
        contact = None if notes.contact is None else notes.contact.contacts
        plant, before = self.kalman.plant, step.prior.state
        steps = self.kalman.settings.errors.lag_s / self.dt_s
        lag = np.concatenate(
            [state.a - before.a / plant.rho, state.w - before.w, self.loads.change(before, state)]
        )
        lag *= steps
        return Posterior(
            state.q,
            state.v,
            state.a,
            state.w.reshape(2, 6),
            None if contact is None else (int(contact[0]), int(contact[1])),
            step.refused,
            step.tracked,
            False,
            step,
            self.loads.wrench(self.loads.of(step)),
            lag,
            changes,
            plate_noise=noise,
            lost=step.lost,
        )
