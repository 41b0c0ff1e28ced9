"""The plant of the torque-state filters: x = [z, ż, T_e], forces a Wiener process (thesis 3.2.3, eqs. 3.36–3.41).

ẋ = [ż, M⁻¹(Q_g + Bᵀ T_e), A T_e] + w̃, with A = 0 in the thesis. Serves any body of
:class:`mbkf.model.forced_body.ForcedBody`; the covariance lives in the tangent space (δz, δż, δT_e) of dimension
n = 2 nv + nu.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.filters.torque.integrators import Motion, integrator
from mbkf.model.forced_body import ForcedBody, LinearAcceleration
from mbkf.numerics.discretisation import Discrete, discretise, symmetric
from mbkf.numerics.kalman import Information, correct


@dataclass(frozen=True)
class ForcedState:
    """Mean and covariance of a forced body: q, v (nv,), u = T_e (nu,), P (n, n) of (δq, δv, δu)."""

    q: Array
    v: Array
    u: Array
    P: Array


@dataclass(frozen=True)
class ForcedPrediction:
    """A predicted ``state`` and the transition ``phi`` (n, n) from the state before, as a smoother needs them."""

    state: ForcedState
    phi: Array


@dataclass(frozen=True)
class Scheme:
    """How the plant is discretised.

    Attributes:
        integrator: "FE", "HE", "TF", "TN" or "RK4" (eqs. 3.32–3.35).
        propagation: "first", "second" or "exponential" (eqs. 3.51, 3.52, 2.39).
        covariance: "series" or "van_loan" (eqs. 2.45, 2.43).
        complete: Whether F keeps all derivatives (eq. 3.40) or ∂z̈/∂T_e alone (eq. 4.15).
        mean_slope: Whether F is the mean of those at both ends of a step rather than the one at its beginning.
        substeps: Equal parts a frame is cut into.
    """

    integrator: str = "TN"
    propagation: str = "exponential"
    covariance: str = "van_loan"
    complete: bool = True
    mean_slope: bool = False
    substeps: int = 1


NoiseDensity = Callable[[ForcedState], Array]
"""The spectral density (n, n) of w̃ at a state: G Σᴾ Gᵀ of eq. 2.46."""


class TorquePlant:
    """Predicts mean and covariance of a forced body over one frame.

    Attributes:
        body: The body.
        dt_s: Time between frames.
        density: Noise density, taken at the beginning of a frame.
        scheme: How it is discretised.
        drift: (nu, nu) A of u̇ = A u + w̃, for states that fade instead of wandering; None for 0. The motion sees u as
            it is at the beginning of a step.
    """

    def __init__(
        self,
        body: ForcedBody,
        dt_s: float,
        density: NoiseDensity,
        scheme: Scheme,
        drift: Array | None = None,
    ) -> None:
        self.body, self.dt_s, self.density, self.scheme = body, dt_s, density, scheme
        self.drift = drift
        self._advance = integrator(scheme.integrator)
        step_s = dt_s / max(1, scheme.substeps)
        self._fade: Array | None = None if drift is None else scipy.linalg.expm(step_s * drift)

    def sensitivity(self, v: Array, slope: LinearAcceleration) -> Array:
        """(n, n) F of the error (eq. 3.40, simplified by eq. 4.15).

        On the manifold the zero block ∂ż/∂z becomes the turning of the tangent space with the motion, which is
        kinematics and belongs to the simplified F as well.
        """
        nv, nu = self.body.nv, self.body.nu
        F = np.zeros((2 * nv + nu, 2 * nv + nu))
        F[:nv, :nv] = self.body.transport(v)
        F[:nv, nv : 2 * nv] = np.eye(nv)
        F[nv : 2 * nv, 2 * nv :] = slope.by_u
        if self.scheme.complete:
            F[nv : 2 * nv, :nv], F[nv : 2 * nv, nv : 2 * nv] = slope.by_q, slope.by_v
        if self.drift is not None:
            F[2 * nv :, 2 * nv :] = self.drift
        return F

    def predict(self, state: ForcedState) -> ForcedPrediction:
        """The state one frame later (eqs. 2.48, 2.49)."""
        parts = max(1, self.scheme.substeps)
        h, density = self.dt_s / parts, self.density(state)
        now, u = Motion(state.q, state.v), state.u
        whole: Discrete | None = None
        for _ in range(parts):
            later = self._advance(self.body, now, u, h)
            F = self._slope(now, later, u)
            part = discretise(F, density, h, self.scheme.propagation, self.scheme.covariance)
            whole = part if whole is None else whole.then(part)
            now = later
            if self._fade is not None:
                u = self._fade @ u
        assert whole is not None
        P = symmetric(whole.phi @ state.P @ whole.phi.T + whole.noise)
        return ForcedPrediction(ForcedState(now.q, now.v, u, P), whole.phi)

    def _slope(self, now: Motion, later: Motion, u: Array) -> Array:
        F = self.sensitivity(now.v, self.body.linearise(now.q, now.v, u))
        if not self.scheme.mean_slope:
            return F
        return 0.5 * (F + self.sensitivity(later.v, self.body.linearise(later.q, later.v, u)))


@dataclass(frozen=True)
class Updated:
    """A corrected ``state`` and the normalised innovation squared ``nis`` of what corrected it."""

    state: ForcedState
    nis: float


def update(body: ForcedBody, prior: ForcedState, readings: Information) -> Updated:
    """Kalman correction by information on (δq, δv, δu) (n), the same for every body and every sensor."""
    nv = body.nv
    correction = correct(prior.P, readings)
    step = correction.step
    q = body.integrate(prior.q, step[:nv])
    state = ForcedState(q, prior.v + step[nv : 2 * nv], prior.u + step[2 * nv :], correction.covariance)
    return Updated(state, correction.nis)


def on_state(size: int, columns: NDArray[np.int64], part: Information) -> Information:
    """Information on the state's ``columns`` as information on all ``size`` components."""
    matrix, vector = np.zeros((size, size)), np.zeros(size)
    matrix[np.ix_(columns, columns)], vector[columns] = part.matrix, part.vector
    return Information(matrix, vector, part.innovation, part.readings)
