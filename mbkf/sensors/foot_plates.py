"""Force plates under the feet of a forced body, as a block: z = p(q, w) + r for each foot whose wrench is known.

w are the wrench states of right and left foot at the end of u (:mod:`mbkf.model.human_dynamics`), and p carries them to
the ankles, force N and moment N m in world axes (:mod:`mbkf.sensors.foot_wrench`, thesis eqs. 4.10–4.13):

    measured              z = the plate's wrench,  r ~ N(0, diag(σ_F², σ_M²)) of the plate
    air                   z = 0,                   r ~ N(0, diag(σ_F², σ_M²)) of a foot that carries nothing
    shared                z_r + z_l = the plate's wrench, and z_r its share by where the feet stand, with its spread
    unmeasured            no reading; the wrench follows from Newton's law and the other foot

Contact is decided at the state to which the posterior of the frame before leads at its own acceleration, q ⊕ v Δt and
v + a Δt, and not at the prediction, whose forces may be wrong at a heel strike.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactDecision, KeptContact
from mbkf.sensors.contact.sharing import SharedLoad
from mbkf.sensors.foot_wrench import FootWrenchSensor
from mbkf.sensors.states import ForceState
from mbkf.sensors.supports.sharing import about


@dataclass(frozen=True)
class FootPlateSettings:
    """Noise of the readings; moments about the ankle.

    Attributes:
        plate_force_n, plate_moment_nm: Of a plate's reading.
        air_force_n, air_moment_nm: Spread of the zero wrench of a foot in the air.
        plate_vertical_force_n: Of a plate's vertical force; None: as of its horizontal ones, ``plate_force_n``.
    """

    plate_force_n: float = 5.0
    plate_moment_nm: float = 2.0
    air_force_n: float = 0.1
    air_moment_nm: float = 0.02
    plate_vertical_force_n: float | None = None


class FootReading(NamedTuple):
    """Readings of the ground's reactions in a frame.

    Attributes:
        wrench: (2, 6) force N and moment N m about the world's origin, world axes, on right and left foot.
        known: (2,) feet whose wrench is read: from a plate, or 0 in the air.
        airborne: (2,) feet in the air.
        shared: Shares of both feet in one plate; None where they do not share one.
    """

    wrench: Array
    known: BoolArray
    airborne: BoolArray
    shared: SharedLoad | None = None

    @classmethod
    def of(cls, decision: ContactDecision) -> FootReading:
        """Of a decision on contact."""
        if decision.shared is not None:
            none, both = np.zeros(2, dtype=bool), np.ones(2, dtype=bool)
            return cls(decision.shared.wrench, both, none, decision.shared)
        airborne = np.array([foot == Contact.AIR for foot in decision.contacts])
        known = np.array([foot == Contact.MEASURED for foot in decision.contacts]) | airborne
        return cls(np.where(airborne[:, None], 0.0, decision.wrench), known, airborne)


class Ahead(NamedTuple):
    """State at which contact is decided: configuration q (nq,), velocity v and acceleration a (nv,)."""

    q: Array
    v: Array
    a: Array


class PlateMemory(NamedTuple):
    """The detector's memory, and the state at which the next contact is decided; None for the prediction."""

    contact: KeptContact
    ahead: Ahead | None


class PlateDecision(NamedTuple):
    """Contact of the feet, and readings of their wrenches."""

    contact: ContactDecision
    reading: FootReading


