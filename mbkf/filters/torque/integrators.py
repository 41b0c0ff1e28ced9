"""One time step of a forced body on its manifold: Euler, Heun, trapezoidal rule two ways, Runge–Kutta (thesis 3.2.2).

The forces u stay constant over the step. Configurations move by q ⊕ h v, so that quaternions stay unit ones; for
plain coordinates this is addition and the formulas are the thesis's own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.model.forced_body import ForcedBody

TOLERANCE = 1e-10
"""Iterations end when the velocity changes by less than this share of (1 + its largest component)."""

FIXED_POINT_ITERATIONS, NEWTON_ITERATIONS = 50, 10


@dataclass(frozen=True)
class Motion:
    """Configuration ``q`` and velocity ``v`` (nv,) of a body."""

    q: Array
    v: Array


Integrator = Callable[[ForcedBody, Motion, Array, float], Motion]
"""(body, motion at the beginning, forces u (nu,) constant over the step, step h in s) → the motion at its end."""


def _forward_euler(body: ForcedBody, now: Motion, u: Array, h: float) -> Motion:
    """z⁺ = z + ż h, ż⁺ = ż + z̈ h (thesis eq. 3.32), order 1."""
    return Motion(body.integrate(now.q, h * now.v), now.v + h * body.acceleration(now.q, now.v, u))


def _heun(body: ForcedBody, now: Motion, u: Array, h: float) -> Motion:
    """Mean of the rates here and where an Euler step leads (thesis eq. 3.34), order 2."""
    a = body.acceleration(now.q, now.v, u)
    ahead = Motion(body.integrate(now.q, h * now.v), now.v + h * a)
    a_ahead = body.acceleration(ahead.q, ahead.v, u)
    return Motion(body.integrate(now.q, 0.5 * h * (now.v + ahead.v)), now.v + 0.5 * h * (a + a_ahead))


def _trapezoidal_fixed_point(body: ForcedBody, now: Motion, u: Array, h: float) -> Motion:
    """Mean of the rates at both ends (thesis eq. 3.35), order 2; solved by repeating it."""
    a = body.acceleration(now.q, now.v, u)
    v = now.v + h * a
    for _ in range(FIXED_POINT_ITERATIONS):
        q = body.integrate(now.q, 0.5 * h * (now.v + v))
        better = now.v + 0.5 * h * (a + body.acceleration(q, v, u))
        settled = _settled(better - v, v)
        v = better
        if settled:
            break
    return Motion(body.integrate(now.q, 0.5 * h * (now.v + v)), v)


def _trapezoidal_newton(body: ForcedBody, now: Motion, u: Array, h: float) -> Motion:
    """The same rule (thesis eq. 3.35), solved by Newton's method in v⁺.

    g(v⁺) = v⁺ − v − h/2 (z̈ + z̈(q⁺, v⁺)) with q⁺ = q ⊕ h/2 (v + v⁺), so ∂g = I − h/2 (z̈_z D h/2 + z̈_ż), D the
    derivative of the retraction.
    """
    a = body.acceleration(now.q, now.v, u)
    v = now.v + h * a
    for _ in range(NEWTON_ITERATIONS):
        step = 0.5 * h * (now.v + v)
        q = body.integrate(now.q, step)
        there = body.linearise(q, v, u)
        slope = np.eye(body.nv) - 0.5 * h * (
            0.5 * h * there.by_q @ body.retraction(now.q, step)[1] + there.by_v
        )
        correction = _solved(slope, now.v + 0.5 * h * (a + there.a) - v)
        v = v + correction
        if _settled(correction, v):
            break
    return Motion(body.integrate(now.q, 0.5 * h * (now.v + v)), v)


def _runge_kutta(body: ForcedBody, now: Motion, u: Array, h: float) -> Motion:
    """Classical Runge–Kutta in the tangent space at q (Munthe-Kaas), order 4: ξ̇ = D(ξ)⁻¹ v, v̇ = z̈(q ⊕ ξ, v)."""

    def rate(xi: Array, v: Array) -> tuple[Array, Array]:
        q = body.integrate(now.q, xi)
        rate_of_xi = _solved(body.retraction(now.q, xi)[1], v)
        return rate_of_xi, body.acceleration(q, v, u)

    x1, v1 = rate(np.zeros(body.nv), now.v)
    x2, v2 = rate(0.5 * h * x1, now.v + 0.5 * h * v1)
    x3, v3 = rate(0.5 * h * x2, now.v + 0.5 * h * v2)
    x4, v4 = rate(h * x3, now.v + h * v3)
    xi = h / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4)
    return Motion(body.integrate(now.q, xi), now.v + h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4))


def _solved(matrix: Array, right: Array) -> Array:
    """Numpy's solver, which on a few unknowns takes a fraction of scipy's time."""
    return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)


def _settled(change: Array, v: Array) -> bool:
    return bool(np.abs(change).max() <= TOLERANCE * (1.0 + np.abs(v).max())) or not np.isfinite(change).all()


INTEGRATORS: dict[str, Integrator] = {
    "FE": _forward_euler,
    "HE": _heun,
    "TF": _trapezoidal_fixed_point,
    "TN": _trapezoidal_newton,
    "RK4": _runge_kutta,
}
"""Integrators by the thesis's names, and one of order 4."""


def integrator(name: str) -> Integrator:
    """The integrator of a name.

    Raises:
        UnknownName: The integrator does not exist.
    """
    if name not in INTEGRATORS:
        raise UnknownName("integrator", name, INTEGRATORS)
    return INTEGRATORS[name]
