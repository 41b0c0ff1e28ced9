"""Pelvis residual of a forced body, as a block: 0 = τ_p(q, v, u) + r, r ~ N(0, diag(σ_F² I₃, σ_M² I₃)).

τ_p are the six generalised forces at the pelvis that neither gravity nor the ground exerts, force N and moment N m in
pelvis axes (thesis 3.2.3): errors of body, markers and plates. With inertial force states
(:data:`mbkf.model.human_dynamics.FORCE_STATES`) this reading ties plates to motion. A finite σ departs from thesis
section 3.2.3; an infinite one leaves the residual a random walk, as there. It is not read while a foot of unknown
wrench stands and wrenches are known inputs (:mod:`mbkf.sensors.given_plates`): the missing load then stands in it.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.block import Block, Notes, OperatingPoint, Rows
from mbkf.sensors.states import ForceState


class PelvisResidual(Block[ForceState, None, Notes, None]):
    """The pelvis residual near zero.

    Attributes:
        dynamics: The forced body.
        sd: (6,) standard deviations of force, N, and moment, N m.
    """

    prior = True

    def __init__(self, dynamics: HumanDynamics, residual_sd: Array) -> None:
        """Args: the forced body, and standard deviations (6,) of force, N, and moment, N m."""
        self.dynamics, self.sd = dynamics, residual_sd
        self._weight = 1.0 / residual_sd

    def linearise(self, at: OperatingPoint[ForceState, None], decision: Notes) -> Rows | None:
        """Whitened rows on the whole state; None where nothing is known."""
        state = at.state
        if not self._weight.any() or np.isnan(state.given).any():
            return None
        residual = self.dynamics.residual(state.q, state.v, state.forces)
        rows = np.concatenate([residual.by_q, residual.by_v, residual.by_u], axis=1)
        rows *= self._weight[:, None]
        return Rows(rows, -residual.torque * self._weight)
