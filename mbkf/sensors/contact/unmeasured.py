"""Feet that carry weight where no plate reads: low and slow, long enough, and over no unloaded plate.

In the air a body falls. Where both feet are in the air and it does not fall, something carries its lower foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, hypot, isnan, nan
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.sensors.contact.floor import Movement
from mbkf.sensors.contact.plates import PlateAreas
from mbkf.sensors.contact.records import Contact, ContactMemory, Pressed
from mbkf.sensors.contact.soles import Sole, distance_to_sole, soles_down
from mbkf.sensors.contact.thresholds import (
    ALONE_HEIGHT_M,
    ALONE_SPEED_M_S,
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
        movement: The last frames of the body's movement.
        floor_m_s: Horizontal velocity of the floor.
        near: How near right and left foot in the air are to touching a floor that no plate reads, 0 to 1.
    """

    carrying: Sequence[int]
    sole_height_m: float
    touching_s: tuple[float, float]
    movement: Movement
    floor_m_s: tuple[float, float]
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
        supported: bool = False,
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
            supported: Whether another part than the feet bears, so that these need not.
        """
        q, v, a = motion
        height = self._sole_height(memory.sole_height_m, soles, contacts)
        movement = self._movement(memory.movement, soles, (q, v), height)
        moves = movement.floor_m_s(self._dt_s)
        if Contact.AIR not in contacts:
            return Elsewhere((), height, (0.0, 0.0), movement._replace(airborne=0), moves)
        floor = _Floor(height if not isnan(height) else self._floor, *moves)
        idle = _Idle(unloaded, memory.pressed, moves != (0.0, 0.0))
        before_s = memory.touching_s
        if silent is not None and silent.any():
            before_s = self._carried_on(memory, silent)
        touching = self._touching(before_s, contacts, soles, (q, v), floor, idle)
        carrying = [f for f in (0, 1) if touching[f] > STAND_AFTER_S]
        in_air = contacts[0] == contacts[1] == Contact.AIR and not supported
        quiet = unloaded if silent is None else unloaded | silent
        if not carrying and in_air and quiet.all():
            lowest = floor._replace(height=np.fmin(floor.height, self._floor))
            carrying = self._alone(soles, (q, v), lowest, idle)
        falls = _falls(q, v, a) and not movement.held_up(self._dt_s)
        if not carrying and in_air and not falls:
            carrying = self._holding(soles, idle)
        movement = movement._replace(airborne=movement.airborne + 1 if in_air and not carrying else 0)
        alone = in_air and not carrying and not unloaded.any()
        limits = (ALONE_HEIGHT_M, ALONE_SPEED_M_S) if alone else (STAND_HEIGHT_M, STAND_SPEED_M_S)
        near = [
            0.0
            if f in carrying or contacts[f] != Contact.AIR or self._watched(f, soles[f], idle)
            else self._near(f, soles[f], (q, v), floor, limits)
            for f in (0, 1)
        ]
        return Elsewhere(carrying, height, touching, movement, moves, (near[0], near[1]))

    def _movement(
        self, before: Movement, soles: Sequence[Sole], motion: tuple[Array, Array], height: float
    ) -> Movement:
        """The movement up to this frame.

        Args:
            before: That of the frame before.
            soles: Heel, ball and toe end of both soles.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            height: Height of loaded soles, NaN before one was loaded.
        """
        floor = height if not isnan(height) else self._floor
        foot = min((0, 1), key=lambda f: _height(soles[f]))
        point = min(soles[foot][:SOLE_ENDS], key=lambda end: end[2])
        low = (nan, nan)
        if point[2] < floor + STAND_HEIGHT_M:
            x, y, _ = self._velocities(foot, [point], motion)[0]
            low = (x, y)
        return before.with_frame(low, motion[0][:3], self._dt_s)

    def _near(
        self,
        foot: int,
        sole: Sole,
        motion: tuple[Array, Array],
        floor: _Floor,
        limits: tuple[float, float],
    ) -> float:
        """How near a foot is to touching the floor, 0 to 1: low and slow, as Gaussians of limits.

        Args:
            foot: 0 right, 1 left.
            sole: Its sole.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            floor: The floor.
            limits: Of height, m, and speed, m/s.
        """
        if isnan(floor.height):
            return 0.0
        speeds = self._speeds(foot, sole, motion, floor)
        away = [
            (max(point[2] - floor.height, 0.0) / limits[0]) ** 2 + (speed / limits[1]) ** 2
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
        floor: _Floor,
        idle: _Idle,
    ) -> tuple[float, float]:
        """For how long right and left foot have touched the floor where no plate reads, s.

        Args:
            before_s: The same in the frame before.
            contacts: What right and left foot stand on by the plates.
            soles: Heel, ball and toe end of both soles.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            floor: The floor.
            idle: Plates that read nothing.
        """
        down = soles_down(self._model, motion[0])

        def since(f: int) -> float:
            if contacts[f] != Contact.AIR or not down[f]:
                return 0.0
            # A foot that stood must clearly leave the floor.
            slack = LEAVE_SLACK if before_s[f] > STAND_AFTER_S else 1.0
            limits = slack * STAND_HEIGHT_M, slack * STAND_SPEED_M_S
            touches = self._touches(f, soles[f], motion, floor, limits)
            stands = touches and not self._watched(f, soles[f], idle)
            return before_s[f] + self._dt_s if stands else 0.0

        return since(0), since(1)

    def _alone(
        self, soles: Sequence[Sole], motion: tuple[Array, Array], floor: _Floor, idle: _Idle
    ) -> list[int]:
        """Feet low enough to land or to push off, where nothing else carries the body.

        A plate without an outline may lie under any foot but one that another foot pressed.

        Args:
            soles: Heel, ball and toe end of both soles.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            floor: The floor.
            idle: Plates that read nothing.
        """
        limits = ALONE_HEIGHT_M, ALONE_SPEED_M_S
        latest = [idle.pressed[k] for k in (idle.plates & ~self._areas.known).nonzero()[0].tolist()]
        return [
            f
            for f in (0, 1)
            if self._touches(f, soles[f], motion, floor, limits)
            and not self._watched(f, soles[f], idle)
            and all(place is not None and place.owner == 1 - f for place in latest)
        ]

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
        self, foot: int, sole: Sole, motion: tuple[Array, Array], floor: _Floor, limits: tuple[float, float]
    ) -> bool:
        """Whether heel or ball is low and slow enough to touch the floor.

        Args:
            foot: 0 right, 1 left.
            sole: Its sole.
            motion: Predicted (nq,) configuration and (nv,) velocity.
            floor: The floor.
            limits: Of height, m, and speed, m/s.
        """
        height, speed = limits
        low = [point for point in sole[:SOLE_ENDS] if point[2] < floor.height + height]
        return bool(low) and min(self._speeds(foot, low, motion, floor)) < speed

    def _speeds(self, foot: int, points: Sole, motion: tuple[Array, Array], floor: _Floor) -> list[float]:
        """Speeds against the floor of world points that move with a foot."""
        return [hypot(x - floor.vx, y - floor.vy, z) for x, y, z in self._velocities(foot, points, motion)]

    def _velocities(
        self, foot: int, points: Sole, motion: tuple[Array, Array]
    ) -> list[tuple[float, float, float]]:
        """Velocities of world points that move with a foot."""
        q, v = motion
        # The foot's velocity at the world's origin, from which each point's follows.
        vx, vy, vz, wx, wy, wz = (self._model.spatial_jacobian(q) @ (v * self._moves[foot])).tolist()
        return [(vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x) for x, y, z in points]

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
            if idle.belt or distance_to_sole(pressed.x, pressed.y, sole) <= REACH_M:
                return True
        return False


class _Floor(NamedTuple):
    """Height (NaN where not known) and horizontal velocity of the floor, m and m/s."""

    height: float
    vx: float
    vy: float


class _Idle(NamedTuple):
    """Plates (K,) that are recorded and not loaded, where all were pressed last, and whether they are belts.

    A belt lies under its foot wherever that steps.
    """

    plates: BoolArray
    pressed: tuple[Pressed | None, ...]
    belt: bool


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
