"""Feet that carry weight where no plate reads: low and slow, long enough, and over no unloaded plate.

In the air a body falls. Where both feet are in the air and it does not fall, something carries its lower foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, hypot, isnan
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.sensors.contact.plates import PlateAreas
from mbkf.sensors.contact.records import Contact, ContactMemory, Pressed
from mbkf.sensors.contact.soles import Sole, distance_to_sole
from mbkf.sensors.contact.thresholds import (
    FALL_M_S2,
    FLOOR_SHARE,
    LEAVE_SLACK,
    REACH_M,
    SOLE_ENDS,
    STAND_AFTER_S,
    STAND_HEIGHT_M,
    STAND_SPEED_M_S,
    TOUCH_HEIGHT_M,
)


class Elsewhere(NamedTuple):
    """Feet (0 right, 1 left) that carry weight where no plate reads, and what the next frame needs.

    Attributes:
        carrying: The feet.
        sole_height_m: Height at which the body's loaded soles lie, NaN before one was loaded.
        touching_s: For how long right and left foot have touched the floor without a reading.
        near: How near right and left foot in the air are to touching a floor that no plate reads, 0 to 1.
    """

    carrying: Sequence[int]
    sole_height_m: float
    touching_s: tuple[float, float]
    near: tuple[float, float] = (0.0, 0.0)


class UnmeasuredFeet:
    """Finds feet that carry weight where no plate reads."""

    def __init__(self, model: Body, areas: PlateAreas, floor_m: float, dt_s: float) -> None:
        """Makes the detector.

        Args:
            model: The body.
            areas: Outlines of the plates.
            floor_m: Height of the lowest plate; NaN without plates.
            dt_s: Time between frames.
        """
        self._model, self._areas, self._floor, self._dt_s = model, areas, floor_m, dt_s
        self._moves = [
            model.supports[model.joint(segment).joint_id].astype(float) for segment in model.roles.feet
        ]

    def decide(
        self,
        memory: ContactMemory,
        motion: tuple[Array, Array, Array],
        soles: Sequence[Sole],
        contacts: Sequence[Contact],
        unloaded: BoolArray,
        silent: BoolArray | None = None,
    ) -> Elsewhere:
        """Which feet that no plate reads carry weight.

        Args:
            memory: From the frame before.
            motion: Predicted (nq,) configuration, (nv,) velocity and acceleration.
            soles: Heel, ball and toe end of both soles.
            contacts: What right and left foot stand on by the plates.
            unloaded: (K,) plates that are recorded and not loaded.
            silent: (K,) plates that are not recorded, None where all are. A foot that one of them carried stands on,
                without a delay.
        """
        q, v, a = motion
        height = self._sole_height(memory.sole_height_m, soles, contacts)
        if Contact.AIR not in contacts:
            return Elsewhere((), height, (0.0, 0.0))
        idle = _Idle(unloaded, memory.pressed)
        before_s = memory.touching_s
        if silent is not None and silent.any():
            before_s = self._carried_on(memory, silent)
        touching = self._touching(before_s, contacts, soles, (q, v), height, idle)
        carrying = [f for f in (0, 1) if touching[f] > STAND_AFTER_S]
        in_air = contacts[0] == contacts[1] == Contact.AIR
        if not carrying and in_air and not _falls(q, v, a):
            carrying = self._holding(soles, idle)
        near = [
            0.0
            if f in carrying or contacts[f] != Contact.AIR or self._watched(f, soles[f], idle)
            else self._near(f, soles[f], (q, v), height)
            for f in (0, 1)
        ]
        return Elsewhere(carrying, height, touching, (near[0], near[1]))

    def _near(self, foot: int, sole: Sole, motion: tuple[Array, Array], height: float) -> float:
        """How near a foot is to touching the floor, 0 to 1: low and slow, as Gaussians of the limits of standing."""
        floor = height if not isnan(height) else self._floor
        if isnan(floor):
            return 0.0
        speeds = self._speeds(foot, sole, motion)
        away = [
            (max(point[2] - floor, 0.0) / STAND_HEIGHT_M) ** 2 + (speed / STAND_SPEED_M_S) ** 2
            for point, speed in zip(sole, speeds, strict=True)
        ]
        return exp(-0.5 * min(away))

    def _carried_on(self, memory: ContactMemory, silent: BoolArray) -> tuple[float, float]:
        """For how long the feet have touched the floor; a foot whose plate has just fallen silent, long enough."""
        owners = [memory.foot_of_plate[k] for k in silent.nonzero()[0].tolist()]

        def before(f: int) -> float:
            carried = f in owners or 2 in owners
            return STAND_AFTER_S + self._dt_s if carried else memory.touching_s[f]

        return before(0), before(1)

    def _touching(
        self,
        before_s: tuple[float, float],
        contacts: Sequence[Contact],
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

    def _sole_height(self, known: float, soles: Sequence[Sole], contacts: Sequence[Contact]) -> float:
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
        return min(self._speeds(foot, low, motion)) < slack * STAND_SPEED_M_S

    def _speeds(self, foot: int, points: Sole, motion: tuple[Array, Array]) -> list[float]:
        """Speeds of world points that move with a foot."""
        q, v = motion
        # The foot's velocity at the world's origin, from which each point's follows.
        vx, vy, vz, wx, wy, wz = (self._model.spatial_jacobian(q) @ (v * self._moves[foot])).tolist()
        return [hypot(vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x) for x, y, z in points]

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
