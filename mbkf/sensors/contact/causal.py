"""Contact of the feet decided frame by frame, from predicted motion and plates, as a live filter needs it.

A foot is *measured* when a loaded plate's centre of pressure lies under it, *unmeasured* when it carries weight where
no plate reads (its wrench is then unknown, not zero), and otherwise in the *air*. Two feet on one plate *share* it.
The limits, and how they differ from the offline ones, are in :mod:`mbkf.sensors.contact.thresholds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import PlateReadings
from mbkf.model.body import Body
from mbkf.sensors.contact.plates import PlateAreas, least_load, pressed_at, surface_height
from mbkf.sensors.contact.records import Contact, ContactDecision, ContactMemory, FreeStance, Planted, Pressed
from mbkf.sensors.contact.sharing import SharedLoad, expected_stance, push_share, share_load
from mbkf.sensors.contact.soles import Sole, distance_to_sole, nearer_foot, share_along, sole_locals
from mbkf.sensors.contact.thresholds import (
    FLAT_FROM,
    FLAT_TO,
    LEAVE_SLACK,
    LEVEL_M,
    PARTED_M_S,
    SOLE_ENDS,
    STAND_AFTER_S,
)
from mbkf.sensors.contact.unmeasured import UnmeasuredFeet
from mbkf.sensors.marker_sensor import MarkerSensor


class ContactDetector:
    """Assigns plates to feet and finds feet that carry weight elsewhere.

    Attributes:
        surfaces_m: Height of each plate's surface.
    """

    def __init__(self, model: Body, plates: Sequence[PlateReadings], dt_s: float) -> None:
        """Makes a detector.

        Args:
            model: The body.
            plates: The plates; their readings are not used.
            dt_s: Time between frames.
        """
        self._least_n = np.array([least_load(plate.threshold_n) for plate in plates])
        self.surfaces_m = [surface_height(plate) for plate in plates]
        self._areas = PlateAreas(plates)
        self._model, self._soles = model, MarkerSensor(model, *sole_locals(model))
        self._moves = [
            model.supports[model.joint(segment).joint_id].astype(float) for segment in model.roles.feet
        ]
        self._elsewhere = UnmeasuredFeet(model, self._areas, min(self.surfaces_m, default=np.nan), dt_s)

    def begin(self) -> ContactMemory:
        """Memory before the first frame."""
        plates = len(self.surfaces_m)
        return ContactMemory((-1,) * plates, (None,) * plates, float("nan"), (STAND_AFTER_S, STAND_AFTER_S))

    def decide(
        self,
        memory: ContactMemory,
        q: Array,
        v: Array,
        a: Array,
        plate_wrench: Array,
        supported: bool = False,
    ) -> ContactDecision:
        """What the feet stand on in one frame.

        Args:
            memory: From the frame before.
            q: (nq,) predicted configuration.
            v: (nv,) predicted velocity.
            a: (nv,) predicted acceleration.
            plate_wrench: (K, 6) force N and moment N m about the world's origin; NaN where not recorded.
            supported: Whether another part than the feet bears.
        """
        positions = self._soles.positions(q).reshape(2, 3, 3)
        soles = positions.tolist()
        vertical = plate_wrench[:, 2]
        loaded: list[int] = (vertical >= self._least_n).nonzero()[0].tolist()
        latest, foot_of_plate = list(memory.pressed), [-1] * len(vertical)
        for k in loaded:
            point = pressed_at(plate_wrench[k].tolist(), self.surfaces_m[k])
            foot_of_plate[k] = self._owner(k, point, (q, v), soles, memory.foot_of_plate[k])
            latest[k] = Pressed(*point, foot_of_plate[k])
        wrench, contacts = np.zeros((2, 6)), [Contact.AIR, Contact.AIR]
        for k in loaded:
            owner = foot_of_plate[k]
            for foot in (0, 1) if owner == 2 else (owner,) if owner >= 0 else ():
                wrench[foot] += plate_wrench[k]
                contacts[foot] = Contact.SHARED if owner == 2 else Contact.MEASURED
        shared = self._shared(foot_of_plate, plate_wrench, soles, q)
        elsewhere = self._elsewhere.decide(
            memory, (q, v, a), soles, contacts, vertical < self._least_n, np.isnan(vertical), supported
        )
        for foot in elsewhere.carrying:
            contacts[foot] = Contact.UNMEASURED
        balls, before = (soles[0][1][2], soles[1][1][2]), memory.lowest_ball_m
        right, left = (min(balls[f], before[f] if elsewhere.touching_s[f] > 0.0 else inf) for f in (0, 1))
        free = None
        if contacts[0] == contacts[1] == Contact.UNMEASURED:
            surface = min(point[2] for sole in soles for point in sole)
            pushes = (
                push_share(soles[0], right, elsewhere.touching_s[0]),
                push_share(soles[1], left, elsewhere.touching_s[1]),
            )
            free = FreeStance(expected_stance(soles, surface), self._pelvis_m(q), pushes)
        return ContactDecision(
            (contacts[0], contacts[1]),
            wrench,
            0.5 * (positions[:, 0] + positions[:, 2]),
            any(foot_of_plate[k] < 0 for k in loaded),
            ContactMemory(
                tuple(foot_of_plate),
                tuple(latest),
                elsewhere.sole_height_m,
                elsewhere.touching_s,
                elsewhere.movement,
                (right, left),
            ),
            shared,
            free,
            elsewhere.near,
            elsewhere.floor_m_s,
            self._below(plate_wrench),
        )

    def _below(self, plate_wrench: Array) -> Array | None:
        """(6,) sum of the wrenches (K, 6) that are smaller than what counts as a load; None for nothing."""
        small = (plate_wrench[:, 2] > 0.0) & (plate_wrench[:, 2] < self._least_n)
        return plate_wrench[small].sum(axis=0) if small.any() else None

    def planted(self, decision: ContactDecision, q: Array, foot: int) -> Planted | None:
        """The point at which a loaded foot does not slide; None for a foot in the air.

        A foot loaded between heel and ball lies flat, further back it rolls over its heel; loaded in front of the ball
        it stands on its toes.

        Args:
            decision: The frame's decision.
            q: (nq,) configuration it was taken for.
            foot: 0 right, 1 left.
        """
        if decision.contacts[foot] == Contact.AIR:
            return None
        sole = self._soles.positions(q).reshape(2, 3, 3)[foot]
        if decision.contacts[foot] != Contact.MEASURED:
            lowest = sole[:SOLE_ENDS][np.argmin(sole[:SOLE_ENDS, 2])]
            return Planted(self._model.roles.feet[foot], lowest, flat=False)
        surface = self.surfaces_m[decision.memory.foot_of_plate.index(foot)]
        x, y = pressed_at(decision.wrench[foot].tolist(), surface)
        pressed, ends = np.array([x, y, surface]), sole.tolist()
        share = share_along(x, y, ends)
        if share > share_along(ends[1][0], ends[1][1], ends):
            return Planted((self._model.roles.toes or self._model.roles.feet)[foot], pressed, flat=True)
        return Planted(self._model.roles.feet[foot], pressed, flat=FLAT_FROM < share < FLAT_TO)

    def _owner(
        self,
        k: int,
        point: tuple[float, float],
        motion: tuple[Array, Array],
        soles: Sequence[Sole],
        before: int,
    ) -> int:
        """Foot of plate k with this centre of pressure: 0 right, 1 left, 2 both, -1 none."""
        if self._both_on(k, motion, soles, LEAVE_SLACK if before == 2 else 1.0):
            return 2
        return nearer_foot([distance_to_sole(*point, sole) for sole in soles], before)

    def _both_on(self, k: int, motion: tuple[Array, Array], soles: Sequence[Sole], slack: float) -> bool:
        """Whether both feet stand on plate k: their lowest points over it, level, and at rest against each other.

        Args:
            k: The plate.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            soles: Heel, ball and toe end of both soles.
            slack: Factor on the limit of speed: feet that stood there together must clearly part.
        """
        if not self._areas.known[k]:
            return False
        lowest = np.array([min(sole, key=lambda point: point[2]) for sole in soles])
        if abs(lowest[0, 2] - lowest[1, 2]) >= LEVEL_M or not self._areas.contain(lowest[:, :2])[:, k].all():
            return False
        q, v = motion
        jacobian = self._model.spatial_jacobian(q)
        moving = [jacobian @ (v * moves) for moves in self._moves]
        velocity = [twist[:3] + np.cross(twist[3:], at) for twist, at in zip(moving, lowest, strict=True)]
        return bool(np.linalg.norm(velocity[0] - velocity[1]) < slack * PARTED_M_S)

    def _shared(
        self, foot_of_plate: Sequence[int], plate_wrench: Array, soles: Sequence[Sole], q: Array
    ) -> SharedLoad | None:
        """How the feet share what they stand on together: all that the plates under either of them read."""
        if 2 not in foot_of_plate:
            return None
        under = [k for k, owner in enumerate(foot_of_plate) if owner >= 0]
        surface = self.surfaces_m[foot_of_plate.index(2)]
        return share_load(plate_wrench[under].sum(axis=0), soles, self._pelvis_m(q), surface)

    def _pelvis_m(self, q: Array) -> Array:
        return self._model.placements(q)[1][self._model.root.joint_id]
