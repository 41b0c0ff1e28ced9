"""Standing feet, as a block, for a body without cameras: they do not move, and their soles lie on the floor.

A foot whose own sensor is at rest lies flat on the floor: neither its sole's middle nor the foot itself moves,

    0 = u + r_u,  0 = ω + r_ω,  0 = z_heel + r_z,  0 = z_ball + r_z

with a spread that grows with its angular velocity: in walking it rolls from heel to ball even while its sensor is calm.
A foot that carries weight otherwise rolls over the lower end of its sole, which hardly moves: 0 = u + ρ_u, 0 = z + ρ_z.
u and ω are in the foot's axes, with their derivatives by the whole posture. The floor is level, at height 0.
A foot at rest for longer than a step takes stays at its place p₀: 0 = (p − p₀)_xy + r_p.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import hypot
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array, Int32Array
from mbkf.model.body import Body
from mbkf.numerics.rotations import skew
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows, State
from mbkf.sensors.contact.feet import FeetMotion, FeetOnBody
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.rules import SOLE_ENDS, STANDING

FOOT_REST = "feet at rest"
"""Name of the readings (2,) of a frame: 1 where right or left foot's own sensor is at rest, else 0."""


@dataclass(frozen=True)
class StandingSettings:
    """Spreads of standing feet, per frame. Their errors last for many frames, so that each frame counts for little.

    Attributes:
        standing_speed_m_s, standing_turn_rad_s: Spread of the velocity of a foot at rest.
        standing_height_m: Spread of its heel's and ball's height.
        rolling_speed_m_s, rolling_height_m: The same of the lower end of a sole that rolls.
        standing_lever_m: A foot at rest that still turns rolls over some point of its sole, this far from its middle.
        stance_s: Duration of that roll: the error is alike in all its frames, in velocity by lever times angular
            velocity, in height by lever times half the turn.
        stays_after_s, staying_m: A foot at rest for this long stays in its place, with this spread.
    """

    standing_speed_m_s: float = 0.02
    standing_turn_rad_s: float = 0.1
    standing_height_m: float = 0.015
    standing_lever_m: float = 0.14
    stance_s: float = 0.5
    rolling_speed_m_s: float = 0.6
    rolling_height_m: float = 0.08
    stays_after_s: float = 1.0
    staying_m: float = 0.02


Places = tuple[Array | None, Array | None]
"""(2,) places on the floor at which right and left foot stay, m; None for a foot that does not."""


class StandingDecision(NamedTuple):
    """Feet at rest and feet that roll.

    Attributes:
        at_rest: Feet at rest, 0 right and 1 left.
        turning_rad_s: Angular velocity of each of them.
        rolling: Other feet that carry weight.
        places: Places at which feet stay.
    """

    at_rest: tuple[int, ...] = ()
    turning_rad_s: tuple[float, ...] = ()
    rolling: tuple[int, ...] = ()
    places: Places = (None, None)


class _Carried(NamedTuple):
    """A point of a foot as it moves.

    Attributes:
        place_m: (3,) where it is in the world.
        velocity: (6,) its linear and its foot's angular velocity, in the foot's axes.
        by_motion: (6, 2 nv) derivatives of these by q and v.
        by_q: (3, nv) derivatives of its place by q.
    """

    place_m: Array
    velocity: Array
    by_motion: Array
    by_q: Array


class Rest(NamedTuple):
    """Number of frames for which right and left foot have been at rest, and the places at which they stay."""

    frames: tuple[int, int] = (0, 0)
    places: Places = (None, None)


RESTING_ROWS, ROLLING_ROWS = 6 + SOLE_ENDS + 2, 3 + 1
"""The most rows of a foot at rest, and of one that rolls."""


