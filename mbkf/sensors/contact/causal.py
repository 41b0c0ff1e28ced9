"""Contact of the feet decided frame by frame, from predicted motion and plates, as a live filter needs it.

A foot is *measured* when a loaded plate's centre of pressure lies under it, *unmeasured* when it carries weight where
no plate reads (its wrench is then unknown, not zero), and otherwise in the *air*. Two feet on one plate *share* it.
The limits, and how they differ from the offline ones, are in :mod:`mbkf.sensors.contact.thresholds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, isnan
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.model.human import HumanModel
from mbkf.sensors.contact.plates import PlateAreas, least_load, pressed_at, surface_height
from mbkf.sensors.contact.records import Contact, ContactDecision, ContactMemory, Planted, Pressed
from mbkf.sensors.contact.soles import Sole, distance_to_sole, nearer_foot, share_along, sole_locals
from mbkf.sensors.contact.thresholds import (
    BETWEEN_M,
    FALL_M_S2,
    FLAT_FROM,
    FLAT_TO,
    FLOOR_SHARE,
    LEAVE_SLACK,
    REACH_M,
    SOLE_ENDS,
    STAND_AFTER_S,
    STAND_HEIGHT_M,
    STAND_SPEED_M_S,
    TOUCH_HEIGHT_M,
)
from mbkf.sensors.marker_sensor import MarkerSensor


class ContactDetector:
    """Assigns plates to feet and finds feet that carry weight elsewhere.

    Attributes:
        surfaces_m: Height of each plate's surface.
    """

    def __init__(self, model: HumanModel, plates: Sequence[PlateReadings], dt_s: float) -> None:
        """Makes a detector.

        Args:
            model: The body.
            plates: The plates; their readings are not used.
            dt_s: Time between frames.
        """
        self._dt_s = dt_s
        self._least_n = np.array([least_load(plate.threshold_n) for plate in plates])
        self.surfaces_m = [surface_height(plate) for plate in plates]
        self._areas = PlateAreas(plates)
        self._model, self._soles = model, MarkerSensor(model, *sole_locals(model))
        self._moves = [
            model.supports[model.joint(segment).joint_id].astype(float) for segment in model.roles.feet
        ]
        self._floor = min(self.surfaces_m, default=np.nan)

    def begin(self) -> ContactMemory:
        """Memory before the first frame."""
        plates = len(self.surfaces_m)
        return ContactMemory((-1,) * plates, (None,) * plates, float("nan"), (STAND_AFTER_S, STAND_AFTER_S))

    def decide(
        self, memory: ContactMemory, q: Array, v: Array, a: Array, plate_wrench: Array
    ) -> ContactDecision:
        """What the feet stand on in one frame.

        Args:
            memory: From the frame before.
            q: (nq,) predicted configuration.
            v: (nv,) predicted velocity.
            a: (nv,) predicted acceleration.
            plate_wrench: (K, 6) force N and moment N m about the world's origin; NaN where not recorded.
        """
        positions = self._soles.positions(q).reshape(2, 3, 3)
        soles = positions.tolist()
        vertical = plate_wrench[:, 2]
        loaded: list[int] = (vertical >= self._least_n).nonzero()[0].tolist()
        latest, foot_of_plate = list(memory.pressed), [-1] * len(vertical)
        for k in loaded:
            point = pressed_at(plate_wrench[k].tolist(), self.surfaces_m[k])
            foot_of_plate[k] = self._owner(k, point, soles, memory.foot_of_plate[k])
            latest[k] = Pressed(*point, foot_of_plate[k])
        wrench, contacts = np.zeros((2, 6)), [Contact.AIR, Contact.AIR]
        for k in loaded:
            owner = foot_of_plate[k]
            for foot in (0, 1) if owner == 2 else (owner,) if owner >= 0 else ():
                wrench[foot] += plate_wrench[k]
                contacts[foot] = Contact.SHARED if owner == 2 else Contact.MEASURED
        height = self._sole_height(memory.sole_height_m, soles, contacts)
        touching = (0.0, 0.0)
        if Contact.AIR in contacts:
            idle = _Idle(vertical < self._least_n, memory.pressed)
            in_air = contacts == [Contact.AIR, Contact.AIR]
            touching = self._touching(memory.touching_s, contacts, soles, (q, v), height, idle)
            carrying = [f for f in (0, 1) if touching[f] > STAND_AFTER_S]
            if not carrying and in_air and not _falls(q, v, a):
                carrying = self._holding(soles, idle)
            for foot in carrying:
                contacts[foot] = Contact.UNMEASURED
        return ContactDecision(
            (contacts[0], contacts[1]),
            wrench,
            0.5 * (positions[:, 0] + positions[:, 2]),
            any(foot_of_plate[k] < 0 for k in loaded),
            ContactMemory(tuple(foot_of_plate), tuple(latest), height, touching),
        )

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

    def _touching(
        self,
        before_s: tuple[float, float],
        contacts: list[Contact],
        soles: Sequence[Sole],
        motion: tuple[Array, Array],
        height: float,
        idle: _Idle,
    ) -> tuple[float, float]:
        """For how long right and left foot have touched the floor where no plate reads, s."""

        def since(f: int) -> float:
            if contacts[f] != Contact.AIR:
                return 0.0
            # A foot that stood must clearly leave the floor.
            slack = LEAVE_SLACK if before_s[f] > STAND_AFTER_S else 1.0
            touches = self._touches(f, soles[f], motion, height, slack)
            stands = touches and not self._watched(f, soles[f], idle)
            return before_s[f] + self._dt_s if stands else 0.0

        return since(0), since(1)

    def _holding(self, soles: Sequence[Sole], idle: _Idle) -> list[int]:
        """The lower foot, or both where they are level: something carries a body that does not fall."""
        if any(self._watched(f, soles[f], idle) for f in (0, 1)):
            return []
        lowest = [_height(sole) for sole in soles]
        return [f for f in (0, 1) if lowest[f] <= min(lowest) + TOUCH_HEIGHT_M]

    def _owner(self, k: int, point: tuple[float, float], soles: Sequence[Sole], before: int) -> int:
        """Foot of plate k with this centre of pressure: 0 right, 1 left, 2 both, -1 none."""
        away = [distance_to_sole(*point, sole) for sole in soles]
        return 2 if self._between(k, soles, away) else nearer_foot(away, before)

    def _between(self, k: int, soles: Sequence[Sole], away: list[float]) -> bool:
        """Whether both feet stand flat on plate k: both soles inside it, the centre of pressure between them."""
        if not self._areas.known[k] or min(away) <= BETWEEN_M:
            return False
        heights = [min(p[2] for p in sole) for sole in soles]
        if abs(heights[0] - heights[1]) >= TOUCH_HEIGHT_M:
            return False
        ends = np.array([end[:2] for sole in soles for end in (sole[0], sole[2])])
        return bool(self._areas.contain(ends)[:, k].all())

    def _sole_height(self, known: float, soles: Sequence[Sole], contacts: list[Contact]) -> float:
        """Height at which the body's loaded soles lie, which may differ from that of the plates by centimetres."""
        loaded = [_height(soles[f]) for f in (0, 1) if contacts[f] == Contact.MEASURED]
        for lowest in loaded:
            known = lowest if isnan(known) else known + FLOOR_SHARE * (lowest - known)
        if isnan(self._floor):  # without plates, the lowest height of a sole so far
            lowest_now = min(_height(sole) for sole in soles)
            known = lowest_now if isnan(known) else min(known, lowest_now)
        return known

    def _touches(
        self, foot: int, sole: Sole, motion: tuple[Array, Array], height: float, slack: float
    ) -> bool:
        """Whether heel or ball is low and slow enough to touch the floor.

        Args:
            foot: 0 right, 1 left.
            sole: Its sole.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            height: Height of loaded soles, NaN before one was loaded.
            slack: Factor on the limits.
        """
        floor = height if not isnan(height) else self._floor
        low = [point for point in sole[:SOLE_ENDS] if point[2] < floor + slack * STAND_HEIGHT_M]
        if not low:
            return False
        q, v = motion
        # The foot's velocity at the world's origin, from which each point's follows.
        vx, vy, vz, wx, wy, wz = (self._model.spatial_jacobian(q) @ (v * self._moves[foot])).tolist()
        speeds = [hypot(vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x) for x, y, z in low]
        return min(speeds) < slack * STAND_SPEED_M_S

    def _watched(self, foot: int, sole: Sole, idle: _Idle) -> bool:
        """Whether an unloaded plate lies under a foot, so that the foot carries nothing.

        The place of a plate without an outline is where its foot last pressed it.
        """
        middle = np.array([[(sole[0][i] + sole[2][i]) / 2 for i in (0, 1)]])
        if (self._areas.contain(middle)[0] & idle.plates).any():
            return True
        for k in (idle.plates & ~self._areas.known).nonzero()[0].tolist():
            pressed = idle.pressed[k]
            if pressed is None or pressed.owner != foot:
                continue
            if distance_to_sole(pressed.x, pressed.y, sole) <= REACH_M:
                return True
        return False


class _Idle(NamedTuple):
    """Plates (K,) that are recorded and not loaded, and where all were pressed last."""

    plates: BoolArray
    pressed: tuple[Pressed | None, ...]


def _height(sole: Sole) -> float:
    """Height of the lower one of heel and ball, m."""
    heel, ball, _ = sole
    return min(heel[2], ball[2])


def _falls(q: Array, v: Array, a: Array) -> bool:
    """Whether the pelvis falls faster than a supported body: its vertical acceleration is that of a + ω × v."""
    x, y, z, w = q[3:7].tolist()
    vx, vy, vz, wx, wy, wz = v[:6].tolist()
    ax, ay, az = a[:3].tolist()
    up = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    rise = (ax + wy * vz - wz * vy, ay + wz * vx - wx * vz, az + wx * vy - wy * vx)
    return sum(u * r for u, r in zip(up, rise, strict=True)) < FALL_M_S2
