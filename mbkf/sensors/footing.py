"""What each foot stands on, decided frame by frame as a live filter must (SPEC S8, DESIGN §4 fact 6).

A foot is *measured* when a loaded plate's centre of pressure lies under it, *free* when it touches the floor where no
plate reads (its wrench is then unknown, not zero), and otherwise in the *air*. Two feet on one plate *share* it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import hypot, isnan
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import FEET
from mbkf.sensors.contacts import FALL_SHARE, REACH_M, TOUCH_HEIGHT_M, sole_locals, surface_height
from mbkf.sensors.markers import MarkerSensor
from mbkf.sensors.planted import Planted

KEEP_M = 0.04
"""A plate stays with its foot until the other one is nearer by this."""

BETWEEN_M = 0.02
"""A centre of pressure nearer to a sole than this is that foot's, and not between two."""

LEAVE_SLACK = 1.7
"""A standing foot has left the floor when it is higher or faster than the above times this."""

TOES = ("right_toes", "left_toes")

SOLE_ENDS = 2
"""Points of a sole that tell its height: heel and ball; its toe end dips below the floor when the toes bend."""

STAND_HEIGHT_M = 0.045
STAND_SPEED_M_S = 0.8
STAND_AFTER_S = 0.025
"""A foot lower and slower than this for that long carries, unless a plate below it says no. Landing heels are pitched,
so that they touch a little above a flat sole; the delay lets a plate speak first."""

FLAT_FROM, FLAT_TO = 0.1, 0.6
"""A foot whose load lies between these shares of its sole, from heel to toe end, lies flat."""

FLOOR_SHARE = 0.1
"""How fast the height of the floor under a loaded foot is learnt, per frame."""


class Footing(IntEnum):
    """What a foot stands on."""

    FREE = -1
    AIR = 0
    MEASURED = 1
    SHARED = 2


class Pressed(NamedTuple):
    """A centre of pressure (world x, y in m) and its foot (0 right, 1 left, 2 both, -1 nobody)."""

    x: float
    y: float
    owner: int


@dataclass(frozen=True)
class FootingMemory:
    """What a decision remembers from the frame before.

    Attributes:
        foot_of_plate: (K,) 0 right, 1 left, 2 both, -1 nobody.
        pressed: (K,) last centre of pressure on each plate and the foot it belonged to, or None.
        sole_height_m: Height of a loaded sole point of our body, NaN before one was loaded.
        touching_s: For how long right and left foot have touched the floor without a reading.
    """

    foot_of_plate: tuple[int, ...]
    pressed: tuple[Pressed | None, ...]
    sole_height_m: float
    touching_s: tuple[float, float]


@dataclass(frozen=True)
class FootLoad:
    """A frame's decision.

    Attributes:
        footing: What right and left foot stand on.
        wrench: (2, 6) measured wrench per foot about the world's origin (of both together where shared).
        centres_m: (2, 3) middle of right and left sole.
        stray: Whether a loaded plate belongs to no foot.
        memory: For the next frame.
    """

    footing: tuple[Footing, Footing]
    wrench: Array
    centres_m: Array
    stray: bool
    memory: FootingMemory


