"""Feet that carry weight where no plate reads: low and slow, long enough, and over no unloaded plate.

In the air a body falls. Where both feet are in the air and it does not fall, something carries its lower foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, isnan, nan
from typing import NamedTuple

from mbkf.conventions import Array
from mbkf.sensors.contact.feet import FeetMotion
from mbkf.sensors.contact.floor import Movement
from mbkf.sensors.contact.plates import PlateAreas
from mbkf.sensors.contact.records import Contact, ContactMemory, Pressed
from mbkf.sensors.contact.soles import Sole, distance_to_sole
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

    def __init__(self, areas: PlateAreas, floor_m: float, dt_s: float) -> None:
        """Makes the detector.

        Args:
            areas: Outlines of the plates.
            floor_m: Height of the lowest plate; NaN without plates.
            dt_s: Time between frames.
        """
        self._areas, self._floor, self._dt_s = areas, floor_m, dt_s

    def decide(
        self,
        memory: ContactMemory,
        motion: tuple[Array, Array, Array],
        feet: FeetMotion,
        contacts: Sequence[Contact],
        unloaded: Sequence[int],
        silent: Sequence[int] = (),
        supported: bool = False,
    ) -> Elsewhere:
        """Which feet that no plate reads carry weight.

        Args:
            memory: From the frame before.
            motion: Predicted (nq,) configuration, (nv,) velocity and acceleration.
            feet: The feet at these.
            contacts: What right and left foot stand on by the plates.
            unloaded: Plates that are recorded and not loaded.
            silent: Plates that are not recorded. A foot that one of them carried stands on, without a delay.
            supported: Whether another part than the feet bears, so that these need not.
        """
        height = self._sole_height(memory.sole_height_m, feet.soles, contacts)
        movement = self._movement(memory.movement, feet, height)
        moves = movement.floor_m_s(self._dt_s)
        if Contact.AIR not in contacts:
            return Elsewhere((), height, (0.0, 0.0), movement._replace(airborne=0), moves)
        floor = _Floor(height if not isnan(height) else self._floor, moves)
        idle = _Idle(unloaded, memory.pressed, moves != (0.0, 0.0))
        watched = [contacts[f] == Contact.AIR and self._watched(f, feet.soles[f], idle) for f in (0, 1)]
        may_bear = [f for f in (0, 1) if contacts[f] == Contact.AIR and not watched[f]]
        before_s = self._carried_on(memory, silent) if silent else memory.touching_s
        touching = self._touching(before_s, may_bear, feet, floor)
        carrying = [f for f in may_bear if touching[f] > STAND_AFTER_S]
        in_air = contacts[0] == contacts[1] == Contact.AIR and not supported
        if not carrying and in_air:
            if len(unloaded) + len(silent) == len(memory.pressed):
                carrying = self._alone(may_bear, feet, floor, idle)
            if not carrying and len(may_bear) == 2 and not self._falls(motion, movement):
                carrying = _lower(feet.soles)
        movement = movement._replace(airborne=movement.airborne + 1 if in_air and not carrying else 0)
        alone = in_air and not carrying and not unloaded
        limits = (ALONE_HEIGHT_M, ALONE_SPEED_M_S) if alone else (STAND_HEIGHT_M, STAND_SPEED_M_S)
        right, left = (
            _near(f, feet, floor, limits) if f in may_bear and f not in carrying else 0.0 for f in (0, 1)
        )
        return Elsewhere(carrying, height, touching, movement, moves, (right, left))

    def _movement(self, before: Movement, feet: FeetMotion, height: float) -> Movement:
        """The movement up to this frame.

        Args:
            before: That of the frame before.
            feet: The feet.
            height: Height of loaded soles, NaN before one was loaded.
        """
        floor = height if not isnan(height) else self._floor
        ends = [(f, point) for f in (0, 1) for point in feet.soles[f][:SOLE_ENDS]]
        foot, point = min(ends, key=lambda end: end[1][2])
        low = feet.velocity(foot, point)[:2] if point[2] < floor + STAND_HEIGHT_M else (nan, nan)
        return before.with_frame(low, feet.pelvis_m, self._dt_s)

    def _falls(self, motion: tuple[Array, Array, Array], movement: Movement) -> bool:
        """Whether the body is predicted to fall, and was not seen to be held up."""
        return _falls(*motion) and not movement.held_up(self._dt_s)

    def _carried_on(self, memory: ContactMemory, silent: Sequence[int]) -> tuple[float, float]:
        """For how long the feet have touched the floor; a foot whose plate has just fallen silent, long enough."""
        owners = [memory.foot_of_plate[k] for k in silent]

        def before(f: int) -> float:
            carried = f in owners or 2 in owners
            return STAND_AFTER_S + self._dt_s if carried else memory.touching_s[f]

        return before(0), before(1)

    def _touching(
        self, before_s: tuple[float, float], may_bear: Sequence[int], feet: FeetMotion, floor: _Floor
    ) -> tuple[float, float]:
        """For how long right and left foot have touched the floor where no plate reads, s.

        Args:
            before_s: The same in the frame before.
            may_bear: Feet that no plate reads, and under which none reads nothing.
            feet: The feet.
            floor: The floor.
        """

        def since(f: int) -> float:
            if f not in may_bear or not feet.facing_down[f]:
                return 0.0
            # A foot that stood must clearly leave the floor.
            slack = LEAVE_SLACK if before_s[f] > STAND_AFTER_S else 1.0
            touches = _touches(f, feet, floor, (slack * STAND_HEIGHT_M, slack * STAND_SPEED_M_S))
            return before_s[f] + self._dt_s if touches else 0.0

        return since(0), since(1)

    def _alone(self, may_bear: Sequence[int], feet: FeetMotion, floor: _Floor, idle: _Idle) -> list[int]:
        """Feet low enough to land or to push off, where nothing else carries the body.

        A plate without an outline may lie under any foot but one that another foot pressed.

        Args:
            may_bear: Feet that no plate reads, and under which none reads nothing.
            feet: The feet.
            floor: The floor.
            idle: Plates that read nothing.
        """
        lowest = floor._replace(
            height=min((h for h in (floor.height, self._floor) if not isnan(h)), default=nan)
        )
        latest = [idle.pressed[k] for k in idle.plates if not self._areas.known[k]]
        return [
            f
            for f in may_bear
            if _touches(f, feet, lowest, (ALONE_HEIGHT_M, ALONE_SPEED_M_S))
            and all(place is not None and place.owner == 1 - f for place in latest)
        ]

    def _sole_height(self, known: float, soles: Sequence[Sole], contacts: Sequence[Contact]) -> float:
        """Height at which the body's loaded soles lie, which may differ from that of the plates by centimetres."""
        loaded = [_height(soles[f]) for f in (0, 1) if contacts[f] == Contact.MEASURED]
        for lowest in loaded:
            known = lowest if isnan(known) else known + FLOOR_SHARE * (lowest - known)
        if isnan(self._floor):  # without plates, the lowest height of a sole so far
            lowest_now = min(_height(sole) for sole in soles)
            known = lowest_now if isnan(known) else min(known, lowest_now)
        return known

    def _watched(self, foot: int, sole: Sole, idle: _Idle) -> bool:
        """Whether an unloaded plate lies under a foot, so that the foot carries nothing.

        The place of a plate without an outline is where its foot last pressed it.
        """
        x, y = (0.5 * (sole[0][i] + sole[2][i]) for i in (0, 1))
        if any(self._areas.over(k, x, y) for k in idle.plates):
            return True
        for k in idle.plates:
            pressed = idle.pressed[k]
            if self._areas.known[k] or pressed is None or pressed.owner != foot:
                continue
            if idle.belt or distance_to_sole(pressed.x, pressed.y, sole) <= REACH_M:
                return True
        return False


