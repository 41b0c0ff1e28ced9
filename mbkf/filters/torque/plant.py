"""The plant of the torque-state filters: x = [z, ż, T_e], forces a Wiener process (thesis eqs. 3.36–3.41).

ẋ = [ż, M⁻¹(Q_g + Bᵀ T_e), A T_e] + w̃, with A = 0 in the thesis. Serves any body of
:class:`mbkf.model.forced_body.ForcedBody`; the covariance lives in the tangent space (δz, δż, δT_e) of dimension
n = 2 nv + nu.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import pairwise
from typing import Protocol, cast

import numpy as np
import scipy.linalg

from mbkf.conventions import Array
from mbkf.filters.plant import Plant
from mbkf.filters.torque.integrators import INTEGRATORS, Motion, integrator
from mbkf.kernel.covariance import joint_ranges
from mbkf.kernel.forces import exact_step, light_step
from mbkf.model.body import Body
from mbkf.model.forced_body import ForcedBody, LinearAcceleration
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.model.layout import Layout, parted
from mbkf.numerics.discretisation import COVARIANCES, PROPAGATIONS, discretise, symmetric
from mbkf.numerics.forced_error import ForceDensity, ForcedRates, LightStep, forced_step
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


class ErrorStep(Protocol):
    """A step of the error, in any form."""

    def transition(self) -> Array:
        """(n, n) Φ."""


@dataclass(frozen=True)
class ForcedPrediction(ForcedState):
    """A predicted state with the ``steps`` of its error, one after the other, which a smoother needs."""

    steps: Sequence[ErrorStep]

    @cached_property
    def phi(self) -> Array:
        """(n, n) transition from the state before."""
        return _transition(self.steps)


LIGHT = (("first", "series"), ("second", "series"))
"""Propagations and covariances of a :class:`LightStep`."""

EXACT = ("exponential", "van_loan")
"""Propagation and covariance to rounding."""


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


NoiseDensity = Callable[[ForcedState], Array | ForceDensity]
"""The spectral density of w̃ at a state, (n, n) or by its parts: G Σᴾ Gᵀ of thesis eq. 2.46."""


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
        self._step_s = dt_s / max(1, scheme.substeps)
        self._fade: Array | None = None if drift is None else scipy.linalg.expm(self._step_s * drift)
        # Of blocks the forces are random walks; without a model a body has a dozen states: the dense form will do.
        self._compiled = drift is None and isinstance(body, HumanDynamics) and body.compiled is not None
        joints = model.joints.values() if self._compiled else ()
        self._joints = joint_ranges(joint.v for joint in joints)

    def sensitivity(self, v: Array, slope: LinearAcceleration) -> Array:
        """(n, n) F of the error (thesis eq. 3.40, simplified by thesis eq. 4.15).

        On the manifold the zero block ∂ż/∂z becomes the turning of the tangent space with the motion, which is
        kinematics and belongs to the simplified F as well.
        """
        turning, complete = self.body.transport(v), self.scheme.complete
        by_q, by_v = (slope.by_q, slope.by_v) if complete else (None, None)
        return self._whole(ForcedRates(turning, by_q, by_v, slope.by_u))

    def _whole(self, rates: ForcedRates) -> Array:
        """(n, n) F with the forces' own drift."""
        F = rates.matrix()
        if self.drift is not None:
            F[self.layout["u"], self.layout["u"]] = self.drift
        return F

    def spectral_density(self, state: ForcedState) -> Array:
        """(n, n) Σ of the plant noise at a state."""
        return _matrix(self.density(state))

    def noise(self, memory: None) -> None:
        """No memory: the noise depends on the state alone, and :meth:`predict` computes it there."""

    def move(self, state: ForcedState) -> ForcedState:
        """Motion and forces one frame later."""
        now, u = self._course(state)[-1]
        return ForcedState(now.q, now.v, u[: self.body.nu], state.P, given=state.given)

    def transition(self, state: ForcedState) -> Array:
        """(n, n) Φ at a state; a :class:`ForcedPrediction` holds that of its own step."""
        return self.predict(state).phi

    def step_transition(self, before: ForcedState, predicted: ForcedState) -> DenseTransition:
        """Φ that the prediction was made with."""
        return DenseTransition(cast("ForcedPrediction", predicted).phi)

    def predict(self, state: ForcedState, noise: None = None) -> ForcedPrediction:
        """The state one frame later (thesis eqs. 2.48, 2.49)."""
        density, course = self.density(state), self._course(state)
        P, steps, h = state.P, [], self._step_s
        for (now, u), (later, _) in pairwise(course):
            rates = self._rates(now, later, u)
            step, P = self._propagated(P, rates, density, h)
            steps.append(step)
        now, u = course[-1]
        return ForcedPrediction(now.q, now.v, u[: self.body.nu], P.T, steps, given=state.given)

    def _course(self, state: ForcedState) -> list[tuple[Motion, Array]]:
        """Motion and forces, given ones behind, at the beginning of a frame and after each of its parts."""
        now, u = Motion(state.q, state.v), state.forces
        course = [(now, u)]
        for _ in range(max(1, self.scheme.substeps)):
            now = self._advance(self.body, now, u, self._step_s)
            if self._fade is not None:
                own = len(self._fade)
                u = np.concatenate([self._fade @ u[:own], u[own:]])
            course.append((now, u))
        return course

    def _propagated(
        self, P: Array, rates: ForcedRates, density: Array | ForceDensity, h: float
    ) -> tuple[ErrorStep, Array]:
        """A step of the error, and the covariance after it.

        The whole body's goes by its blocks, and by the compiled kernel in FD's and FDMC's schemes; the textbook's
        dense form serves all else.
        """
        scheme = self.scheme
        if self._compiled and isinstance(density, ForceDensity):
            if rates.by_q is None and (scheme.propagation, scheme.covariance) in LIGHT:
                light = LightStep.of(rates, h, second=scheme.propagation == "second")
                return light, light_step(P, light, self._joints, density)
            if (scheme.propagation, scheme.covariance) == EXACT:
                exact = exact_step(P, rates, self._joints, density, h)
                if exact is not None:
                    return exact
            by_blocks = forced_step(rates, density, h, scheme.propagation, scheme.covariance)
            return by_blocks, by_blocks.propagated(P)
        step = discretise(self._whole(rates), _matrix(density), h, scheme.propagation, scheme.covariance)
        return step, symmetric(step.phi @ P @ step.phi.T + step.noise)

    def _rates(self, now: Motion, later: Motion, u: Array) -> ForcedRates:
        """F of a step by its blocks."""
        own = self._rates_at(now, u)
        return own.mean(self._rates_at(later, u)) if self.scheme.mean_slope else own

    def _rates_at(self, now: Motion, u: Array) -> ForcedRates:
        turning = self.body.transport(now.v)
        if not self.scheme.complete:
            return ForcedRates(turning, None, None, self.body.force_response(now.q))
        slope = self.body.linearise(now.q, now.v, u)
        return ForcedRates(turning, slope.by_q, slope.by_v, slope.by_u)


def _matrix(density: Array | ForceDensity) -> Array:
    return density.matrix() if isinstance(density, ForceDensity) else density


def _transition(steps: Sequence[ErrorStep]) -> Array:
    """(n, n) Φ of steps one after the other."""
    phi = steps[0].transition()
    for step in steps[1:]:
        phi = step.transition() @ phi
    return phi
