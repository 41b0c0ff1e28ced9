"""The plant of the torque-state filters: x = [z, ż, T_e], forces a Wiener process (thesis eqs. 3.36–3.41).

ẋ = [ż, M⁻¹(Q_g + Bᵀ T_e), A T_e] + w̃, with A = 0 in the thesis. Serves any body of
:class:`mbkf.model.forced_body.ForcedBody`; the covariance lives in the tangent space (δz, δż, δT_e) of dimension
n = 2 nv + nu.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import cast

import numpy as np
import scipy.linalg

from mbkf.conventions import Array
from mbkf.filters.plant import Plant
from mbkf.filters.torque.integrators import INTEGRATORS, Motion, integrator
from mbkf.model.body import Body
from mbkf.model.forced_body import ForcedBody, LinearAcceleration
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.model.layout import Layout, parted
from mbkf.numerics.discretisation import COVARIANCES, PROPAGATIONS, Discrete, discretise, symmetric
from mbkf.numerics.transition import DenseTransition


@dataclass(frozen=True)
class ForcedState:
    """Mean and covariance of a forced body: q, v (nv,), u = T_e (nu,), P (n, n) of (δq, δv, δu).

    Attributes:
        given: (12,) wrenches of right and left foot that are known inputs, as the body takes them, NaN for a foot of
            unknown wrench; (0,) where the wrenches are among u.
    """

    q: Array
    v: Array
    u: Array
    P: Array
    given: Array = field(default_factory=partial(np.zeros, 0), kw_only=True)

    @property
    def forces(self) -> Array:
        """u, followed by the given wrenches with 0 for unknown ones: all that moves the body."""
        return np.concatenate([self.u, np.nan_to_num(self.given)]) if len(self.given) else self.u

    def retracted(self, model: Body, step: Array, P: Array) -> ForcedState:
        """The state moved by a tangent vector.

        Args:
            model: The body.
            step: (n,) tangent vector.
            P: (n, n) covariance of the moved state.
        """
        q, v, u = parted(step, self.v, self.v, self.u)
        return ForcedState(model.integrate(self.q, q), self.v + v, self.u + u, P, given=self.given)

    def minus(self, model: Body, origin: ForcedState) -> Array:
        """(n,) tangent vector from the mean of another state to this one's."""
        return np.concatenate([model.difference(origin.q, self.q), self.v - origin.v, self.u - origin.u])


@dataclass(frozen=True)
class ForcedPrediction(ForcedState):
    """A predicted state with the transition ``phi`` (n, n) from the state before, which a smoother needs."""

    phi: Array


@dataclass(frozen=True)
class Scheme:
    """Discretisation of the plant.

    Attributes:
        integrator: "FE", "HE", "TF", "TN" or "RK4" (thesis eqs. 3.32–3.35).
        propagation: "first", "second" or "exponential" (thesis eqs. 3.51, 3.52, 2.39).
        covariance: "series" or "van_loan" (thesis eqs. 2.45, 2.43).
        complete: F keeps all derivatives (thesis eq. 3.40), else ∂z̈/∂T_e alone (thesis eq. 4.15).
        mean_slope: F is the mean of those at both ends of a step, else the one at its beginning.
        substeps: Equal parts a frame is cut into.
    """

    integrator: str = field(default="TN", metadata={"words": tuple(INTEGRATORS)})
    propagation: str = field(default="exponential", metadata={"words": tuple(PROPAGATIONS)})
    covariance: str = field(default="van_loan", metadata={"words": COVARIANCES})
    complete: bool = True
    mean_slope: bool = False
    substeps: int = 1


NoiseDensity = Callable[[ForcedState], Array]
"""The spectral density (n, n) of w̃ at a state: G Σᴾ Gᵀ of thesis eq. 2.46."""


