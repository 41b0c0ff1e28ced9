"""Report of the dynamic filter: loads, torques and their errors; smoothed until Newton's law holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.dynamic.filter import DynamicFilter, DynamicStep
from mbkf.filters.dynamic.level_rows import LevelRows
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.dynamic.smoother import WindowMemory, smooth
from mbkf.filters.dynamic.support_loads import SupportLoads
from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.filters.estimate import Posterior, Record
from mbkf.filters.filter import Prior
from mbkf.filters.report import FirstMotion, StateReport
from mbkf.filters.spread import ConfigurationParts, Spread, root
from mbkf.filters.state_variances import StateVariances, state_variances
from mbkf.model.layout import FEET
from mbkf.sensors.block import NO_DOFS, Frame
from mbkf.sensors.contact.plate_noise import PlateNoise, changes_within, spread_about_origin
from mbkf.sensors.contact.records import Contact, ContactDecision, unread
from mbkf.sensors.contact.sharing import push_apart, step_apart
from mbkf.sensors.foot_contact import FootContact

LATER_FADES_S = 0.1
"""Time in which a later frame's influence fades; without later frames an estimate is as late as a causal one."""

ROUNDS = 2
"""Linearisations of a smoothed window; a third round changes the residual by less than 0.1 N."""


_NOTHING = np.zeros((0, 0))
"""In place of a covariance that is not kept."""


class Changes(NamedTuple):
    """Further record of a frame, for standard deviations.

    Attributes:
        late: (k, nv + 12 or more) lag of accelerations, the feet's wrenches and those on other parts behind a change,
            and what they may bend too much or too little; None where that is not stated.
        wrench: (2, 2, 6) change of the feet's wrenches since the frame before, and of that change, as they were known
            at once; None where they are not.
        plate_noise: Noise of the plates; None at a start.
        smoothed: Later frames have corrected the estimate and its covariance.
    """

    late: Array | None
    wrench: Array | None
    plate_noise: PlateNoise | None
    smoothed: bool = False


