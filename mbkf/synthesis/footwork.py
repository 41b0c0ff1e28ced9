"""Footwork: where each foot stands and when it swings, and from it the poses of the feet and the load on them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.contact import Load, sole_outline
from mbkf.synthesis.curves import Curve, added, path, sinusoid
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES, FootPose, InverseKinematics
from mbkf.synthesis.standing import pressed

HEEL_OFF_S = 0.24
"""Time before leaving the ground at which a foot begins to turn over its ball."""

BEFORE_S = -1.0
"""A time before every motion."""

CLOSE_S = 0.02
"""Between two swings closer than this the load goes from foot to foot without a stop."""

ALONE = 1.5
"""Additional sway of the pressure under one foot, as a share of the sway under two."""

LIGHT, LIGHT_S = 0.08, 0.08
"""Part of the load that a foot still bears so long before it leaves the ground, and bears again so long after it came
down; it does not linger near zero."""

PEAK, LATE = 0.45, 0.12
"""When a stepping foot is highest, and when it begins to move forward, as parts of its swing."""


@dataclass(frozen=True)
class Spot:
    """Where a foot stands: (2,) ankle m over the flat foot, yaw rad, height of the surface m."""

    ankle_m: Array
    yaw: float
    surface_m: float = 0.0

    def ahead(self, forward_m: float, left_m: float = 0.0) -> Array:
        """(2,) point beside the ankle, along the foot's heading, m."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return self.ankle_m + np.array([c * forward_m - s * left_m, s * forward_m + c * left_m])


@dataclass(frozen=True)
class Waypoint:
    """Where a swinging foot is at a time: (3,) ankle m, pitch (heel up) and roll (left side up), rad."""

    at_s: float
    ankle_m: Array
    pitch: float
    roll: float


@dataclass(frozen=True)
class Swing:
    """One foot off the ground.

    Attributes:
        side: 0 right, 1 left.
        lift_s: When it leaves the ground.
        land_s: When it comes down.
        to: Where it comes down.
        clearance_m: How far the ankle rises over the higher of both ends.
        heel_deg: Pitch with which the heel leaves first.
        held: None: a step; else (from s, to s, forward m, pitch deg) of a foot held in the air beside the other.
        unload_s: Time before in which its load is handed over.
        reload_s: Time after in which it takes its part again, unless the other foot's unloading comes sooner.
        way: Points that the foot passes in the air, in order of time; with such points, clearance does not count.
    """

    side: int
    lift_s: float
    land_s: float
    to: Spot
    clearance_m: float
    heel_deg: float = 14.0
    held: tuple[float, float, float, float] | None = None
    unload_s: float = 0.55
    reload_s: float = 0.5
    way: tuple[Waypoint, ...] = ()


