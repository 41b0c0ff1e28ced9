"""Discrete white noise acceleration: the plant of the kinematic filter (SPEC §5, eqs. 3.1–3.3)."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.filters.state import FilterState
from mbkf.model.human import HumanModel


class WhiteAccelerationPlant:
    """q' = q ⊕ (v Δt + a Δt²/2), v' = v + a Δt with a white, constant over the step.

    Φ is exact on the manifold: its position rows are the derivatives of the retraction, which reduce to
    [[1, Δt], [0, 1]] for a translation.

    Attributes:
        model: The body.
        dt_s: Time step Δt.
        acceleration_sd: (nv,) σ_a of each dof; 0 holds a dof where it is.
    """

    def __init__(self, model: HumanModel, dt_s: float, acceleration_sd: Array) -> None:
        self.model, self.dt_s = model, dt_s
        self.acceleration_sd = acceleration_sd
        variance = acceleration_sd**2
        nv = model.nv
        self._noise = np.zeros((2 * nv, 2 * nv))
        index = np.arange(nv)
        self._noise[index, index] = variance * dt_s**4 / 4.0
        self._noise[index, nv + index] = self._noise[nv + index, index] = variance * dt_s**3 / 2.0
        self._noise[nv + index, nv + index] = variance * dt_s**2

    def transition(self, state: FilterState) -> Array:
        """(2 nv, 2 nv) Φ at a state."""
        nv, model = self.model.nv, self.model.pin_model
        step = state.v * self.dt_s
        phi = np.eye(2 * nv)
        phi[:nv, :nv] = pin.dIntegrate(model, state.q, step, pin.ARG0)
        phi[:nv, nv:] = pin.dIntegrate(model, state.q, step, pin.ARG1) * self.dt_s
        return phi

    def predict(self, state: FilterState, phi: Array) -> FilterState:
        """The state one step later; ``phi`` is :meth:`transition` at ``state``."""
        q = self.model.integrate(state.q, state.v * self.dt_s)
        return FilterState(q, state.v, phi @ state.P @ phi.T + self._noise)
