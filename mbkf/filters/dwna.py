"""Discrete white noise acceleration: the plant of the kinematic filter (SPEC §5, eqs. 3.1–3.3)."""

from __future__ import annotations

import numpy as np
from scipy.linalg import blas

from mbkf.conventions import Array
from mbkf.filters.state import FilterState
from mbkf.model.human import HumanModel


class WhiteAccelerationPlant:
    """q' = q ⊕ (v Δt + a Δt²/2), v' = v + a Δt with a white, constant over the step.

    Φ = [[A, B Δt], [0, 1]] is exact on the manifold: A and B are the derivatives of the retraction, which reduce to 1
    for a translation.

    Attributes:
        model: The body.
        dt_s: Time step Δt.
        acceleration_sd: (nv,) σ_a of each dof; 0 holds a dof where it is.
        position_noise, cross_noise, velocity_noise: (nv,) diagonals of the three blocks of the noise covariance.
    """

    def __init__(self, model: HumanModel, dt_s: float, acceleration_sd: Array) -> None:
        self.model, self.dt_s = model, dt_s
        self.acceleration_sd = acceleration_sd
        variance = acceleration_sd**2
        self.position_noise = variance * dt_s**4 / 4.0
        self.cross_noise = variance * dt_s**3 / 2.0
        self.velocity_noise = variance * dt_s**2

    def transition(self, state: FilterState) -> Array:
        """(2 nv, 2 nv) Φ at a state."""
        nv = self.model.nv
        phi = np.eye(2 * nv)
        phi[:nv, :nv], phi[:nv, nv:] = self.model.integration_derivatives(state.q, state.v * self.dt_s)
        phi[:nv, nv:] *= self.dt_s
        return phi

    def predict(self, state: FilterState) -> FilterState:
        """The state one step later; its P = Φ P Φᵀ + Q is exactly symmetric and in Fortran order."""
        nv, step = self.model.nv, state.v * self.dt_s
        A, B = self.model.integration_derivatives(state.q, step)
        # In Fortran order the second product with them takes half the time.
        rows = np.empty((nv, 2 * nv), order="F")
        rows[:, :nv] = A
        np.multiply(B, self.dt_s, out=rows[:, nv:])
        P = np.empty((2 * nv, 2 * nv))
        carried = np.matmul(rows, state.P.T, out=P[:nv])
        P[nv:, :nv] = carried[:, nv:].T
        half = blas.dgemm(0.5, rows, carried.T)
        np.add(half, half.T, out=P[:nv, :nv])
        P[nv:, nv:] = state.P[nv:, nv:]
        self._add_noise(P)
        return FilterState(self.model.integrate(state.q, step), state.v, P.T)

    def _add_noise(self, P: Array) -> None:
        """Adds Q along the diagonals of P's four blocks."""
        nv, every = self.model.nv, P.ravel()
        stride, half = 2 * nv + 1, 2 * nv * nv
        every[:half:stride] += self.position_noise
        every[nv:half:stride] += self.cross_noise
        every[half:-nv:stride] += self.cross_noise
        every[half + nv :: stride] += self.velocity_noise