class DynamicReport(StateReport[DynamicState]):
    """Reads a :class:`DynamicFilter`.

    Attributes:
        loads: Reads the wrenches on parts besides the feet.
    """

    kalman: DynamicFilter

    def __init__(self, kalman: DynamicFilter) -> None:
        super().__init__(kalman)
        self.loads = SupportLoads(self.model, kalman.layout)
        feet = [block for block in kalman.blocks if isinstance(block, FootContact)]
        self._usual = kalman.settings.contact.plate_force_n, kalman.settings.contact.plate_moment_nm
        origins_m = feet[0].detector.origins_m if feet else np.zeros((0, 3))
        self._plate_noise = PlateNoise.before(origins_m, *self._usual)
        self._edge_n = kalman.settings.errors.edge_share * GRAVITY_M_S2 * self.model.mass_kg
        self._unobservable = np.flatnonzero(kalman.unobservable)
        self._anywhere = self.model.posture_sd[self._unobservable] ** 2
        self._read: tuple[Posterior, StateVariances, int] | None = None
        self._no_noise = np.zeros((2, 6))
        self._of_unmarked: tuple[NDArray[np.intp], NDArray[np.intp]] | None = None
        self._no_torques = np.zeros((0, kalman.layout.wrench.stop))
        self._smoothing = WindowMemory()

    def first(self, motion: FirstMotion, frame: Frame) -> Posterior:
        """The motion, corrected by the frame's plates and Newton's law."""
        state, a = motion.state, motion.accelerations.mean(axis=0)
        step = self.kalman.first(state.q, state.v, a, state.P, frame)
        found = self._estimate(step, Changes(None, None, None))
        return found._replace(tracked=True, started=True, lost=False)

    def posterior(self, step: DynamicStep, before: Posterior, frame: Frame) -> Posterior:
        """The estimate that a step led to."""
        was, state, last = before.record.state, step.state, _changes(before)
        wrench = np.zeros((2, 2, 6))
        np.subtract(state.w.reshape(2, 6), before.wrench, out=wrench[0])
        if last.wrench is not None:
            np.subtract(wrench[0], last.wrench[0], out=wrench[1])
        noise = (last.plate_noise or self._plate_noise).after(frame.plates)
        steps = self.kalman.settings.errors.lag_s / self.kalman.plant.dt_s
        return self._estimate(step, Changes(steps * self._change(was, state)[None], wrench, noise))

    def _estimate(self, step: DynamicStep, changes: Changes) -> Posterior:
        state, contact = step.state, step.decisions.notes.contact
        return Posterior(
            state.q,
            state.v,
            state.a,
            state.w.reshape(2, 6),
            None if contact is None else contact.contacts,
            step.refused,
            step.tracked,
            False,
            Record(state, step, None, changes),
            self.loads.wrench(self.loads.of(step.decisions.notes.supports, state)),
            lost=step.lost,
        )

    def _change(self, before: DynamicState, state: DynamicState) -> Array:
        """(nv + 12 or more,) change of accelerations and wrenches from one state to another."""
        whole = self.loads.whole(state) - self.loads.whole(before)
        return np.concatenate([state.a - before.a, state.w - before.w, whole])

    def moved(
        self,
        estimate: Posterior,
        state: DynamicState,
        before: DynamicState | None,
        ahead_s: float = np.inf,
        bend: Array | None = None,
    ) -> Posterior:
        """An estimate whose state later frames have corrected.

        Args:
            estimate: The filter's own.
            state: The corrected state.
            before: That of the frame before; None at a start.
            ahead_s: Time over which later frames are known; at the end of a trial there are none.
            bend: (nv + 12 or more,) second difference of accelerations and wrenches there; None where not known.
        """
        own: DynamicState = estimate.record.state
        if state is own:
            return estimate
        s, notes = self.kalman.settings.errors, _step(estimate).decisions.notes
        unknown = float(np.exp(-ahead_s / LATER_FADES_S))
        dt_s = self.kalman.plant.dt_s
        lag_s = s.smoothed_lag_s + unknown * (s.lag_s - s.smoothed_lag_s)
        late = [lag_s / dt_s * self._change(state if before is None else before, state)]
        if bend is not None:
            late.append((s.corner_s / dt_s) ** 2 * bend)
        changes = _changes(estimate)._replace(late=np.array(late), smoothed=state.P is not own.P)
        return estimate._replace(
            q=state.q,
            v=state.v,
            a=state.a,
            wrench=state.w.reshape(2, 6),
            record=estimate.record._replace(state=state, detail=changes),
            support=self.loads.wrench(self.loads.of(notes.supports, state)),
        )

    def kept(self, estimate: Posterior) -> Posterior:
        """An estimate without the covariance of its prediction: smoothing does not read its quarter of a megabyte."""
        step = estimate.record.step
        if step is None:
            return estimate
        prior = Prior(replace(step.prior.state, P=_NOTHING), step.prior.noise, ())
        return estimate._replace(record=estimate.record._replace(step=step._replace(prior=prior)))

    def smooth(self, run: Sequence[Posterior], wanted: int) -> list[Posterior]:
        """By an iterated smoother (:mod:`mbkf.filters.dynamic.smoother`).

        Args:
            run: Estimates of consecutive frames without a restart among them.
            wanted: Number of estimates to return.
        """
        steps = [_step(estimate) for estimate in run]
        if run[0].uncorrected:
            self._smoothing.forget()
        states = list(smooth(self.kalman, steps, ROUNDS, wanted, self._smoothing))
        ahead_s = self.kalman.plant.dt_s * np.arange(len(run) - 1, -1, -1)
        befores: list[DynamicState | None] = [None, *states]
        if run[0].started and len(states) > 1:
            # No frame comes before a start, which is as uncertain as an end.
            befores[0], ahead_s[0] = states[1], 0.0
        late = zip(run, states, befores, ahead_s, self._bends(states), strict=False)
        return [self.moved(*one) for one in late]

    def _bends(self, states: Sequence[DynamicState]) -> Sequence[Array | None]:
        """Second differences of accelerations and wrenches at states; first and last have those of their neighbours."""
        if len(states) < 3:  # a second difference takes three
            return [None] * len(states)
        steps = [self._change(*pair) for pair in pairwise(states)]
        inner = [after - before for before, after in pairwise(steps)]
        return [inner[0], *inner, inner[-1]]

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) of (q, v); dofs that no marker moves with may be anywhere a posture is."""
        motion = self.kalman.layout.motion
        P = self.errors(estimate).covariance()[motion, motion]
        P[self._unobservable, self._unobservable] += self._anywhere
        return P

    def spread(
        self,
        estimate: Posterior,
        torques: bool = True,
        levels: bool = False,
        body: BodyErrorRoots | None = None,
    ) -> Spread:
        """Standard deviations; torques' from the whole state through Newton–Euler."""
        levels = levels and bool(self._levels.sections.levels)
        found = self._variances(estimate, torques, levels)
        parts, q = ConfigurationParts(found.height, found.blocks), estimate.record.state.q
        torque, level = found.torque[-self.model.nv :], None
        if levels:
            level = found.torque[: -self.model.nv].reshape(self._levels.shape)
        own = found.position, found.velocity, torque, lambda: parts
        return Spread(self.reader, q, *own, body, found.wrench, level)

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) standard deviations of the feet's wrenches."""
        return root(self._variances(estimate, torques=False).wrench).reshape(2, 6)

    def support_sd(self, estimate: Posterior) -> Array:
        """(B, 6) from the state's covariance, and from how the parts that bear share their load."""
        loads = self.loads.of(_step(estimate).decisions.notes.supports, estimate.record.state)
        return self.loads.sd(loads, self.errors(estimate) if loads is not None else None)

    def _variances(self, estimate: Posterior, torques: bool = True, levels: bool = False) -> StateVariances:
        """Variances of all quantities of an estimate; kept, since they are asked for one after the other.

        Args:
            estimate: The estimate.
            torques: False where those of the torques may be NaN.
            levels: The trunk's moments come before the torques.
        """
        if self._read is not None and self._read[0] is estimate and self._read[2] >= torques + levels:
            return self._read[1]
        q, dofs = estimate.record.state.q, self.reader.coordinates.dofs
        by_state, shared = self._torques(estimate, levels) if torques else (self._no_torques, None)
        rise = self.reader.rise_jacobian(q)
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
        self._read = estimate, found, torques + levels
        return found

    def _torques(self, estimate: Posterior, levels: bool = False) -> tuple[Array, Array | None]:
        """(nv, n) derivative of the torques by the state, and the variance that sharing a load adds to them.

        Args:
            estimate: The estimate.
            levels: 6 L rows of the trunk's moments come before them.
        """
        state, balance = estimate.record.state, self.kalman.balance
        loads = self.loads.of(_step(estimate).decisions.notes.supports, state)
        if levels and loads is None:
            sections = self._levels.sections.table
            together = balance.compiled_loads(state.q, state.v, state.a, state.w, sections)
            if together is not None:
                return together, None
        torque = balance.torques(state.q, state.v, state.a, state.w)
        by_state, shared = self.loads.torques(balance, torque, loads)
        if not levels:
            return by_state, shared
        rows, of_sharing = self._levels.at(state, loads, torque.tau, by_state)
        both = np.concatenate([rows, by_state])
        return both, None if shared is None else np.concatenate([of_sharing, shared])

    @cached_property
    def _levels(self) -> LevelRows:
        return LevelRows(self.model, self.loads)

    def errors(self, estimate: Posterior) -> ErrorCovariance:
        """Errors of the whole state; the filter's own P where it knows how the noise is correlated."""
        state, step = estimate.record.state, _step(estimate)
        s, notes, changes = self.kalman.settings, step.decisions.notes, _changes(estimate)
        layout, q = self.kalman.layout, self.kalman.layout.q
        # Markers whose skin has a memory inform velocities and further states, too.
        information = step.readings.matrix[q, q]
        share = s.markers.innovation_share
        if share <= 0.0 or s.markers.skin_memory_s > 0.0 or self.kalman.spread_m is not None:
            return ErrorCovariance(layout, state.P, information, NO_DOFS, 0.0, 1.0, 0.0)
        seen = self._seen(notes.unmarked)
        # A pose takes up part of its markers' errors, so innovations show less than that.
        readings = 3 * int(np.count_nonzero(notes.trusted))
        over = max(readings - len(seen), readings // 4)
        skin = s.errors.skin_share * notes.lasting * share * readings / max(over, 1)
        # A limb out of sight errs as P says, and so does a reaction that rests on its acceleration.
        all_seen = len(seen) + len(self._unobservable) == self.model.nv
        contacts = () if notes.contact is None or not all_seen else notes.contact.contacts
        free = tuple(foot for foot, on in enumerate(contacts) if on == Contact.UNMEASURED)
        noise = None
        if changes.plate_noise is not None and notes.contact is not None:
            noise = changes.plate_noise.on_feet(notes.contact.centres_m)
        return ErrorCovariance(
            layout,
            state.P,
            information,
            seen,
            skin,
            s.errors.new_share,
            s.errors.skin_rate_rad_s,
            free,
            s.errors.sharing_scale,
            changes.late if unread(contacts) or notes.supports else None,
            self._edges(estimate, free, noise),
            self.loads.slice if notes.supports and all_seen else None,
            s.errors.smoothed_new_rates if changes.smoothed else s.errors.new_rates,
            self._plates(notes.contact, noise),
        )

    def _seen(self, unmarked: NDArray[np.intp]) -> NDArray[np.intp]:
        """Dofs that markers observe; ``unmarked`` is most often the array of the frame before."""
        if self._of_unmarked is None or self._of_unmarked[0] is not unmarked:
            known = ~self.kalman.unobservable
            known[unmarked] = False
            self._of_unmarked = unmarked, np.flatnonzero(known)
        return self._of_unmarked[1]

    def _plates(self, contact: ContactDecision | None, noise: Array | None) -> Array | float:
        """(2, 6) noise of the feet's wrenches over the filter's; where feet share a plate, no reading shows a share."""
        if contact is None or noise is None or Contact.SHARED in contact.contacts:
            return 1.0
        return np.minimum(noise / spread_about_origin(*self._usual, contact.centres_m), 1.0)

    def _edges(self, estimate: Posterior, free: tuple[int, ...], noise: Array | None) -> Array:
        """(n, 12) wrenches that feet may carry or not: see :mod:`mbkf.filters.error_covariance`.

        Args:
            estimate: The estimate.
            free: Feet that no plate reads.
            noise: (2, 6) noise of the readings under the feet; None where it is not known.
        """
        contact = _step(estimate).decisions.notes.contact
        if contact is None:
            return np.zeros((0, FEET))
        s, change = self.kalman.settings.errors, _changes(estimate).wrench
        edges = np.zeros((5, 2, 6))
        read = None
        if change is not None:
            read = changes_within(change, self._no_noise if noise is None else noise, s.frame_share)
        for foot in (0, 1):
            if foot in free:
                size = 0.0
                if self._edge_n > 0.0:
                    size = float(np.exp(-0.5 * (estimate.wrench[foot, 2] / (2.0 * self._edge_n)) ** 2))
                x, y, _ = contact.centres_m[foot]
                edges[foot, foot] = self._edge_n * size * np.array([0.0, 0.0, 1.0, y, -x, 0.0])
            elif contact.contacts[foot] == Contact.AIR:
                edges[foot, foot] = 0.0 if contact.below is None else contact.below
            elif read is not None:
                edges[foot, foot] = read[0, foot]
                edges[2 + foot, foot] = read[1, foot]
        if len(free) == FEET // 6 and contact.free is not None:
            stance = contact.free.stance
            beside, stepped = s.push_share
            vertical = np.maximum(estimate.wrench[:, 2], 1.0)
            edges[4] = push_apart(stance, contact.free.pelvis_m, vertical)
            edges[4] *= beside + step_apart(stance) * (stepped - beside)
        return edges.reshape(5, FEET)


def _step(estimate: Posterior) -> DynamicStep:
    return cast("DynamicStep", estimate.record.step)


def _changes(estimate: Posterior) -> Changes:
    return cast("Changes", estimate.record.detail)