class FootingSensor:
    """Sorts plates to feet and finds feet that stand elsewhere.

    Attributes:
        surfaces_m: Height of each plate.
    """

    def __init__(self, model: HumanModel, plates: Sequence[PlateReadings], dt_s: float) -> None:
        self._dt_s = dt_s
        self._thresholds = np.array([plate.threshold_n for plate in plates])
        self.surfaces_m = [surface_height(plate) for plate in plates]
        self._areas = _Areas(plates)
        self._model, self._soles = model, MarkerSensor(model, *sole_locals(model))
        self._moves = [model.supports[model.joint(segment).joint_id].astype(float) for segment in FEET]
        self._floor = min(self.surfaces_m, default=np.nan)

    def begin(self) -> FootingMemory:
        """Memory before the first frame."""
        plates = len(self.surfaces_m)
        return FootingMemory((-1,) * plates, (None,) * plates, float("nan"), (STAND_AFTER_S, STAND_AFTER_S))

    def decide(self, memory: FootingMemory, q: Array, v: Array, a: Array, plate_wrench: Array) -> FootLoad:
        """What the feet stand on.

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
        loaded: list[int] = (vertical > self._thresholds).nonzero()[0].tolist()
        latest, foot_of_plate = list(memory.pressed), [-1] * len(vertical)
        for k in loaded:
            point = self._pressure(k, plate_wrench[k].tolist())
            foot_of_plate[k] = self._owner(k, point, soles, memory.foot_of_plate[k])
            latest[k] = Pressed(*point, foot_of_plate[k])
        wrench, footing = np.zeros((2, 6)), [Footing.AIR, Footing.AIR]
        for k in loaded:
            owner = foot_of_plate[k]
            for foot in (0, 1) if owner == 2 else (owner,) if owner >= 0 else ():
                wrench[foot] += plate_wrench[k]
                footing[foot] = Footing.SHARED if owner == 2 else Footing.MEASURED
        height = self._sole_height(memory.sole_height_m, soles, footing)
        touching = (0.0, 0.0)
        if Footing.AIR in footing:
            idle = _Idle(vertical <= self._thresholds, memory.pressed)
            in_air = footing == [Footing.AIR, Footing.AIR]
            touching = self._touching(memory.touching_s, footing, soles, (q, v), height, idle)
            carrying = [f for f in (0, 1) if touching[f] > STAND_AFTER_S]
            if not carrying and in_air and not _falls(q, v, a):
                carrying = self._holding(soles, idle)
            for foot in carrying:
                footing[foot] = Footing.FREE
        return FootLoad(
            (footing[0], footing[1]),
            wrench,
            0.5 * (positions[:, 0] + positions[:, 2]),
            any(foot_of_plate[k] < 0 for k in loaded),
            FootingMemory(tuple(foot_of_plate), tuple(latest), height, touching),
        )

    def planted(self, load: FootLoad, q: Array, foot: int) -> Planted | None:
        """The point on which a foot of that frame's decision stands still, or None for one that carries nothing.

        Flat is a foot loaded between heel and ball, behind that it rolls; loaded before the ball it stands on its toes.

        Args:
            load: The decision.
            q: (nq,) configuration it was taken for.
            foot: 0 right, 1 left.
        """
        if load.footing[foot] == Footing.AIR:
            return None
        sole = self._soles.positions(q).reshape(2, 3, 3)[foot]
        if load.footing[foot] != Footing.MEASURED:
            lowest = sole[:SOLE_ENDS][np.argmin(sole[:SOLE_ENDS, 2])]
            return Planted(FEET[foot], lowest, flat=False)
        surface = self.surfaces_m[load.memory.foot_of_plate.index(foot)]
        fx, fy, fz, mx, my, _ = load.wrench[foot].tolist()
        pressed = np.array([(fx * surface - my) / fz, (fy * surface + mx) / fz, surface])
        heel, ball, end = sole[:, :2]
        along = (end - heel) / ((end - heel) @ (end - heel))
        share = (pressed[:2] - heel) @ along
        if share > (ball - heel) @ along:
            return Planted(TOES[foot], pressed, flat=True)
        return Planted(FEET[foot], pressed, flat=bool(FLAT_FROM < share < FLAT_TO))

    def _touching(
        self,
        before_s: tuple[float, float],
        footing: list[Footing],
        soles: list,
        motion: tuple[Array, Array],
        height: float,
        idle: _Idle,
    ) -> tuple[float, float]:
        """For how long right and left foot have touched the floor where no plate reads, s."""

        def since(f: int) -> float:
            if footing[f] != Footing.AIR:
                return 0.0
            # One that stood must clearly leave.
            slack = LEAVE_SLACK if before_s[f] > STAND_AFTER_S else 1.0
            touches = self._touches(f, soles[f], motion, height, slack)
            stands = touches and not self._watched(f, soles[f], idle)
            return before_s[f] + self._dt_s if stands else 0.0

        return since(0), since(1)

    def _holding(self, soles: list, idle: _Idle) -> list[int]:
        """The lower foot or both, on whatever they stand: for a body in the air that does not fall."""
        if any(self._watched(f, soles[f], idle) for f in (0, 1)):
            return []
        lowest = [min(p[2] for p in soles[f][:SOLE_ENDS]) for f in (0, 1)]
        return [f for f in (0, 1) if lowest[f] <= min(lowest) + TOUCH_HEIGHT_M]

    def _owner(self, k: int, point: tuple[float, float], soles: list, before: int) -> int:
        """Foot of plate k with this centre of pressure: 0 right, 1 left, 2 both, -1 nobody."""
        away = [_distance_to_sole(point, sole) for sole in soles]
        if self._between(k, soles, away):
            return 2
        nearest = 0 if away[0] <= away[1] else 1
        if before in (0, 1) and away[before] <= away[nearest] + KEEP_M:
            nearest = before
        return nearest if away[nearest] <= REACH_M else -1

    def _between(self, k: int, soles: list, away: list[float]) -> bool:
        """Whether both feet stand flat on plate k: both soles inside it, the centre of pressure between them."""
        if not self._areas.known[k] or min(away) <= BETWEEN_M:
            return False
        heights = [min(p[2] for p in sole) for sole in soles]
        if abs(heights[0] - heights[1]) >= TOUCH_HEIGHT_M:
            return False
        ends = np.array([end[:2] for sole in soles for end in (sole[0], sole[2])])
        return bool(self._areas.contain(ends)[:, k].all())

    def _pressure(self, k: int, load: list[float]) -> tuple[float, float]:
        """Centre of pressure on plate k (eq. 4.9), which is loaded."""
        fx, fy, fz, mx, my, _ = load
        z = self.surfaces_m[k]
        return (z * fx - my) / fz, (mx + z * fy) / fz

    def _sole_height(self, known: float, soles: list, footing: list[Footing]) -> float:
        """Height at which our body's loaded soles lie: its soles and the plates need not agree to the centimetre."""
        loaded = [min(p[2] for p in soles[f][:SOLE_ENDS]) for f in (0, 1) if footing[f] == Footing.MEASURED]
        for lowest in loaded:
            known = lowest if isnan(known) else known + FLOOR_SHARE * (lowest - known)
        if isnan(self._floor):  # without plates, the lowest that a sole ever was
            lowest_now = min(p[2] for sole in soles for p in sole[:SOLE_ENDS])
            known = lowest_now if isnan(known) else min(known, lowest_now)
        return known

    def _touches(
        self, foot: int, sole: list, motion: tuple[Array, Array], height: float, slack: float
    ) -> bool:
        """Whether heel or ball is low and slow; ``slack`` times the usual limits."""
        floor = height if not isnan(height) else self._floor
        low = [point for point in sole[:SOLE_ENDS] if point[2] < floor + slack * STAND_HEIGHT_M]
        if not low:
            return False
        q, v = motion
        # The foot's velocity at the world's origin, from which each point's follows.
        vx, vy, vz, wx, wy, wz = (self._model.spatial_jacobian(q) @ (v * self._moves[foot])).tolist()
        speeds = [hypot(vx + wy * z - wz * y, vy + wz * x - wx * z, vz + wx * y - wy * x) for x, y, z in low]
        return min(speeds) < slack * STAND_SPEED_M_S

    def _watched(self, foot: int, sole: list, idle: _Idle) -> bool:
        """Whether a plate that reads nothing lies under a foot, so that it carries nothing.

        A plate without an outline lies where its foot last pressed it.
        """
        middle = np.array([[(sole[0][i] + sole[2][i]) / 2 for i in (0, 1)]])
        if (self._areas.contain(middle)[0] & idle.plates).any():
            return True
        for k in (idle.plates & ~self._areas.known).nonzero()[0].tolist():
            pressed = idle.pressed[k]
            if pressed is None or pressed.owner != foot:
                continue
            if _distance_to_sole((pressed.x, pressed.y), sole) <= REACH_M:
                return True
        return False


