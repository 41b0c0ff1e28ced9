"""Feet that carry weight where no plate reads: low and slow, long enough, and over no unloaded plate.

In the air a body falls. Where both feet are in the air and it does not fall, something carries its lower foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple

from mbkf.conventions import Array
from mbkf.sensors.contact.feet import FeetMotion
from mbkf.sensors.contact.floor import Movement
from mbkf.sensors.contact.plates import PlateAreas
from mbkf.sensors.contact.records import Contact, ContactMemory, Pressed
from mbkf.sensors.contact.rules import (
    BOTH,
    FLOOR_SHARE,
    LEFT,
    REACH_M,
    RIGHT,
    SOLE_ENDS,
    STAND_AFTER_S,
    STANDING,
    STANDING_ALONE,
    Touch,
    falls,
    lower_feet,
)
from mbkf.sensors.contact.soles import Sole, distance_to_sole

_FEET = (RIGHT, LEFT)


class Elsewhere(NamedTuple):
    """Feet (0 right, 1 left) that carry weight where no plate reads, and state for the next frame.

    Attributes:
        carrying: The feet.
        sole_height_m: Height at which the body's loaded soles lie, NaN before one was loaded.
        touching_s: Duration for which right and left foot have touched the floor without a reading.
        movement: The last frames of the body's movement.
        floor_m_s: Horizontal velocity of the floor.
        near: Nearness, 0 to 1, of right and left foot in the air to touching a floor that no plate reads.
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
        """Feet that carry weight although no plate reads them.

        Args:
            memory: From the frame before.
            motion: Predicted (nq,) configuration, (nv,) velocity and acceleration.
            feet: The feet at these.
            contacts: Contact of right and left foot by the plates.
            unloaded: Plates that are recorded and not loaded.
            silent: Plates that are not recorded. A foot that one of them carried stands on, without a delay.
            supported: True where another part than the feet carries load, so that these need not.
        """
        height = self._sole_height(memory.sole_height_m, feet.soles, contacts)
        floor_m = self._floor if isnan(height) else height
        movement = self._movement(memory.movement, feet, floor_m)
        moves = movement.floor_m_s(self._dt_s)
        if Contact.AIR not in contacts:
            return Elsewhere((), height, (0.0, 0.0), movement._replace(airborne=0), moves)
        floor = _Floor(floor_m, moves)
        idle = _Idle(unloaded, memory.pressed, moves != (0.0, 0.0))
        may_bear = [f for f in _FEET if contacts[f] == Contact.AIR and not self._watched(f, feet, idle)]
        touching = self._touching(self._touched_s(memory, silent), may_bear, feet, floor)
        carrying = [f for f in may_bear if touching[f] > STAND_AFTER_S]
        in_air = contacts[RIGHT] == contacts[LEFT] == Contact.AIR and not supported
        if not carrying and in_air:
            if len(unloaded) + len(silent) == len(memory.pressed):
                carrying = self._alone(may_bear, feet, floor, idle)
            falling = falls(_acceleration(*motion)) and not movement.held_up(self._dt_s)
            if not carrying and len(may_bear) == 2 and not falling:
                carrying = lower_feet([_height(sole) for sole in feet.soles])
        flies = in_air and not carrying
        limits = STANDING_ALONE if flies and not unloaded else STANDING
        right, left = (
            _near(f, feet, floor, limits) if f in may_bear and f not in carrying else 0.0 for f in _FEET
        )
        movement = movement._replace(airborne=movement.airborne + 1 if flies else 0)
        return Elsewhere(carrying, height, touching, movement, moves, (right, left))

    def _movement(self, before: Movement, feet: FeetMotion, floor_m: float) -> Movement:
        """Movement up to this frame; the height of the floor is NaN where not known."""
        ends = [(f, point) for f in _FEET for point in feet.soles[f][:SOLE_ENDS]]
        foot, point = min(ends, key=lambda end: end[1][2])
        low = feet.velocity(foot, point)[:2] if point[2] < floor_m + STANDING.height_m else (nan, nan)
        return before.with_frame(low, feet.pelvis_m, self._dt_s)

    def _touched_s(self, memory: ContactMemory, silent: Sequence[int]) -> tuple[float, float]:
        """Durations for which the feet have touched the floor; long enough for a foot whose plate falls silent."""
        owners = [memory.foot_of_plate[k] for k in silent]
        carried = STAND_AFTER_S + self._dt_s
        right, left = (carried if f in owners or BOTH in owners else memory.touching_s[f] for f in _FEET)
        return right, left

    def _touching(
        self, before_s: tuple[float, float], may_bear: Sequence[int], feet: FeetMotion, floor: _Floor
    ) -> tuple[float, float]:
        """Duration for which right and left foot have touched the floor where no plate reads, s."""

        def since(f: int) -> float:
            if f not in may_bear or not feet.facing_down[f]:
                return 0.0
            # A foot that stood must clearly leave the floor.
            limits = STANDING.relaxed() if before_s[f] > STAND_AFTER_S else STANDING
            return before_s[f] + self._dt_s if _touches(f, feet, floor, limits) else 0.0

        return since(RIGHT), since(LEFT)

    def _alone(self, may_bear: Sequence[int], feet: FeetMotion, floor: _Floor, idle: _Idle) -> list[int]:
        """Feet low enough to land or to push off, where nothing else carries the body.

        A plate without an outline may lie under any foot, unless the other foot pressed it last.
        """
        lowest = min((h for h in (floor.height_m, self._floor) if not isnan(h)), default=nan)
        latest = [idle.pressed[k] for k in idle.plates if not self._areas.known[k]]
        return [
            f
            for f in may_bear
            if _touches(f, feet, floor._replace(height_m=lowest), STANDING_ALONE)
            and all(place is not None and place.owner == 1 - f for place in latest)
        ]

    def _sole_height(self, known: float, soles: Sequence[Sole], contacts: Sequence[Contact]) -> float:
        """Height at which the body's loaded soles lie, which may differ from that of the plates by centimetres."""
        loaded = [_height(soles[f]) for f in _FEET if contacts[f] == Contact.MEASURED]
        for lowest in loaded:
            known = lowest if isnan(known) else known + FLOOR_SHARE * (lowest - known)
        if isnan(self._floor):  # without plates, the lowest height of a sole so far
            lowest_now = min(_height(sole) for sole in soles)
            known = lowest_now if isnan(known) else min(known, lowest_now)
        return known

    def _watched(self, foot: int, feet: FeetMotion, idle: _Idle) -> bool:
        """True where an unloaded plate lies under a foot, which then carries nothing.

        The place of a plate without an outline is where its foot last pressed it.
        """
        sole = feet.soles[foot]
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
    """Height (NaN where not known) and horizontal velocity of the floor."""

    height_m: float
    velocity_m_s: tuple[float, float]


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


