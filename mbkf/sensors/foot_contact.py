"""Plates and foot contact, as a block: readings of each foot's wrench w, by its contact.

    measured    X w = X w_plate + r       r ~ N(0, diag(σ_F², σ_M²)) of the plate, moments about the middle of the sole
    shared      X (w_r + w_l) = X w_plate + r, and X w_r its share by geometry (:mod:`mbkf.sensors.contact.sharing`)
    air         X w = r                   a foot in the air carries nothing
    unmeasured  X w = X w_share + r       weakly its share of the weight; its wrench is otherwise free; in double
                                          support each foot's lever and direction by where it stands

X moves a wrench from the world's origin to the middle of the sole. Between frames wrenches are random walks about that
point. :class:`mbkf.sensors.contact.causal.ContactDetector` decides the contact of each foot. An unmeasured foot whose
posterior force pulls at the floor is read again as carrying nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact, ContactDecision, FreeStance, KeptContact
from mbkf.sensors.contact.sharing import (
    LEAST_SHARE,
    LEVER_M,
    TWIST_M,
    SharedLoad,
    shear_to_pelvis,
    step_apart,
)
from mbkf.sensors.states import LoadedState


@dataclass(frozen=True)
class FootContactSettings:
    """Noise of plates and of feet that stand elsewhere; moments about the middle of the sole.

    Attributes:
        plate_force_n, plate_moment_nm: Noise of a plate's reading.
        wrench_force, wrench_moment: Random walk of a foot's wrench, N/√s and N m/√s: a heel strike loads a foot with
            a body weight in a tenth of a second.
        air_force_n, air_moment_nm: Spread of the zero wrench of a foot in the air.
        free_force_share, free_lever_m: Spread of an unmeasured foot's force about its share of the weight, in body
            weights, and of its lever about the middle of the sole, m, per reading: it keeps two such feet from pulling
            against each other.
        pulling_force_n: Spread of the zero force by which an unmeasured foot is kept from pulling at the floor, N.
        free_push_share: Spread of the share of the load on a foot that pushes off, as part of that share.
        free_shear_share: Spread of an unmeasured foot's shear force about the direction to the pelvis in double
            support, as a share of its vertical force.
        free_direction: Share of the direction to the pelvis that shear forces follow, where the feet stand side by side
            and where they are a step apart.
        free_sway_m: Spread of both centres of pressure together along the soles where the feet stand side by side, m:
            Newton's law knows their sum, and a lean lasts.
        landing_force_n, landing_moment_nm: Spread of the wrench of a foot in the air that is about to touch a floor
            that no plate reads, or has just left it: the instant is known to some 40 ms.
    """

    plate_force_n: float = 3.0
    plate_moment_nm: float = 1.0
    wrench_force: float = 3000.0
    wrench_moment: float = 300.0
    air_force_n: float = 0.5
    air_moment_nm: float = 0.2
    free_force_share: float = 2.0
    free_lever_m: float = 0.3
    pulling_force_n: float = 10.0
    free_push_share: float = 1.6
    free_shear_share: float = 0.08
    free_direction: tuple[float, float] = (0.3, 0.9)
    free_sway_m: float = 0.5
    landing_force_n: float = 120.0
    landing_moment_nm: float = 6.0


PUSH_LEAST = 0.07
"""Share added to that of a foot that pushes off to give its spread."""

TOGETHER = 0.1
"""Weight of the direction of both feet's shear together, over that of their difference, where no plate reads."""


HALF = 0.5**0.5
"""Sum and difference of two rows times this are as independent as the rows."""

BELT_FORCE = 2.0
"""Force in body weights whose moment about the world's origin changes as a belt takes it along."""


class FootDecision(NamedTuple):
    """Contact of the feet, and unmeasured feet, 0 right and 1 left, that were seen to carry nothing."""

    contact: ContactDecision
    lifted: tuple[int, ...] = ()


