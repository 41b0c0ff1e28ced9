"""Planted foot, as a block: u = ṗ + r_p and 0 = ω + r_ω, for a loaded foot without a seen marker.

Keypoints leave the pitch of a foot open by several degrees; while it lies flat on a plate, its sole is level:
0 = (A e_z)_xy + r_l.

The point p under the centre of pressure moves with the floor, under a flat as under a rolling foot: u is zero, or the
velocity of the belt. A flat foot does not turn either, nor do the toes once the load is on them and the heel rises. The
derivative by the configuration vanishes where the reading is met and is left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows, State
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Planted
from mbkf.sensors.contact.rules import STANDING


@dataclass(frozen=True)
class PlantedSettings:
    """Standard deviations of a loaded foot's rest.

    Attributes:
        planted_speed_sd, planted_turn_sd: Of the point's velocity on the floor, m/s, and of the angular velocity of a
            flat sole, rad/s.
        belt_speed_share: Of the belt's speed, as a share of it.
        level_sd_rad: Of a flat sole's tilt from level per frame, for a foot that only keypoints show, rad.
    """

    planted_speed_sd: float = 0.2
    planted_turn_sd: float = 0.2
    belt_speed_share: float = 0.1
    level_sd_rad: float = 0.3


class PlantedDecision(NamedTuple):
    """Feet at rest on the floor, and level ones.

    Attributes:
        still: Feet and toes at rest on the floor.
        level: Segments of feet with level soles.
        floor_m_s: The floor's horizontal velocity.
        slides_m_s: By which each of ``still`` is predicted to be faster than a foot that stands.
    """

    still: tuple[Planted, ...]
    level: tuple[str, ...]
    floor_m_s: tuple[float, float] = (0.0, 0.0)
    slides_m_s: tuple[float, ...] = ()


class PlantedFeet(Block[State, None, PlantedDecision, None]):
    """Loaded feet without a marker in sight, and flat ones that keypoints show.

    Attributes:
        detector: Decides the contact of the feet; a block before this one calls it in every frame.
        settings: Standard deviations.
        keypoints: True if keypoints show the feet.
    """

    prior = True

    def __init__(
        self,
        model: Body,
        detector: ContactDetector,
        settings: PlantedSettings = PlantedSettings(),
        keypoints: bool = False,
    ) -> None:
        """Args: the attributes; model: the body."""
        self.keypoints = keypoints
        self._model, self.detector, self.settings = model, detector, settings
        self._dof = [model.joint(segment).v.start for segment in model.roles.feet]

    def decide(
        self, at: OperatingPoint[State, None], frame: Frame, memory: None, notes: Notes
    ) -> PlantedDecision:
        """Feet or toes at rest, and level soles."""
        contact = notes.contact
        if contact is None or not (self.keypoints or len(notes.unmarked)):
            return PlantedDecision((), ())
        gone = notes.unmarked.tolist()
        unmarked = [dof in gone for dof in self._dof]
        found = [
            self.detector.planted(contact, at.state.q, foot) if self.keypoints or lost else None
            for foot, lost in enumerate(unmarked)
        ]
        still = tuple(one for one, lost in zip(found, unmarked, strict=True) if lost and one is not None)
        slides = tuple(self._slides(at.state, one, contact.floor_m_s) for one in still)
        if not self.keypoints:
            return PlantedDecision(still, (), contact.floor_m_s, slides)
        flat = [one.segment for one in found if one is not None and one.flat]
        level = tuple(name for name in flat if name in self._model.roles.feet)
        return PlantedDecision(still, level, contact.floor_m_s, slides)

    def _slides(self, state: State, planted: Planted, floor_m_s: tuple[float, float]) -> float:
        """Speed beyond that of a foot that stands, m/s: its floor may be a belt whose velocity is not known yet."""
        moves = self._model.segment_jacobian(state.q, planted.segment, planted.point_m)[:2] @ state.v
        return max(math.dist(moves, floor_m_s) - STANDING.speed_m_s, 0.0)

    def linearise(self, at: OperatingPoint[State, None], decision: PlantedDecision) -> list[Rows]:
        """Rows on the velocity, and on the configuration for level soles."""
        s, state, floor = self.settings, at.state, decision.floor_m_s
        own, turn_sd = (s.planted_speed_sd, s.belt_speed_share * math.hypot(*floor)), s.planted_turn_sd
        found = [
            Rows(
                *standing_still(
                    self._model, state.q, state.v, foot, math.hypot(*own, slides), turn_sd, floor
                ),
                self.layout.v.start,
            )
            for foot, slides in zip(decision.still, decision.slides_m_s, strict=True)
        ]
        level = decision.level
        return found + [Rows(*lying_level(self._model, state.q, name, s.level_sd_rad)) for name in level]


def standing_still(
    model: Body,
    q: Array,
    v: Array,
    planted: Planted,
    speed_sd: float,
    turn_sd: float,
    floor_m_s: tuple[float, float] = (0.0, 0.0),
) -> tuple[Array, Array]:
    """Whitened rows (k, nv) on the velocity and their innovations (k,): three, and three more for a flat sole.

    Args:
        model: The body.
        q: (nq,) configuration.
        v: (nv,) velocity.
        planted: The foot or its toes.
        speed_sd: Standard deviation of the point's velocity on the floor, m/s.
        turn_sd: That of the angular velocity of a flat sole, rad/s.
        floor_m_s: Horizontal velocity of the floor.
    """
    jacobian = model.segment_jacobian(q, planted.segment, planted.point_m)
    weight = 1.0 / np.repeat([speed_sd, turn_sd], 3)
    rows = (weight[:, None] * jacobian)[: 6 if planted.flat else 3]
    short = -rows @ v
    short[:2] += weight[:2] * floor_m_s
    return rows, short


def lying_level(model: Body, q: Array, segment: str, level_sd_rad: float) -> tuple[Array, Array]:
    """Whitened rows (2, nv) on the configuration and their innovations (2,): the inclination of a flat foot.

    Args:
        model: The body.
        q: (nq,) configuration.
        segment: The foot.
        level_sd_rad: Standard deviation of its tilt.
    """
    joint = model.joint(segment).joint_id
    frames, spatial = model.frames_and_jacobian(q)
    up = frames[4 * joint + 2]
    turned = np.cross(spatial[3:].T, up) * model.supports[joint][:, None]
    return turned[:, :2].T / level_sd_rad, -up[:2] / level_sd_rad