def _touches(foot: int, feet: FeetMotion, floor: _Floor, limits: Touch) -> bool:
    """True where heel or ball of a foot touches the floor."""
    return any(
        limits.holds(point[2], floor.height_m, feet.speed(foot, point, floor.velocity_m_s))
        for point in feet.soles[foot][:SOLE_ENDS]
    )


def _near(foot: int, feet: FeetMotion, floor: _Floor, limits: Touch) -> float:
    """Nearness of a foot to touching the floor, 0 to 1; 0 for a floor of unknown height."""
    if isnan(floor.height_m):
        return 0.0
    return max(
        limits.nearness(point[2], floor.height_m, feet.speed(foot, point, floor.velocity_m_s))
        for point in feet.soles[foot]
    )


def _acceleration(q: Array, v: Array, a: Array) -> float:
    """Vertical acceleration of the pelvis, m/s²: that of a + ω × v in its axes."""
    x, y, z, w = q[3:7].tolist()
    vx, vy, vz, wx, wy, wz = v[:6].tolist()
    ax, ay, az = a[:3].tolist()
    up = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    rise = (ax + wy * vz - wz * vy, ay + wz * vx - wx * vz, az + wx * vy - wy * vx)
    return sum(u * r for u, r in zip(up, rise, strict=True))