class _Idle(NamedTuple):
    """Plates (K,) that read and are not loaded, and where all were pressed last."""

    plates: BoolArray
    pressed: tuple[Pressed | None, ...]


class _Areas:
    """Convex plates seen from above, all at once.

    Attributes:
        known: (K,) plates whose corners are.
    """

    def __init__(self, plates: Sequence[PlateReadings]) -> None:
        self.known = np.array([plate.corners_m is not None for plate in plates], dtype=bool)
        corners = np.zeros((len(plates), 4, 2))
        for own, plate in zip(corners, plates, strict=True):
            if plate.corners_m is not None:
                own[:] = plate.corners_m[:, :2]
        self._from, self._along = corners, np.roll(corners, -1, axis=1) - corners

    def contain(self, points_m: Array) -> BoolArray:
        """(n, K) whether points (n, 2) lie over each; never over one that is not known."""
        away = points_m[:, None, None] - self._from
        left = self._along[:, :, 0] * away[..., 1] - self._along[:, :, 1] * away[..., 0] >= 0.0
        return np.asarray((left.all(axis=-1) | ~left.any(axis=-1)) & self.known)


def _falls(q: Array, v: Array, a: Array) -> bool:
    """Whether the pelvis falls as nobody does whom a floor carries: a_z + (ω × v)_z in world axes."""
    x, y, z, w = q[3:7].tolist()
    vx, vy, vz, wx, wy, wz = v[:6].tolist()
    ax, ay, az = a[:3].tolist()
    up = (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    rise = (ax + wy * vz - wz * vy, ay + wz * vx - wx * vz, az + wx * vy - wy * vx)
    return sum(u * r for u, r in zip(up, rise, strict=True)) < -FALL_SHARE * GRAVITY_M_S2


def _distance_to_sole(point: tuple[float, float], sole: list) -> float:
    """Horizontal distance from a point to the line from heel to toe end."""
    (hx, hy, _), (tx, ty, _) = sole[0], sole[2]
    ax, ay = tx - hx, ty - hy
    along = ((point[0] - hx) * ax + (point[1] - hy) * ay) / (ax * ax + ay * ay)
    along = min(max(along, 0.0), 1.0)
    return hypot(point[0] - hx - along * ax, point[1] - hy - along * ay)
