"""Standing feet, as a block, for a body without cameras: they do not move, and their soles lie on the floor.

A foot whose own sensor is at rest lies flat on the floor: neither its sole's middle nor the foot itself moves,

    0 = u + r_u,  0 = ω + r_ω,  0 = z_heel + r_z,  0 = z_ball + r_z

with a spread that grows with its angular velocity: in walking it rolls from heel to ball even while its sensor is calm.
A foot that carries weight otherwise rolls over the lower end of its sole, which hardly moves: 0 = u + ρ_u, 0 = z + ρ_z.
u and ω are in the foot's axes, with their derivatives by the whole posture. The floor is level, at height 0.
A foot at rest for longer than a step takes stays at its place p₀: 0 = (p − p₀)_xy + r_p.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
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
        self._supports = [model.supports[model.joint(name).joint_id] for name in model.roles.feet]
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
        s, q, v = self.settings, at.state.q, at.state.v
        pin.computeForwardKinematicsDerivatives(self._model.pin_model, self._data, q, v, self._still)
        soles, spatial, found = self._feet.at(q, self._still).soles, self._model.spatial_jacobian(q), []
        for foot, turns in zip(at_rest, turning, strict=True):
            ends, lever = np.array(soles[foot][:SOLE_ENDS]), self._lever_m * turns
            speed, height = (
                hypot(s.standing_speed_m_s, lever),
                hypot(s.standing_height_m, 0.5 * s.stance_s * lever),
            )
            turn = hypot(s.standing_turn_rad_s, lever / s.standing_lever_m)
            found.append(self._still_rows(foot, ends.mean(axis=0), np.repeat([speed, turn], 3)))
            for end, on_floor in zip(ends, self._on_floor_m[foot], strict=True):
                found.append(self._floor_rows(spatial, foot, end, on_floor, height))
            place = places[foot]
            if place is not None:
                found.append(self._place_rows(spatial, foot, ends.mean(axis=0), place))
        for foot in rolling:
            ends = np.array(soles[foot][:SOLE_ENDS])
            k = int(np.argmin(ends[:, 2] - self._on_floor_m[foot]))
            found.append(self._still_rows(foot, ends[k], np.full(3, s.rolling_speed_m_s)))
            found.append(
                self._floor_rows(spatial, foot, ends[k], self._on_floor_m[foot, k], s.rolling_height_m)
            )
        return found

    def _still_rows(self, foot: int, point_m: Array, sds: Array) -> Rows:
        """Rows of a foot's world point (3,) at rest, with spreads (3,) m/s; (6,) for a foot that does not turn."""
        joint = self._model.joint(self._model.roles.feet[foot]).joint_id
        by_q, by_v = pin.getJointVelocityDerivatives(self._model.pin_model, self._data, joint, pin.LOCAL)
        to_point = np.eye(6)
        to_point[:3, 3:] = -skew(self._data.oMi[joint].actInv(point_m))
        to_point = to_point[: len(sds)] / sds[:, None]
        return Rows(np.hstack([to_point @ by_q, to_point @ by_v]), -to_point @ self._data.v[joint].vector)

    def _place_rows(self, spatial: Array, foot: int, point_m: Array, place_m: Array) -> Rows:
        """Rows of a foot's world point (3,) that stays at a place (2,); ``spatial`` (6, nv) at the world's origin."""
        sd = self.settings.staying_m
        return Rows(self._moves(spatial, foot, point_m)[:2] / sd, (place_m - point_m[:2]) / sd)

    def _floor_rows(self, spatial: Array, foot: int, point_m: Array, height_m: float, sd_m: float) -> Rows:
        """A row of a foot's world point (3,) whose height, when the sole touches the floor, is known with a spread."""
        jacobian = self._moves(spatial, foot, point_m)
        return Rows(jacobian[2:3] / sd_m, np.array([(height_m - point_m[2]) / sd_m]))

    def _moves(self, spatial: Array, foot: int, point_m: Array) -> Array:
        """(3, nv) world Jacobian of a foot's world point (3,): u + ω × p, of the dofs that move the foot."""
        moved = (spatial[:3] - skew(point_m) @ spatial[3:]) * self._supports[foot]
        return np.asarray(moved)
