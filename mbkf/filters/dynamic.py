"""The dynamic filter: positions, velocities, accelerations and foot wrenches that obey Newton's law together.

DESIGN §4 fact 5: for given q and v, (a, w) and (τ, w) tell the same, so the state holds accelerations, the plant is
linear and never stiff, and the pelvis's six Newton–Euler equations enter as readings of zero. Torques follow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.filters.dynamic_records import Decision, DynamicStep, FrameReadings, Memory
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.filters.estimate import Foresight
from mbkf.filters.foot_rows import FootRows
from mbkf.filters.gate import Sight, judged
from mbkf.filters.habit import Habit
from mbkf.filters.inertial_part import InertialPart
from mbkf.filters.outlook import Outlook, Outlooks, Prediction
from mbkf.filters.singer import DynamicState, SingerPlant
from mbkf.filters.synergy import Synergy
from mbkf.model.newton_euler import FEET, NewtonEuler
from mbkf.numerics.kalman import Information, informed_with_rows
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactDecision
from mbkf.sensors.expectation import MarkerExpectation
from mbkf.sensors.markers import MarkerInformation, MarkerSensor
from mbkf.sensors.planted import standing_still
from mbkf.sensors.skin import SkinMarkers

NOWHERE = np.zeros(0, dtype=np.intp)
"""No dofs."""

FEET_ROWS = slice(6, 18)
"""Where among a frame's rows those on the feet's wrenches are."""

DISPLACED_SD_RAD = 0.5
DISPLACED_SD_RAD_S = 3.0
"""How far a limb may be, and how differently it may move, that comes back into sight where nobody expected it."""

START_WRENCH_SD = 1000.0
"""Spread of a wrench before the first reading, N and N m."""


class DynamicFilter:
    """Extended Kalman filter of a body that markers, plates and Newton's law follow.

    Attributes:
        sensor: The markers on the body.
        feet: The plates under it.
        plant: Decaying accelerations.
        outlooks: What it says of a frame before reading it.
        held: (nv,) dofs that no marker of the capture moves with.
        settings: What it believes.
        min_markers: Fewer believed markers than this leave the body untracked, unless inertial sensors read.
        inertial: Inertial sensors on the body, None where there are none.
        habit: What limbs do that nothing shows; None where that is not asked for.
    """

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        feet: ContactDetector,
        dt_s: float,
        held: BoolArray,
        settings: DynamicSettings,
        min_markers: int = 6,
        inertial: InertialPart | None = None,
    ) -> None:
        self.sensor, self.feet, self.held, self.settings = sensor, feet, held, settings
        self.min_markers, self.inertial = min_markers, inertial
        self.noise_m = noise_m * settings.marker_noise_scale
        model = sensor.model
        self.model, self.dt_s = model, dt_s
        acceleration = np.where(held, 0.0, settings.acceleration_scale * model.movement_sd)
        self.plant = SingerPlant(model, dt_s, acceleration, settings.decay_s)
        self.outlooks = Outlooks(sensor, held, settings)
        self._markers = MarkerInformation(sensor, self.noise_m)
        self._certainty = 1.0 / self.noise_m[:, None]
        s = settings
        self._feet = FootRows(3 * model.nv, GRAVITY_M_S2 * model.mass_kg, dt_s, s)
        self._calm = 1.0 - np.exp(-dt_s / s.activity_memory_s)
        usual_speed = s.unseen_velocity_s * self.plant.acceleration_sd
        self._rest = 1.0 / np.clip(usual_speed, *s.unseen_velocity_range)
        self._quiet = (s.quiet_share * self.plant.acceleration_sd) ** 2
        self._busiest = self.plant.acceleration_sd * np.where(np.arange(model.nv) < 3, *s.busy_shares)
        skin = s.skin_memory_s > 0.0
        camera, memory = s.camera_noise_m, s.skin_memory_s
        self._skin = SkinMarkers(sensor, self.noise_m, camera, memory, dt_s) if skin else None
        self._foot_dof = [model.joint(segment).v.start for segment in FEET]
        self._forget = 1.0 - np.exp(-dt_s / s.noise_memory_s)
        self._sight = Sight(sensor, held)
        self.habit = Habit(model, dt_s, held, s) if s.habit_memory_s > 0.0 else None

    @property
    def balance(self) -> NewtonEuler:
        """Newton–Euler equations."""
        return self.outlooks.balance

    def begin(self) -> Memory:
        """Memory before the first frame."""
        return Memory(self.feet.begin(), 1.0, None, None)

    def first(self, q: Array, v: Array, a: Array, P: Array, markers_m: Array, plates: Array) -> DynamicStep:
        """A first estimate from a pose and velocity with covariance (2 nv, 2 nv), and a frame's readings.

        Args:
            q: Configuration.
            v: Velocity.
            a: Acceleration.
            P: Covariance of (q, v).
            markers_m: (M, 3) positions, NaN where missing.
            plates: (K, 6) wrenches about the world's origin, NaN where not recorded.
        """
        nv = self.model.nv
        whole = np.zeros((3 * nv + 12, 3 * nv + 12))
        free = np.tile(~self.held, 2)
        whole[: 2 * nv, : 2 * nv] = P * np.outer(free, free)
        every = np.arange(2 * nv, 3 * nv)
        whole[every, every] = np.where(self.held, 0.0, self.model.acceleration_sd) ** 2
        every = np.arange(3 * nv, 3 * nv + 12)
        whole[every, every] = START_WRENCH_SD**2
        state = DynamicState(q, v, a, np.zeros(12), whole)
        known = self._foresight(state, self.plant.acceleration_sd, {})
        return self._corrected(known, self.begin(), markers_m, plates)

    def expect(self, state: DynamicState, memory: Memory) -> Foresight:
        """All that can be worked out before the frame is there."""
        sd = self._movement(memory)
        synergies = {} if self.habit is None else self.habit.learned(memory)
        return self._foresight(self.plant.predict(state, sd), sd, synergies)

    def _foresight(
        self, prior: DynamicState, acceleration_sd: Array, synergies: Mapping[int, Synergy]
    ) -> Foresight:
        nv, outlook = self.model.nv, self.outlooks.at(prior)
        markers = MarkerExpectation(outlook.reading, prior.P[:nv, :nv])
        return Foresight(prior.q, markers, Prediction(outlook, acceleration_sd, synergies))

    def step(
        self,
        state: DynamicState,
        memory: Memory,
        markers_m: Array,
        plates: Array,
        imus: Array | None = None,
        foresight: Foresight | None = None,
    ) -> DynamicStep:
        """Prediction and correction by one frame.

        Args:
            state: Posterior of the frame before.
            memory: Of the frame before.
            markers_m: (M, 3) positions, NaN where missing.
            plates: (K, 6) wrenches about the world's origin: force N, moment N m; NaN where not recorded.
            imus: (S, 6) readings of inertial sensors.
            foresight: What :meth:`expect` made of state and memory; used up.
        """
        foresight = foresight or self.expect(state, memory)
        return self._corrected(foresight, memory, markers_m, plates, imus)

    def _movement(self, memory: Memory) -> Array:
        """(nv,) σ_a of the next step: a still joint is expected to stay so, a busy one to change quickly."""
        usual = self.plant.acceleration_sd
        if memory.activity is None:
            return usual
        busy = np.sqrt(self._quiet + self.settings.activity_gain**2 * memory.activity)
        return np.minimum(busy, self._busiest)

    def _next_activity(self, state: DynamicState, memory: Memory, unseen: NDArray[np.intp]) -> Array | None:
        """(nv,) mean square; what nobody sees moves as usual, or it would feed on its own guesses."""
        if self.settings.activity_gain <= 0.0:
            return None
        now = state.a**2 + (self.settings.activity_rate * state.v) ** 2
        if len(unseen):
            now[unseen] = (self.plant.acceleration_sd[unseen] / self.settings.activity_gain) ** 2
        return now if memory.activity is None else memory.activity + self._calm * (now - memory.activity)

    def _corrected(
        self,
        foresight: Foresight,
        memory: Memory,
        markers_m: Array,
        plates: Array,
        imus: Array | None = None,
    ) -> DynamicStep:
        predicted: Prediction = foresight.prior
        outlook, prior = predicted.outlook, predicted.outlook.state
        innovation = markers_m - outlook.reading.positions_m
        decision = self._decide(foresight, memory, innovation, plates)
        if imus is not None and self.inertial is not None:
            decision = self.inertial.decide(decision, memory, imus)
        if self.habit is not None:
            decision = self.habit.decide(decision, predicted.synergies, prior)
        self.unsettle(prior.P, decision)
        frame = self._linearised(outlook, decision, innovation)
        state = self._updated(prior, frame)
        lifted = self._pulling_feet(state, decision.load)
        if lifted:
            decision = decision._replace(lifted=lifted)
            frame = self._with_feet(frame, prior, decision)
            state = self._updated(prior, frame)

        def remember() -> Memory:
            after = Memory(
                decision.load.memory,
                self._next_noise_scale(decision, innovation),
                self._next_activity(state, memory, decision.unseen),
                None if self._skin is None else np.where(decision.trusted[:, None], markers_m, np.nan),
            )
            if self.inertial is not None:
                after = self.inertial.remember(after, memory, state.q, decision)
            if self.habit is not None:
                after = self.habit.remember(after, memory, state, decision, predicted.synergies)
            return after

        enough = decision.imus is not None or bool(np.count_nonzero(decision.trusted) >= self.min_markers)
        return DynamicStep(state, remember, decision, enough and not decision.strayed, prior, frame)

    def _updated(self, prior: DynamicState, frame: FrameReadings) -> DynamicState:
        P = informed_with_rows(prior.P.T, frame.matrix, frame.rows)
        return self.retract(prior, P @ frame.whole_vector, P)

    def _pulling_feet(self, state: DynamicState, load: ContactDecision) -> tuple[int, ...]:
        """Free feet whose estimated force pulls at the floor, clearly more than it is kept from that."""
        if Contact.UNMEASURED not in load.contacts:
            return ()
        least = -3.0 * self.settings.pulling_force_n
        return tuple(
            f for f in (0, 1) if load.contacts[f] == Contact.UNMEASURED and state.w[6 * f + 2] < least
        )

    def unsettle(self, P: Array, decision: Decision) -> None:
        """Adds to a predicted covariance, in place, what the plant does not know.

        Wrenches wander, their moments about the soles; a displaced limb is somewhere else than expected.
        """
        nv, dofs = self.model.nv, decision.displaced
        wander = self._feet.wander(decision.load)
        for foot in (0, 1):
            mine = slice(3 * nv + 6 * foot, 3 * nv + 6 * foot + 6)
            own = P[mine, mine]
            own += wander[foot]
        if len(dofs):
            P[dofs, dofs] += DISPLACED_SD_RAD**2
            P[nv + dofs, nv + dofs] += DISPLACED_SD_RAD_S**2

    def difference(self, origin: DynamicState, state: DynamicState) -> Array:
        """(N,) tangent vector from one state's mean to another's."""
        q = self.model.difference(origin.q, state.q)
        return np.concatenate([q, state.v - origin.v, state.a - origin.a, state.w - origin.w])

    def retract(self, state: DynamicState, step: Array, P: Array) -> DynamicState:
        """The state moved by a tangent vector (N,), with another covariance."""
        nv = self.model.nv
        q = self.model.integrate(state.q, step[:nv])
        return DynamicState(
            q, state.v + step[nv : 2 * nv], state.a + step[2 * nv : 3 * nv], state.w + step[3 * nv :], P
        )

    def linearise(self, state: DynamicState, decision: Decision, markers_m: Array) -> FrameReadings:
        """A frame's readings, decided before, linearised at another state (for smoothing)."""
        outlook = self.outlooks.at(state)
        return self._linearised(outlook, decision, markers_m - outlook.reading.positions_m)

    def _decide(self, foresight: Foresight, memory: Memory, innovation: Array, plates: Array) -> Decision:
        predicted, markers = foresight.prior, foresight.markers
        prior = predicted.outlook.state
        noise = self.noise_m * memory.noise_scale**0.5
        seen, trusted, displaced, strayed = judged(
            innovation, markers.reading, markers.covariance, noise, self.settings
        )
        moved = NOWHERE if displaced is None else self._sight.carriers(displaced)
        unseen = self._sight.unseen(trusted)
        load = self.feet.decide(memory.footing, prior.q, prior.v, prior.a, plates)
        lost = [f for f in (0, 1) if self._foot_dof[f] in unseen] if len(unseen) else []
        planted = tuple(p for p in (self.feet.planted(load, prior.q, f) for f in lost) if p is not None)
        return Decision(
            trusted,
            seen,
            load,
            memory.noise_scale,
            unseen,
            planted,
            moved[moved >= 6],
            predicted.acceleration_sd,
            memory.markers_m,
            strayed,
        )

    def _next_noise_scale(self, decision: Decision, innovation: Array) -> float:
        share = self.settings.innovation_share
        trusted = decision.trusted
        if share <= 0.0 or not np.count_nonzero(trusted):
            return decision.noise_scale
        scaled = innovation[trusted] * self._certainty[trusted]
        squared = float(np.vdot(scaled, scaled)) / scaled.size
        low, high = self.settings.noise_range
        wanted = min(max(squared / share, low**2), high**2)
        return decision.noise_scale + self._forget * (wanted - decision.noise_scale)

    def _linearised(self, outlook: Outlook, decision: Decision, innovation: Array) -> FrameReadings:
        markers = self._marker_information(outlook, decision, innovation)
        lean, nv = self.outlooks.lean(outlook, decision.unseen), self.model.nv
        matrix, vector = markers.matrix.copy(), markers.vector.copy()
        matrix[:nv, :nv] += lean.matrix
        vector[:nv] += lean.vector
        rows, values, readings = self._rows(outlook, decision)
        return FrameReadings(markers, matrix, vector, rows, values, readings)

    def _with_feet(self, frame: FrameReadings, state: DynamicState, decision: Decision) -> FrameReadings:
        """The same readings where only what the feet carry was decided anew."""
        rows, values = frame.rows.copy(), frame.values.copy()
        rows[FEET_ROWS] = 0.0
        readings = 6 + self._feet.fill(
            rows[FEET_ROWS], values[FEET_ROWS], state.w, decision.load, decision.lifted
        )
        return replace(frame, rows=rows, values=values, readings=readings)

    def _marker_information(self, outlook: Outlook, decision: Decision, innovation: Array) -> Information:
        """Of the configuration; of (q, v, a) where skin artefacts are modelled."""
        state, reading = outlook.state, outlook.reading
        if self._skin is None or decision.before_m is None:
            found = self._markers.at(state.q, reading, innovation, decision.trusted)
        else:
            q, v, a = state.q, state.v, state.a
            found = self._skin.at(q, v, a, reading, innovation, decision.trusted, decision.before_m)
        return found.scaled(1.0 / decision.noise_scale)

    def _rows(self, outlook: Outlook, decision: Decision) -> tuple[Array, Array, int]:
        """Newton–Euler, feet, and what holds back unseen joints, whitened; the pulls come last."""
        state, nv, size = outlook.state, self.model.nv, 3 * self.model.nv + 12
        unseen = decision.unseen
        rows = np.zeros((18 + 2 * len(unseen), size))
        values = np.empty(len(rows))
        rows[:6], values[:6] = outlook.law, outlook.law_values
        readings = 6 + self._feet.fill(
            rows[FEET_ROWS], values[FEET_ROWS], state.w, decision.load, decision.lifted
        )
        if len(unseen):
            k = np.arange(len(unseen))
            rest = self._rest[unseen]
            rows[18 + k, nv + unseen] = rest
            values[18 + k] = -rest * state.v[unseen]
            calm = 1.0 / (self.settings.unseen_acceleration_share * self.plant.acceleration_sd[unseen])
            rows[18 + len(unseen) + k, 2 * nv + unseen] = calm
            values[18 + len(unseen) + k] = -calm * state.a[unseen]
        sds = self.settings.planted_speed_sd, self.settings.planted_turn_sd
        parts = [(nv, *standing_still(self.model, state.q, state.v, foot, *sds)) for foot in decision.planted]
        if self.inertial is not None:
            parts += self.inertial.parts(state, decision, rows[:6], values[:6])
        if self.habit is not None:
            parts += self.habit.rows(state, decision)
        for first, block, short in parts:
            on_state = np.zeros((len(block), size))
            on_state[:, first : first + block.shape[1]] = block
            rows, values = np.vstack([rows, on_state]), np.concatenate([values, short])
        return rows, values, readings