class _Floor(NamedTuple):
    """Height (NaN where not known) and horizontal velocity of the floor, m and m/s."""

    height: float
    velocity: tuple[float, float]


class _Idle(NamedTuple):
    """Plates that are recorded and not loaded, where all were pressed last, and whether they are belts.

    A belt lies under its foot wherever that steps.
    """

    plates: Sequence[int]
    pressed: tuple[Pressed | None, ...]
    belt: bool


def _height(sole: Sole) -> float:
    """Height of the lower one of heel and ball, m."""
    heel, ball, _ = sole
    return min(heel[2], ball[2])


def _lower(soles: Sequence[Sole]) -> list[int]:
    """The lower foot, or both where they are level: something carries a body that does not fall."""
    lowest = [_height(sole) for sole in soles]
    return [f for f in (0, 1) if lowest[f] <= min(lowest) + TOUCH_HEIGHT_M]


def _touches(foot: int, feet: FeetMotion, floor: _Floor, limits: tuple[float, float]) -> bool:
    """Whether heel or ball is low and slow enough to touch the floor.

    Args:
        foot: 0 right, 1 left.
        feet: The feet.
        floor: The floor.
        limits: Of height, m, and speed, m/s.
    """
    height, speed = limits
    low = [point for point in feet.soles[foot][:SOLE_ENDS] if point[2] < floor.height + height]
    return any(feet.speed(foot, point, floor.velocity) < speed for point in low)


def _near(foot: int, feet: FeetMotion, floor: _Floor, limits: tuple[float, float]) -> float:
    """How near a foot is to touching the floor, 0 to 1: low and slow, as Gaussians of limits.

    Args:
        foot: 0 right, 1 left.
        feet: The feet.
        floor: The floor.
        limits: Of height, m, and speed, m/s.
    """
    if isnan(floor.height):
        return 0.0
    height, speed = limits
    away = [
        (max(point[2] - floor.height, 0.0) / height) ** 2
        + (feet.speed(foot, point, floor.velocity) / speed) ** 2
        for point in feet.soles[foot]
    ]
    return exp(-0.5 * min(away))


def _falls(q: Array, v: Array, a: Array) -> bool:
    """Whether the pelvis falls faster than a supported body: its vertical acceleration is that of a + ω × v."""
    x, y, z, w = q[3:7].tolist()
    vx, vy, vz, wx, wy, wz = v[:6].tolist()
    ax, ay, az = a[:3].tolist()
    up = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    rise = (ax + wy * vz - wz * vy, ay + wz * vx - wx * vz, az + wx * vy - wy * vx)
    return sum(u * r for u, r in zip(up, rise, strict=True)) < FALL_M_S2