class FootContact(Block[LoadedState, None, FootDecision, KeptContact]):
    """Force plates under the feet: twelve rows on the wrenches of right and left foot.

    Attributes:
        detector: Decides the contact of the feet.
        settings: Noise.
    """

    kind = "plates"
    quantities = 2

    def __init__(
        self,
        detector: ContactDetector,
        weight_n: float,
        dt_s: float,
        settings: FootContactSettings = FootContactSettings(),
    ) -> None:
        """Args: the attributes; weight_n: the body's weight; dt_s: time between frames."""
        self.detector, self.settings, self._weight_n, self._dt_s = detector, settings, weight_n, dt_s
        s = settings
        self._plate = 1.0 / np.repeat([s.plate_force_n, s.plate_moment_nm], 3)
        self._air = 1.0 / np.repeat([s.air_force_n, s.air_moment_nm], 3)
        self._free = 1.0 / np.repeat([s.free_force_share * weight_n, s.free_lever_m * weight_n], 3)
        self._pulling = self._free.copy()
        self._pulling[2] = 1.0 / s.pulling_force_n
        self._landing = np.repeat([s.landing_force_n, s.landing_moment_nm], 3)
        self._walk_sd = np.array([s.wrench_force, s.wrench_moment]) * dt_s**0.5
        self._walk = np.repeat(self._walk_sd, 3)
        self._kernel = library()

    def begin(self) -> KeptContact:
        """Memory without a loaded plate."""
        return self.detector.begin()

    def decide(
        self, at: OperatingPoint[LoadedState, None], frame: Frame, memory: KeptContact, notes: Notes
    ) -> FootDecision:
        """Plates to feet, and feet that stand elsewhere."""
        state = at.state
        supported = bool(notes.supports)
        notes.contact = self.detector.decide(memory, state.q, state.v, state.a, frame.plates, supported)
        return FootDecision(notes.contact)

    def inflate(self, P: Array, decision: FootDecision) -> None:
        """Adds the wrenches' random walk about the middles of the soles, which a belt carries along."""
        contact, first = decision.contact, self.layout.wrench.start
        x, y = contact.floor_m_s
        carried = BELT_FORCE * self._weight_n * self._dt_s * np.array([y, -x]) if x or y else _NO_BELT
        if self._kernel is not None:
            self._kernel.add_wrench_walk(P, first, contact.centres_m, self._walk_sd, carried)
            return
        shift = _about(-contact.centres_m) * self._walk
        walk = shift @ shift.transpose(0, 2, 1)
        walk[:, 3:5, 3:5] += np.outer(carried, carried)
        for foot, added in enumerate(walk):
            own = slice(first + 6 * foot, first + 6 * foot + 6)
            P[own, own] += added

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: FootDecision) -> Rows:
        """Twelve rows; readings of plates come first."""
        contact, lifted, w = decision.contact, decision.lifted, at.state.w.reshape(2, 6)
        if contact.shared is not None:
            return self._shared(w, contact, contact.shared)
        if contact.free is not None and not lifted:
            return self._both_unmeasured(w, contact.free)
        kinds = contact.contacts
        pulls = (w[0, 2] < 0.0 or 0 in lifted, w[1, 2] < 0.0 or 1 in lifted)
        weights = self._weight(contact, 0, pulls[0]), self._weight(contact, 1, pulls[1])
        expected = self._expected(contact, pulls)
        left_first = kinds[1] == Contact.MEASURED != kinds[0]
        rows, values = self._separate(w, contact.centres_m, weights, expected, left_first)
        return Rows(rows, values, self.layout.wrench.start, 6 * kinds.count(Contact.MEASURED))

    def _separate(
        self,
        w: Array,
        middles_m: Array,
        weights: tuple[Array, Array],
        expected: Array,
        left_first: bool,
    ) -> tuple[Array, Array]:
        """(12, 12) rows and (12,) innovations of feet whose wrenches are read one by one.

        Args:
            w: (2, 6) wrenches.
            middles_m: (2, 3) of the soles.
            weights: (6,) 1/sd of right and left foot's rows.
            expected: (2, 6) wrenches as read.
            left_first: True if the rows of the left foot come first.
        """
        if self._kernel is not None:
            return self._kernel.wrench_rows(middles_m, *weights, expected, w, left_first)
        X = _about(middles_m)
        X *= np.array(weights)[:, :, None]
        return _stacked(X, np.vecdot(X, (expected - w)[:, None]), left_first)

    def review(self, posterior: LoadedState, decision: FootDecision) -> FootDecision | None:
        """Unmeasured feet that pull at the floor clearly beyond ``pulling_force_n`` carry nothing."""
        kinds = decision.contact.contacts
        if Contact.UNMEASURED not in kinds:
            return None
        least = -3.0 * self.settings.pulling_force_n
        lifted = tuple(f for f in (0, 1) if kinds[f] == Contact.UNMEASURED and posterior.w[6 * f + 2] < least)
        return decision._replace(lifted=lifted) if lifted else None

    def remember(
        self,
        posterior: LoadedState,
        at: OperatingPoint[LoadedState, None],
        decision: FootDecision,
        memory: KeptContact,
    ) -> KeptContact:
        """The detector's memory."""
        return decision.contact.memory

    def log_noise(self, decision: FootDecision) -> float:
        """Log det R of the plates' readings."""
        kinds = decision.contact.contacts
        plates = 1 if Contact.SHARED in kinds else kinds.count(Contact.MEASURED)
        return -2.0 * plates * float(np.log(self._plate).sum())

    def _expected(self, contact: ContactDecision, pulls: Sequence[bool]) -> Array:
        """(2, 6) wrenches as read: the plate's, zero, or the foot's share of the weight that no plate carries.

        An unmeasured foot that would pull at the floor is read as zero.
        """
        if Contact.UNMEASURED not in contact.contacts:
            return contact.wrench
        expected = contact.wrench.copy()
        for foot, (kind, other) in enumerate((contact.contacts, contact.contacts[::-1])):
            if kind != Contact.UNMEASURED or pulls[foot]:
                continue
            carried = float(contact.wrench[1 - foot, 2]) if other == Contact.MEASURED else 0.0
            rest = max(self._weight_n - carried, 0.0) * (0.5 if other == Contact.UNMEASURED else 1.0)
            x, y, _ = contact.centres_m[foot].tolist()
            expected[foot] = 0.0, 0.0, rest, y * rest, -x * rest, 0.0
        return expected

    def _weight(self, contact: ContactDecision, foot: int, pulls: bool) -> Array:
        """(6,) 1/sd of the rows of a foot, 0 right and 1 left, unmeasured perhaps and pulling at the floor."""
        kind, near = contact.contacts[foot], contact.near[foot]
        if kind == Contact.MEASURED:
            return self._plate
        if kind == Contact.AIR:
            return 1.0 / (1.0 / self._air + near * self._landing) if near else self._air
        return self._pulling if pulls else self._free

    def _both_unmeasured(self, w: Array, free: FreeStance) -> Rows:
        """Both feet on floor that no plate reads: Newton's law gives their sum, geometry place and direction of each.

        About its expected centre of pressure each foot's horizontal moment is 0 to a lever, the forces differ as those
        that point to the pelvis do, and each vertical force is weakly half of the weight. Feet side by side are loaded
        towards heels or toes together, as the body leans; a step apart the foot ahead is at its heel and the foot
        behind at its toes.
        """
        s, weight = self.settings, self._weight_n
        right, left = (max(force, LEAST_SHARE * weight) for force in w[:, 2].tolist())
        centres = free.stance.centres_at(right / (right + left))
        x, y = free.stance.forward.tolist()
        X = _about(centres)
        step = step_apart(free.stance)
        beside, stepped = s.free_direction
        X[:, :2, 2] -= (beside + step * (stepped - beside)) * shear_to_pelvis(free.pelvis_m, centres)
        X[:, 3:5] = np.array([[x, y], [-y, x]]) @ X[:, 3:5]
        shear, vertical = s.free_shear_share * 0.5 * (right + left), s.free_force_share * weight
        sd = np.array(
            [
                (shear, shear, vertical, LEVER_M * force, LEVER_M * force, TWIST_M * force)
                for force in (right, left)
            ]
        )
        X /= sd[:, :, None]
        values = -np.vecdot(X, w[:, None])
        values[:, 2] += 0.5 * weight / vertical
        rows, values = _stacked(X, values)
        for foot, share in enumerate(free.push_share):
            if share is not None:
                own, row = 6 * foot + 2, rows[6 * foot + 2]
                row[:] = 0.0
                row[own], row[10 - own] = 1.0 - share, -share
                row /= s.free_push_share * (share + PUSH_LEAST) * weight
                values[own] = -row @ w.ravel()
        # Newton's law gives the shear of both feet together better than the direction to the pelvis does.
        for kept in (rows, values):
            of_right, of_left = kept[:2].copy(), kept[6:8].copy()
            kept[:2], kept[6:8] = of_right - of_left, TOGETHER * (of_right + of_left)
        # Likewise the centres of pressure of both feet together, where they stand side by side.
        together = LEVER_M / (LEVER_M + s.free_sway_m * (1.0 - step))
        for kept in (rows, values):
            of_right, of_left = kept[4].copy(), kept[10].copy()
            kept[4], kept[10] = HALF * (of_right - of_left), together * HALF * (of_right + of_left)
        return Rows(rows, values, self.layout.wrench.start, 0)

    def _shared(self, w: Array, contact: ContactDecision, shared: SharedLoad) -> Rows:
        """One plate reads the sum of both wrenches; geometry gives their shares, with a spread."""
        rows, values = np.zeros((12, 12)), np.empty(12)
        middle = _about(contact.centres_m.mean(axis=0, keepdims=True))[0] * self._plate[:, None]
        rows[:6, :6] = rows[:6, 6:] = middle
        values[:6] = middle @ (shared.wrench.sum(axis=0) - w.sum(axis=0))
        right = _about(shared.centres_m[:1])[0] / shared.sd[:, None]
        rows[6:, :6] = right
        values[6:] = right @ (shared.wrench[0] - w[0])
        return Rows(rows, values, self.layout.wrench.start, 6)


