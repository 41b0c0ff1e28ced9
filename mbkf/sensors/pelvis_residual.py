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
from mbkf.numerics.kalman import Information, information
from mbkf.sensors.block import Block, Notes, OperatingPoint
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

    def linearise(self, at: OperatingPoint[ForceState, None], decision: Notes) -> Information | None:
        """Information on the whole state."""
        state = at.state
        if np.isnan(state.given).any():
            return None
        torque = self.dynamics.joint_forces(state.q, state.v, state.forces)
        H = np.hstack([torque.by_q, torque.by_v, torque.by_u])[:6]
        found = information(-torque.torque[:6], H, self.sd)
        return Information(found.matrix, found.vector, 0.0, 0)
