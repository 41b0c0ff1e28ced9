"""Contact of the feet decided frame by frame, from predicted motion and plates, as a live filter needs it.

A foot is *measured* when a loaded plate's centre of pressure lies under it, *unmeasured* when it carries weight where
no plate reads (its wrench is then unknown, not zero), and otherwise in the *air*. Two feet on one plate *share* it.
The rules with their limits are in :mod:`mbkf.sensors.contact.rules`. Departs from thesis section 4.1.4.1, where every
plate belongs to the nearest foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import dist, inf

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import PlateReadings
from mbkf.model.body import Body
from mbkf.sensors.contact.compiled import CompiledContact
from mbkf.sensors.contact.feet import FeetMotion, FeetOnBody
from mbkf.sensors.contact.plates import PlateAreas, pressed_at, surface_height
from mbkf.sensors.contact.records import (
    Contact,
    ContactDecision,
    ContactMemory,
    KeptContact,
    Planted,
    Pressed,
)
from mbkf.sensors.contact.rules import (
    BOTH,
    FLAT_FROM,
    FLAT_TO,
    LEAVE_SLACK,
    LEFT,
    NEITHER,
    REACH_M,
    RIGHT,
    SOLE_ENDS,
    STAND_AFTER_S,
    least_load,
    nearer_foot,
    stand_together,
    swings_over,
)
from mbkf.sensors.contact.soles import distance_to_sole, share_along
from mbkf.sensors.contact.stances import free_stance, shared_between
from mbkf.sensors.contact.unmeasured import UnmeasuredFeet

_FEET_OF = {RIGHT: (RIGHT,), LEFT: (LEFT,), BOTH: (RIGHT, LEFT), NEITHER: ()}
"""Feet by a plate's owner."""


