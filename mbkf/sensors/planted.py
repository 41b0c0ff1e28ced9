"""Planted foot, as a block: 0 = ṗ + r_p and 0 = ω + r_ω, for a loaded foot none of whose markers is seen.

The point p under the centre of pressure stands still, whether the foot is flat or rolls; a flat foot does not turn
either, nor do the toes once the load is on them and the heel rises. The derivative by the configuration vanishes where
the reading is met and is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows, State
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Planted
from mbkf.sensors.layout import Layout


@dataclass(frozen=True)
class PlantedSettings:
    """How still a loaded foot stands.

    Attributes:
        planted_speed_sd, planted_turn_sd: Standard deviations of the point's velocity, m/s, and of the turning of what
            lies flat, rad/s.
    """

    planted_speed_sd: float = 0.03
    planted_turn_sd: float = 0.2


class PlantedFeet(Block[State, None, tuple[Planted, ...], None]):
    """Loaded feet without a marker in sight.

    Attributes:
        detector: Finds what the feet stand on.
        settings: How still they stand.
    """

    prior = True

    def __init__(
        self,
        model: Body,
        detector: ContactDetector,
        settings: PlantedSettings = PlantedSettings(),
    ) -> None:
        """Makes the block.

        Args:
            model: The body.
            detector: Finds what the feet stand on; a block before this one asks it in every frame.
            settings: How still they stand.
        """
        self._model, self.detector, self.settings = model, detector, settings
        self._dof = [model.joint(segment).v.start for segment in model.roles.feet]
        self._v = 0

    def bind(self, layout: Layout) -> None:
        """Where velocities stand in the state."""
        self._v = layout.v.start

    def decide(
        self, at: OperatingPoint[State, None], frame: Frame, memory: None, notes: Notes
    ) -> tuple[Planted, ...]:
        """What of which foot stands still."""
        if not len(notes.unmarked) or notes.contact is None:
            return ()
        lost = [foot for foot, dof in enumerate(self._dof) if dof in notes.unmarked]
        found = [self.detector.planted(notes.contact, at.state.q, foot) for foot in lost]
        return tuple(one for one in found if one is not None)

    def linearise(self, at: OperatingPoint[State, None], decision: tuple[Planted, ...]) -> list[Rows]:
        """Rows on the velocity."""
        s, state = self.settings, at.state
        sds = s.planted_speed_sd, s.planted_turn_sd
        return [
            Rows(*standing_still(self._model, state.q, state.v, foot, *sds), self._v) for foot in decision
        ]


def standing_still(
    model: Body, q: Array, v: Array, planted: Planted, speed_sd: float, turn_sd: float
) -> tuple[Array, Array]:
    """Whitened rows (k, nv) on the velocity and their innovations (k,): three, and three more for what lies flat.

    Args:
        model: The body.
        q: (nq,) configuration.
        v: (nv,) velocity.
        planted: The foot or its toes.
        speed_sd: How still the point stands, m/s.
        turn_sd: How little what lies flat turns, rad/s.
    """
    jacobian = model.segment_jacobian(q, planted.segment, planted.point_m)
    weight = 1.0 / np.repeat([speed_sd, turn_sd], 3)
    rows = (weight[:, None] * jacobian)[: 6 if planted.flat else 3]
    return rows, -rows @ v