class TorquePlant(Plant[ForcedState, None, None]):
    """Predicts mean and covariance of a forced body over one frame.

    Attributes:
        body: The body.
        layout: Slices of the tangent state: q, v and u; the feet's wrenches, where u ends in them, by a name of theirs.
        dt_s: Time between frames.
        density: Noise density, taken at the beginning of a frame.
        scheme: How it is discretised.
        drift: (nu, nu) A of u̇ = A u + w̃, for states with a correlation time; None for random walks. The motion
            sees u as it is at the beginning of a step.
    """

    def __init__(
        self,
        body: ForcedBody,
        dt_s: float,
        density: NoiseDensity,
        scheme: Scheme,
        drift: Array | None = None,
        *,
        wrenches: bool = False,
    ) -> None:
        """Makes the plant.

        Args:
            body: The body.
            dt_s: Time between frames.
            density: Noise density at a state.
            scheme: Discretisation of the plant.
            drift: (nu, nu) A of u̇ = A u + w̃; None for 0.
            wrenches: The last forces are the feet's wrenches.
        """
        layout = Layout.forced(body.nv, body.nu, wrenches)
        # A pendulum is its own manifold; blocks are for bodies with a model.
        model = body.model if isinstance(body, HumanDynamics) else cast("Body", body)
        super().__init__(model, layout, dt_s)
        self.body, self.density, self.scheme = body, density, scheme
        self.drift = drift
        self._advance = integrator(scheme.integrator)
        step_s = dt_s / max(1, scheme.substeps)
        self._fade: Array | None = None if drift is None else scipy.linalg.expm(step_s * drift)

    def sensitivity(self, v: Array, slope: LinearAcceleration) -> Array:
        """(n, n) F of the error (thesis eq. 3.40, simplified by thesis eq. 4.15).

        On the manifold the zero block ∂ż/∂z becomes the turning of the tangent space with the motion, which is
        kinematics and belongs to the simplified F as well.
        """
        q, v_, u = self.layout.q, self.layout.v, self.layout["u"]
        F = np.zeros((self.layout.size, self.layout.size))
        F[q, q] = self.body.transport(v)
        F[q, v_] = np.eye(self.body.nv)
        F[v_, u] = slope.by_u
        if self.scheme.complete:
            F[v_, q], F[v_, v_] = slope.by_q, slope.by_v
        if self.drift is not None:
            F[u, u] = self.drift
        return F

    def noise(self, memory: None) -> None:
        """No memory: the noise depends on the state alone, and :meth:`predict` computes it there."""

    def move(self, state: ForcedState) -> ForcedState:
        """Motion and forces one frame later."""
        now, u, _ = self._advanced(state)
        return ForcedState(now.q, now.v, u, state.P, given=state.given)

    def transition(self, state: ForcedState) -> Array:
        """(n, n) Φ at a state; a :class:`ForcedPrediction` holds that of its own step."""
        return self._advanced(state)[2].phi

    def step_transition(self, before: ForcedState, predicted: ForcedState) -> DenseTransition:
        """Φ that the prediction was made with."""
        return DenseTransition(cast("ForcedPrediction", predicted).phi)

    def predict(self, state: ForcedState, noise: None = None) -> ForcedPrediction:
        """The state one frame later (thesis eqs. 2.48, 2.49)."""
        now, u, whole = self._advanced(state)
        P = symmetric(whole.phi @ state.P @ whole.phi.T + whole.noise)
        return ForcedPrediction(now.q, now.v, u, P.T, whole.phi, given=state.given)

    def _advanced(self, state: ForcedState) -> tuple[Motion, Array, Discrete]:
        """Motion and forces one frame later, and the step of their error."""
        parts = max(1, self.scheme.substeps)
        h, density = self.dt_s / parts, self.density(state)
        now, u, given = Motion(state.q, state.v), state.u, np.nan_to_num(state.given)
        whole: Discrete | None = None
        for _ in range(parts):
            forces = np.concatenate([u, given]) if len(given) else u
            later = self._advance(self.body, now, forces, h)
            F = self._slope(now, later, forces)
            part = discretise(F, density, h, self.scheme.propagation, self.scheme.covariance)
            whole = part if whole is None else whole.then(part)
            now = later
            if self._fade is not None:
                u = self._fade @ u
        assert whole is not None
        return now, u, whole

    def _slope(self, now: Motion, later: Motion, u: Array) -> Array:
        F = self.sensitivity(now.v, self.body.linearise(now.q, now.v, u))
        if not self.scheme.mean_slope:
            return F
        return 0.5 * (F + self.sensitivity(later.v, self.body.linearise(later.q, later.v, u)))