@dataclass
class Footwork:
    """Feet over time: both stand at first; swings are appended in order of time, never two at once.

    Attributes:
        model: The body.
        first: Where right and left foot stand first.
        rng: Source of small differences.
        swings: All swings.
        nudges: Curves added to the right foot's share, and to the pressure ahead and to the left of both feet, m;
            those of the share must be 0 whenever a foot is off the ground.
    """

    model: Body
    first: tuple[Spot, Spot]
    rng: np.random.Generator
    swings: list[Swing] = field(default_factory=list)
    nudges: list[tuple[Curve, Curve, Curve]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.size = float(self.model.scale.mean())
        rng, offset = self.rng, InverseKinematics(self.model).offset
        self.balls = [offset[f"{SIDE_NAMES[side]}_toes"] * [1.0, 0.0, 1.0] for side in SIDES]
        self.toes = [
            sinusoid(
                np.deg2rad(rng.uniform(0.5, 1.5)), rng.uniform(0.3, 0.6), rng.uniform(0, 6.28), np.deg2rad(-2)
            )
            for _ in SIDES
        ]
        self.sway = sinusoid(0.03 * rng.uniform(0.5, 1), rng.uniform(0.2, 0.5), rng.uniform(0, 6.28))
        self.forth = [_sway(0.006, rng) for _ in SIDES]
        self.across = [_sway(0.004, rng) for _ in SIDES]

    def spot(self, side: int) -> Spot:
        """Where a foot stands after all swings so far."""
        own = [swing.to for swing in self.swings if swing.side == side]
        return own[-1] if own else self.first[side]

    def turned(self) -> list[tuple[float, float, float]]:
        """Lift, landing (s) and change of yaw (rad) of each swing."""
        found, yaws = [], [spot.yaw for spot in self.first]
        for swing in self.swings:
            found.append((swing.lift_s, swing.land_s, swing.to.yaw - yaws[swing.side]))
            yaws[swing.side] = swing.to.yaw
        return found

    def poses(self, times: Array) -> dict[str, FootPose]:
        """The feet at times in s."""
        return {SIDES[side]: self._pose(side, times) for side in range(2)}

    def load(self, times: Array) -> Load:
        """Load and pressure at times in s."""
        share = self._share()(times).value
        both = 4 * share * (1 - share)
        share = share + both * self.sway(times).value
        for nudge in self.nudges:
            share = share + nudge[0](times).value
        poses, sway = self.poses(times), 1.0 + ALONE * (1.0 - both)
        pressure = np.stack(
            [self._pressure(side, times, poses[SIDES[side]], sway) for side in range(2)], axis=1
        )
        surfaces = np.stack([self._surface(side, times) for side in range(2)], axis=1)
        return Load(share, pressure, np.ones(len(times), dtype=bool), surfaces)

    def _own(self, side: int) -> list[tuple[Spot, Swing]]:
        """A foot's swings, each with the spot that it leaves."""
        own = [swing for swing in self.swings if swing.side == side]
        return list(zip([self.first[side], *(swing.to for swing in own)], own, strict=False))

    def _surface(self, side: int, times: Array) -> Array:
        height = np.full(len(times), self.first[side].surface_m)
        for _, swing in self._own(side):
            height[times >= 0.5 * (swing.lift_s + swing.land_s)] = swing.to.surface_m
        return height

    def _share(self) -> Curve:
        """Part of the load on the right foot: half in quiet standing, handed over before and after each swing."""
        knots: list[tuple[float, ...]] = []
        loaded_s = -np.inf
        for swing in self.swings:
            unloads_s, alone = swing.lift_s - swing.unload_s, float(swing.side)
            if unloads_s > loaded_s + CLOSE_S:
                knots += [(loaded_s, 0.5)] if knots else []
                knots.append((unloads_s, 0.5))
            inward = 1.0 - 2.0 * alone
            light, rate = alone + inward * LIGHT, 1.5 * inward * LIGHT / LIGHT_S
            if swing.lift_s - knots[-1][0] > 3 * LIGHT_S:
                knots.append((swing.lift_s - LIGHT_S, light, -rate))
            knots += [(swing.lift_s, alone), (swing.land_s, alone)]
            if swing.reload_s > 3 * LIGHT_S:
                knots.append((swing.land_s + LIGHT_S, light, rate))
            loaded_s = swing.land_s + swing.reload_s
        return path([*knots, (loaded_s, 0.5)]) if knots else sinusoid(0.0, 1.0, 0.0, 0.5)

    def _pitch(self, side: int, *, in_air: bool = True) -> Curve:
        """Pitch of a foot; without ``in_air`` as the toes follow it, which bend on the floor only."""
        knots = [(BEFORE_S, 0.0)]
        for _, swing in self._own(side):
            knots += [(swing.lift_s - HEEL_OFF_S, 0.0), (swing.lift_s, np.deg2rad(swing.heel_deg))]
            if swing.held:
                knots += [(at, np.deg2rad(swing.held[3])) for at in swing.held[:2]]
            knots += [(point.at_s, point.pitch) for point in swing.way if in_air]
            knots.append((swing.land_s, 0.0))
        return path([*knots, (knots[-1][0] + 1.0, 0.0)])

    def _roll(self, side: int) -> Curve | None:
        """Turn of a foot about its length; None: it never turns so."""
        own = [swing for swing in self.swings if swing.side == side and swing.way]
        if not own:
            return None
        knots = [(BEFORE_S, 0.0)]
        for swing in own:
            turned = [(point.at_s, point.roll) for point in swing.way]
            knots += [(swing.lift_s, 0.0), *turned, (swing.land_s, 0.0)]
        return path(knots)

    def _pose(self, side: int, times: Array) -> FootPose:
        outline, ball = sole_outline(self.model, SIDES[side]), self.balls[side]
        pitch = self._pitch(side)(times)
        rolled = dual_numbers.rotation(1, pitch).apply(-ball) + ball

        def standing(spot: Spot, over: Dual) -> Dual:
            c, s = np.cos(spot.yaw), np.sin(spot.yaw)
            heading = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            base = np.array([*spot.ankle_m, spot.surface_m - outline.height])
            return Dual(*(x @ heading.T for x in over.orders)) + base

        ankle = standing(self.first[side], rolled)
        yaw_knots = [(BEFORE_S, self.first[side].yaw)]
        for spot, swing in self._own(side):
            lifted = _turned(np.deg2rad(swing.heel_deg), -ball) + ball
            still = Dual.constant(lifted[None])
            start = standing(spot, still).value[0]
            end = np.array([*swing.to.ankle_m, swing.to.surface_m - outline.height])
            after = times > swing.lift_s
            ankle = dual_numbers.where(after, self._flight(swing, start, end)(times), ankle)
            ankle = dual_numbers.where(times > swing.land_s, standing(swing.to, rolled), ankle)
            yaw_knots += [(swing.lift_s, spot.yaw), (swing.land_s, swing.to.yaw)]
        yaw = path([*yaw_knots, (yaw_knots[-1][0] + 1.0, yaw_knots[-1][1])])(times)
        toes, roll = self.toes[side](times), self._roll(side)
        if roll is None:
            return FootPose(ankle, yaw, pitch, toes - pitch)
        return FootPose(ankle, yaw, pitch, toes - self._pitch(side, in_air=False)(times), roll=roll(times))

    def _flight(self, swing: Swing, start: Array, end: Array) -> Curve:
        """(T, 3) ankle between leaving the ground and coming down."""
        top = max(start[2], end[2]) + swing.clearance_m
        lift, land = swing.lift_s, swing.land_s
        if swing.way:
            knots = [(point.at_s, point.ankle_m) for point in swing.way]
            return path([(lift, start), *knots, (land, end)])
        if swing.held is None:
            plane = path([(lift + LATE * (land - lift), start[:2]), (land, end[:2])])
            upward = path([(lift, start[2]), (lift + PEAK * (land - lift), top), (land, end[2])])
        else:
            begin, until, forward, _ = swing.held
            aside = swing.to.ahead(forward)
            plane = path([(lift, start[:2]), (begin, aside), (until, aside), (land, end[:2])])
            upward = path([(lift, start[2]), (begin, top), (until, top), (land, end[2])])

        def ankle(times: Array) -> Dual:
            along = plane(times)
            return dual_numbers.stack([along[:, 0], along[:, 1], upward(times)])

        return ankle

    def _pressure(self, side: int, times: Array, foot: FootPose, sway: Array) -> Array:
        """(T, 2) wanted centre of pressure under a foot: its middle, and its ball before it leaves the ground."""
        middle, toe = 0.05 * self.size, self.balls[side][0] + 0.012 * self.size
        knots = [(BEFORE_S, middle)]
        for _, swing in self._own(side):
            knots += [
                (swing.lift_s - 2.0 * HEEL_OFF_S, middle),
                (swing.lift_s - 0.8 * HEEL_OFF_S, toe),
                (swing.lift_s, toe),
                (0.5 * (swing.lift_s + swing.land_s), middle),
            ]
        forward = path([*knots, (knots[-1][0] + 1.0, middle)])(times).value
        forward = forward + sway * self.forth[side](times).value
        left = sway * self.across[side](times).value
        for nudge in self.nudges:
            forward, left = forward + nudge[1](times).value, left + nudge[2](times).value
        return pressed(foot, forward, left)


def _turned(pitch: float, vector: Array) -> Array:
    c, s = np.cos(pitch), np.sin(pitch)
    return np.array([c * vector[0] + s * vector[2], vector[1], -s * vector[0] + c * vector[2]])


def _sway(amplitude_m: float, rng: np.random.Generator) -> Curve:
    """Two slow ripples, m."""
    return added(
        sinusoid(amplitude_m * rng.uniform(0.5, 1), rng.uniform(0.2, 0.5), rng.uniform(0, 6.28)),
        sinusoid(0.4 * amplitude_m * rng.uniform(0.5, 1), rng.uniform(0.7, 1.1), rng.uniform(0, 6.28)),
    )