class ContactDetector:
    """Assigns plates to feet and finds feet that carry weight elsewhere.

    Attributes:
        surfaces_m: Height of each plate's surface.
        origins_m: (K, 3) points that the plates' own moments refer to.
    """

    def __init__(self, model: Body, plates: Sequence[PlateReadings], dt_s: float) -> None:
        """Makes a detector.

        Args:
            model: The body.
            plates: The plates; their readings are not used.
            dt_s: Time between frames.
        """
        self._least_n = [least_load(plate.threshold_n) for plate in plates]
        self.surfaces_m = [surface_height(plate) for plate in plates]
        self.origins_m = np.array([plate.origin_m for plate in plates]).reshape(-1, 3)
        self._areas = PlateAreas(plates)
        self._model, self._feet, self._still = model, FeetOnBody(model), np.zeros(model.nv)
        floor_m = min(self.surfaces_m, default=np.nan)
        self._dt_s = dt_s
        self._elsewhere = UnmeasuredFeet(self._areas, floor_m, dt_s)
        self._compiled = CompiledContact.where_built(
            model,
            np.column_stack([self._areas.known, self._least_n, self.surfaces_m, self._areas.outlines()]),
            dt_s,
        )

    def begin(self) -> ContactMemory:
        """Memory before the first frame."""
        plates = len(self.surfaces_m)
        return ContactMemory(
            (NEITHER,) * plates, (None,) * plates, float("nan"), (STAND_AFTER_S, STAND_AFTER_S)
        )

    def decide(
        self,
        memory: KeptContact,
        q: Array,
        v: Array,
        a: Array,
        plate_wrench: Array,
        supported: bool = False,
    ) -> ContactDecision:
        """Contact of both feet in one frame.

        Args:
            memory: From the frame before.
            q: (nq,) predicted configuration.
            v: (nv,) predicted velocity.
            a: (nv,) predicted acceleration.
            plate_wrench: (K, 6) force N and moment N m about the world's origin; NaN where not recorded.
            supported: True where another part than the feet carries load.
        """
        if self._compiled is not None:
            return self._compiled.decide(memory, (q, v, a), plate_wrench, supported)
        assert isinstance(memory, ContactMemory), "packed memories come from the compiled decision"
        feet = self._feet.at(q, v)
        forces = plate_wrench[:, 2].tolist()
        loaded, unloaded, silent = self._by_load(forces)
        pressed, foot_of_plate = list(memory.pressed), [NEITHER] * len(forces)
        wrench, contacts = np.zeros((2, 6)), [Contact.AIR, Contact.AIR]
        for k in loaded:
            point = pressed_at(plate_wrench[k].tolist(), self.surfaces_m[k])
            owner = foot_of_plate[k] = self._owner(k, point, feet, memory)
            pressed[k] = Pressed(*point, owner)
            for foot in _FEET_OF[owner]:
                wrench[foot] += plate_wrench[k]
                contacts[foot] = Contact.SHARED if owner == BOTH else Contact.MEASURED
        elsewhere = self._elsewhere.decide(memory, (q, v, a), feet, contacts, unloaded, silent, supported)
        for foot in elsewhere.carrying:
            contacts[foot] = Contact.UNMEASURED
        lowest_ball_m = _lowest_balls(memory, feet, elsewhere.touching_s)
        small = [k for k in unloaded if forces[k] > 0.0]
        return ContactDecision(
            (contacts[0], contacts[1]),
            wrench,
            feet.middles_m,
            any(foot_of_plate[k] == NEITHER for k in loaded),
            ContactMemory(
                tuple(foot_of_plate),
                tuple(pressed),
                elsewhere.sole_height_m,
                elsewhere.touching_s,
                elsewhere.movement,
                lowest_ball_m,
            ),
            shared_between(feet.soles, feet.pelvis_m, plate_wrench, foot_of_plate, self.surfaces_m)
            if BOTH in foot_of_plate
            else None,
            free_stance(feet.soles, feet.pelvis_m, lowest_ball_m, elsewhere.touching_s)
            if len(elsewhere.carrying) == 2
            else None,
            elsewhere.near,
            elsewhere.floor_m_s,
            plate_wrench[small].sum(axis=0) if small else None,
        )

    def _by_load(self, forces_n: Sequence[float]) -> tuple[list[int], list[int], list[int]]:
        """Plates that are loaded, not loaded and not recorded, by their vertical forces (K), NaN where not recorded."""
        loaded: list[int] = []
        unloaded: list[int] = []
        silent: list[int] = []
        for k, (force, least) in enumerate(zip(forces_n, self._least_n, strict=True)):
            (loaded if force >= least else unloaded if force < least else silent).append(k)
        return loaded, unloaded, silent

    def planted(self, decision: ContactDecision, q: Array, foot: int) -> Planted | None:
        """Point at which a loaded foot does not slide; None for a foot in the air.

        A foot loaded between heel and ball lies flat, further back it rolls over its heel; loaded in front of the ball
        it stands on its toes.

        Args:
            decision: The frame's decision.
            q: (nq,) configuration it was taken for.
            foot: 0 right, 1 left.
        """
        if decision.contacts[foot] == Contact.AIR:
            return None
        sole = self._feet.at(q, self._still).soles[foot]
        if decision.contacts[foot] != Contact.MEASURED:
            lowest = min(sole[:SOLE_ENDS], key=lambda point: point[2])
            return Planted(self._model.roles.feet[foot], np.array(lowest), flat=False)
        surface = self.surfaces_m[decision.memory.foot_of_plate.index(foot)]
        x, y = pressed_at(decision.wrench[foot].tolist(), surface)
        pressed, ball = np.array([x, y, surface]), sole[1]
        share = share_along(x, y, sole)
        if share > share_along(ball[0], ball[1], sole):
            return Planted((self._model.roles.toes or self._model.roles.feet)[foot], pressed, flat=True)
        return Planted(self._model.roles.feet[foot], pressed, flat=FLAT_FROM < share < FLAT_TO)

    def _owner(self, k: int, point: tuple[float, float], feet: FeetMotion, memory: ContactMemory) -> int:
        """Foot or feet on plate k with this centre of pressure; the memory is from the frame before."""
        before = memory.foot_of_plate[k]
        lowest = right, left = [min(sole, key=lambda point: point[2]) for sole in feet.soles]
        if all(self._areas.over(k, x, y) for x, y, _ in lowest):
            speed = dist(feet.velocity(RIGHT, right), feet.velocity(LEFT, left))
            if stand_together(right[2] - left[2], speed, LEAVE_SLACK if before == BOTH else 1.0):
                return BOTH
        away_m = [distance_to_sole(*point, sole) for sole in feet.soles]
        nearest = nearer_foot(away_m, before)
        if before not in (RIGHT, LEFT) or nearest in (before, NEITHER) or away_m[before] > REACH_M:
            return nearest
        floor_m_s = memory.movement.floor_m_s(self._dt_s)
        speeds = [feet.speed(foot, lowest[foot], floor_m_s) for foot in (RIGHT, LEFT)]
        return before if swings_over(speeds[nearest], speeds[before]) else nearest


def _lowest_balls(
    memory: ContactMemory, feet: FeetMotion, touching_s: tuple[float, float]
) -> tuple[float, float]:
    """Least height of right and left ball while the foot has touched the floor."""
    right, left = (
        min(feet.soles[f][1][2], memory.lowest_ball_m[f] if touching_s[f] > 0.0 else inf)
        for f in (RIGHT, LEFT)
    )
    return right, left
