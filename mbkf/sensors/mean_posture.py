"""Mean posture, as a block: 0 = q ⊖ q̄ + r, r ~ N(0, σ²), for limbs that neither markers nor inertial sensors observe.

q̄ is the mean of a joint's configuration while it was observed, a better guess than the standing posture, and after a
fraction of a second than the last one. Used beside inertial sensors, whose trials leave limbs unobserved.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows, State


@dataclass(frozen=True)
class MeanPostureSettings:
    """Mean posture and spread about it.

    Attributes:
        mean_posture_s: Time over which a joint's mean posture is taken while it is observed.
        mean_posture_sd_rad: Spread about it of an unobserved joint, per reading.
    """

    mean_posture_s: float = 1.0
    mean_posture_sd_rad: float = 1.5


class MeanPostureDecision(NamedTuple):
    """(nq,) mean posture, None before the first, and the frame's notes."""

    mean: Array | None
    notes: Notes


class MeanPosture(Block[State, None, MeanPostureDecision, "Array | None"]):
    """Mean posture of unobserved limbs."""

    prior = True

    def __init__(
        self, model: Body, dt_s: float, settings: MeanPostureSettings = MeanPostureSettings()
    ) -> None:
        """Args: model: the body; dt_s: time between frames; settings: mean and spread."""
        self._model, self.settings = model, settings
        # Hinges (toes) bend with every step: their mean says little.
        self._limb = np.zeros(model.nv, dtype=bool)
        for joint in model.joints.values():
            self._limb[joint.v] = joint.kind not in ("free", "hinge")
        self._share = 1.0 - np.exp(-dt_s / settings.mean_posture_s)

    def decide(
        self, at: OperatingPoint[State, None], frame: Frame, memory: Array | None, notes: Notes
    ) -> MeanPostureDecision:
        """The mean so far; the joints that need it depend on the other blocks."""
        return MeanPostureDecision(memory if notes.imus is not None else None, notes)

    def linearise(self, at: OperatingPoint[State, None], decision: MeanPostureDecision) -> Rows | None:
        """Rows on the configuration; joints that the coordination prior predicts are left to it."""
        mean, notes = decision
        if mean is None:
            return None
        dofs = notes.unobserved[self._limb[notes.unobserved]]
        if len(notes.coordinated):
            dofs = np.setdiff1d(dofs, notes.coordinated)
        if not len(dofs):
            return None
        q, sd = at.state.q, self.settings.mean_posture_sd_rad
        jacobian = self._model.difference_derivative(mean, q)[dofs] / sd
        return Rows(jacobian, -self._model.difference(mean, q)[dofs] / sd)

    def remember(
        self,
        posterior: State,
        at: OperatingPoint[State, None],
        decision: MeanPostureDecision,
        memory: Array | None,
    ) -> Array | None:
        """The mean with this frame's posture of the joints that are observed."""
        if memory is None:
            return posterior.q
        step = self._share * self._model.difference(memory, posterior.q)
        step[decision.notes.unobserved] = 0.0
        step[:6] = 0.0
        return self._model.integrate(memory, step)