class StandingFeet(Block[State, None, StandingDecision, Rest]):
    """Feet that stand, on a state that begins with (q, v)."""

    prior = True

    def __init__(
        self,
        model: Body,
        dt_s: float,
        settings: StandingSettings = StandingSettings(),
        standing_q: Array | None = None,
    ) -> None:
        """Makes the block.

        Args:
            model: The body.
            dt_s: Time between frames.
            settings: Spreads.
            standing_q: (nq,) a posture in which heels and balls touched the floor; None for soles that are level in
                the body file.
        """
        self._model, self.settings = model, settings
        self._feet, self._still = FeetOnBody(model), np.zeros(model.nv)
        self._data = pin.Data(model.pin_model)
        self._joints = [model.joint(name).joint_id for name in model.roles.feet]
        self._lever_m = settings.standing_lever_m * max(settings.stance_s / dt_s, 1.0) ** 0.5
        self._stays_after = round(settings.stays_after_s / dt_s)
        self._on_floor_m = np.zeros((2, SOLE_ENDS))
        if standing_q is not None:
            ends = np.array(self._feet.at(standing_q, self._still).soles)[:, :SOLE_ENDS, 2]
            self._on_floor_m = ends - ends.min(axis=1, keepdims=True)

    def begin(self) -> Rest:
        """Memory without a foot at rest."""
        return Rest()

    def decide(
        self, at: OperatingPoint[State, None], frame: Frame, memory: Rest, notes: Notes
    ) -> StandingDecision:
        """By the feet's own sensors, else by the contact decision."""
        rest = frame.readings.get(FOOT_REST)
        at_rest = tuple(f for f in (0, 1) if rest is not None and rest[f] > 0.5)
        feet, contact = self._feet.at(at.state.q, at.state.v), notes.contact
        turning = tuple(float(np.linalg.norm(feet.twists[f][3:])) for f in at_rest)
        right, left = (memory.places[f] if f in at_rest else None for f in (0, 1))
        loaded = [] if contact is None else [f for f in (0, 1) if contact.contacts[f] != Contact.AIR]
        rolling = tuple(f for f in loaded if f not in at_rest and self._may_roll(feet, f))
        return StandingDecision(at_rest, turning, rolling, (right, left))

    def _may_roll(self, feet: FeetMotion, foot: int) -> bool:
        """True for a loaded foot that is slow: a foot in swing, close above the floor, would be held back."""
        lowest = min(feet.soles[foot][:SOLE_ENDS], key=lambda point: point[2])
        return feet.speed(foot, lowest, (0.0, 0.0)) < STANDING.speed_m_s

    def remember(
        self,
        posterior: State,
        at: OperatingPoint[State, None],
        decision: StandingDecision,
        memory: Rest,
    ) -> Rest:
        """Durations of rest, and places at which feet then stay."""
        right, left = (memory.frames[f] + 1 if f in decision.at_rest else 0 for f in (0, 1))
        places: list[Array | None] = []
        for foot, frames in enumerate((right, left)):
            place = memory.places[foot] if frames else None
            if frames >= self._stays_after and place is None:
                place = self._middle(posterior.q, foot)[:2]
            places.append(place)
        return Rest((right, left), (places[0], places[1]))

    def _middle(self, q: Array, foot: int) -> Array:
        """(3,) middle of heel and ball."""
        return np.asarray(np.mean(self._feet.at(q, self._still).soles[foot][:SOLE_ENDS], axis=0))

    def linearise(self, at: OperatingPoint[State, None], decision: StandingDecision) -> list[Rows]:
        """Rows on positions and velocities."""
        at_rest, turning, rolling, places = decision
        if not (at_rest or rolling):
            return []
        s, soles = self.settings, self._feet.at(at.state.q, self._still).soles
        ends = np.array(soles)[:, :SOLE_ENDS]
        rolled = [int(np.argmin(ends[foot, :, 2] - self._on_floor_m[foot])) for foot in rolling]
        points = [(foot, point) for foot in at_rest for point in (ends[foot].mean(axis=0), *ends[foot])]
        points += [(foot, ends[foot, k]) for foot, k in zip(rolling, rolled, strict=True)]
        carried, found = self._carried(at.state.q, at.state.v, points), []
        for foot, turns in zip(at_rest, turning, strict=True):
            lever = self._lever_m * turns
            speed, height = (
                hypot(s.standing_speed_m_s, lever),
                hypot(s.standing_height_m, 0.5 * s.stance_s * lever),
            )
            turn = hypot(s.standing_turn_rad_s, lever / s.standing_lever_m)
            middle = next(carried)
            found.append(_still_rows(middle, np.repeat([speed, turn], 3)))
            found += [_floor_row(next(carried), on_floor, height) for on_floor in self._on_floor_m[foot]]
            place = places[foot]
            if place is not None:
                found.append(_place_rows(middle, place, s.staying_m))
        for foot, k in zip(rolling, rolled, strict=True):
            end = next(carried)
            found.append(_still_rows(end, np.full(3, s.rolling_speed_m_s)))
            found.append(_floor_row(end, self._on_floor_m[foot, k], s.rolling_height_m))
        return found

    def _carried(self, q: Array, v: Array, points: Sequence[tuple[int, Array]]) -> Iterator[_Carried]:
        """Points of feet as they move, in order.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            points: Foot and (3,) place in the world, m, of each.
        """
        joints = np.array([self._joints[foot] for foot, _ in points], dtype=np.int32)
        places = np.array([place for _, place in points])
        tree = self._model.tree
        found = (
            self._reference(q, v, joints, places)
            if tree is None
            else tree.carried_points(q, v, joints, places)
        )
        return map(_Carried, places, *found)

    def _reference(self, q: Array, v: Array, joints: Int32Array, places: Array) -> tuple[Array, Array, Array]:
        """(n, 6), (n, 6, 2 nv), (n, 3, nv): as :meth:`mbkf.kernel.tree.CompiledTree.carried_points`."""
        model, data = self._model.pin_model, self._data
        pin.computeForwardKinematicsDerivatives(model, data, q, v, self._still)
        spatial, found = self._model.spatial_jacobian(q), []
        for joint, place in zip(joints.tolist(), places, strict=True):
            by_q, by_v = pin.getJointVelocityDerivatives(model, data, joint, pin.LOCAL)
            to_point = np.eye(6)
            to_point[:3, 3:] = -skew(data.oMi[joint].actInv(place))
            moves = (spatial[:3] - skew(place) @ spatial[3:]) * self._model.supports[joint]
            found.append((to_point @ data.v[joint].vector, to_point @ np.hstack([by_q, by_v]), moves))
        velocities, by_motion, by_q = map(np.array, zip(*found, strict=True))
        return velocities, by_motion, by_q


def _still_rows(point: _Carried, sds: Array) -> Rows:
    """Rows of a point at rest, with spreads (3,) m/s; (6,) for one whose foot does not turn."""
    count = len(sds)
    return Rows(point.by_motion[:count] / sds[:, None], -point.velocity[:count] / sds)


def _place_rows(point: _Carried, place_m: Array, sd_m: float) -> Rows:
    """Rows of a point that stays at a place (2,) on the floor, with a spread."""
    return Rows(point.by_q[:2] / sd_m, (place_m - point.place_m[:2]) / sd_m)


def _floor_row(point: _Carried, height_m: float, sd_m: float) -> Rows:
    """A row of a point whose height, when the sole touches the floor, is known with a spread."""
    return Rows(point.by_q[2:] / sd_m, np.array([(height_m - point.place_m[2]) / sd_m]))