class FootPlates(Block[ForceState, None, PlateDecision, PlateMemory]):
    """Force plates that read wrench states.

    Attributes:
        dynamics: The forced body.
        detector: Decides the contact of the feet.
        sensor: Wrench states carried to points on the plates.
        settings: Noise.
        columns: Components of the state that are read: positions and wrenches.
    """

    columns: NDArray[np.intp]

    kind = "plates"

    def __init__(
        self,
        dynamics: HumanDynamics,
        detector: ContactDetector,
        dt_s: float,
        settings: FootPlateSettings = FootPlateSettings(),
    ) -> None:
        """Args: the attributes; dt_s: time between frames."""
        self.dynamics, self.detector, self.settings = dynamics, detector, settings
        self.sensor = FootWrenchSensor(dynamics)
        self._dt_s = dt_s
        self._plate = np.repeat([settings.plate_force_n, settings.plate_moment_nm], 3)
        if settings.plate_vertical_force_n is not None:
            self._plate[2] = settings.plate_vertical_force_n
        self._air = np.repeat([settings.air_force_n, settings.air_moment_nm], 3)

    def begin(self) -> PlateMemory:
        """Memory without a loaded plate."""
        return PlateMemory(self.detector.begin(), None)

    def decide(
        self, at: OperatingPoint[ForceState, None], frame: Frame, memory: PlateMemory, notes: Notes
    ) -> PlateDecision:
        """Plates to feet, and feet that stand elsewhere."""
        state = at.state
        where = memory.ahead
        if where is None:
            where = Ahead(state.q, state.v, self.dynamics.acceleration(state.q, state.v, state.forces))
        notes.contact = self.detector.decide(memory.contact, *where, frame.plates)
        return PlateDecision(notes.contact, FootReading.of(notes.contact))

    def linearise(self, at: OperatingPoint[ForceState, None], decision: PlateDecision) -> Rows | None:
        """Whitened rows on the whole state, of which positions and wrenches are read."""
        state, feet = at.state, decision.reading
        _, ankles = self.body.placements(state.q)
        points = ankles[self.sensor.ids]
        predicted = self.sensor.reading(state.q, state.u[-12:], points)
        target = feet.wrench.copy()
        target[:, 3:] -= _crossed(points, feet.wrench[:, :3])
        y, H = target.ravel() - predicted.wrench, np.zeros((12, self.layout.size))
        H[:, self.layout.q], H[:, self.layout.wrench] = predicted.by_q, predicted.by_state
        if feet.shared is not None:
            whitening = self._whitening(feet.shared, points)
            return Rows(whitening @ H, whitening @ y, readings=12)
        read = np.repeat(feet.known, 6)
        weight = 1.0 / self.sd(feet)[read]
        return Rows(H[read] * weight[:, None], y[read] * weight, readings=len(weight))

    def remember(
        self,
        posterior: ForceState,
        at: OperatingPoint[ForceState, None],
        decision: PlateDecision,
        memory: PlateMemory,
    ) -> PlateMemory:
        """The detector's memory, and the state to which the posterior leads."""
        del at, memory
        return self.next_memory(posterior, decision)

    def next_memory(self, posterior: ForceState, decision: PlateDecision) -> PlateMemory:
        """Memory after a frame with this posterior."""
        q, v, dt = posterior.q, posterior.v, self._dt_s
        a = self.dynamics.acceleration(q, v, posterior.forces)
        return PlateMemory(decision.contact.memory, Ahead(self.dynamics.integrate(q, dt * v), v + dt * a, a))

    def _whitening(self, shared: SharedLoad, points_m: Array) -> Array:
        """(12, 12) whitened map of the feet's wrenches about points (2, 3) to the plate's sum and the right share."""
        rows = np.zeros((12, 12))
        rows[:6, :6], rows[:6, 6:] = np.eye(6), about(points_m[0] - points_m[1])
        rows[6:, :6] = about(shared.centres_m[0] - points_m[0])
        return rows / np.concatenate([self._plate, shared.sd])[:, None]

    def sd(self, feet: FootReading) -> Array:
        """(12,) standard deviations of a frame's readings, infinite for a foot of unknown wrench."""
        if feet.shared is not None:
            return np.tile(np.hypot(self._plate, feet.shared.sd), 2)
        none = np.full(6, np.inf)
        sds = [
            self._air if airborne else self._plate if known else none
            for airborne, known in zip(feet.airborne, feet.known, strict=True)
        ]
        return np.concatenate(sds)

    def log_noise(self, decision: PlateDecision) -> float:
        """Log det R of the readings."""
        if decision.reading.shared is not None:
            return 2.0 * float(np.log(self._plate).sum() + np.log(decision.reading.shared.sd).sum())
        return 2.0 * float(np.log(self.sd(decision.reading)[np.repeat(decision.reading.known, 6)]).sum())


def _crossed(a: Array, b: Array) -> Array:
    """(n, 3) a × b, row by row; numpy's own takes ten times as long on two rows."""
    next_one, after = [1, 2, 0], [2, 0, 1]
    return a[:, next_one] * b[:, after] - a[:, after] * b[:, next_one]