def _stacked(X: Array, values: Array, left_first: bool = False) -> tuple[Array, Array]:
    """(12, 12) rows on both wrenches and (12,) innovations.

    Args:
        X: (2, 6, 6) rows on the wrench of right and left foot.
        values: (2, 6) their innovations.
        left_first: True if the rows of the left foot come first.
    """
    rows = np.zeros((2, 6, 2, 6))
    if left_first:
        rows[0, :, 1], rows[1, :, 0] = X[1], X[0]
        return rows.reshape(12, 12), values[::-1].ravel()
    rows[0, :, 0], rows[1, :, 1] = X
    return rows.reshape(12, 12), values.ravel()


def _about(points_m: Array) -> Array:
    """(k, 6, 6) transforms of a wrench about the world's origin to each of the points (k, 3): n − c × f."""
    found = points_m @ _LEVERS
    found += _UNMOVED
    return found.reshape(-1, 6, 6)


def _levers() -> Array:
    """(3, 36) derivative of :func:`_about` by a shift along each axis."""
    table = np.zeros((3, 6, 6))
    for x, y, z in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        table[x, 3 + z, y], table[x, 3 + y, z] = -1.0, 1.0
    return table.reshape(3, 36)


_LEVERS = _levers()
_UNMOVED = np.eye(6).ravel()
_NO_BELT = np.zeros(2)
