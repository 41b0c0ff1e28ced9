"""One step of the error of a body moved by forces, by its blocks: (δq, δv) = x moves, forces δu are random walks.

    ẋ = A x + B δu,  A = [[T, 1], [K, D]],  B = [[0], [U]]     (thesis eq. 3.40; thesis eq. 4.15: K = D = 0)
    x⁺ = E x + G δu,  δu⁺ = δu

The same numbers as :mod:`mbkf.numerics.discretisation` of the whole F (n, n), n = 2 nv + nu, whose rows of δu are zero,
for a fraction of its products. Noise is white: a density per velocity, and one of the forces.
"""

from __future__ import annotations

from functools import cache
from typing import Literal, NamedTuple

import numpy as np
import scipy.linalg

from mbkf.conventions import Array
from mbkf.numerics.discretisation import Discrete, van_loan

TERMS, ROUNDING = 40, 1e-15
"""Series end when a term no longer counts."""

LARGEST = 5.0
"""Size of A Δt up to which the series is taken of a whole step; beyond, steps are halved (:func:`van_loan`)."""

_MOST = TERMS // 3 + 1


@cache
def gauss_rules() -> Array:
    """(most, most, 2) Gauss's rules of 1 to so many points, one a row: points in 0 … 1 and weights, 0 behind them."""
    rules = np.zeros((_MOST, _MOST, 2))
    for points in range(1, _MOST + 1):
        nodes, weights = np.polynomial.legendre.leggauss(points)
        rules[points - 1, :points] = np.stack([(nodes + 1.0) / 2.0, weights / 2.0], axis=1)
    return rules


class ForcedRates(NamedTuple):
    """F by its blocks.

    Attributes:
        turning: (nv, nv) T, how an error in q turns as the body moves.
        by_q, by_v: (nv, nv) K and D, derivatives of the acceleration; None in the simplified F.
        by_u: (nv, nu) U, derivative of the acceleration by the forces.
    """

    turning: Array
    by_q: Array | None
    by_v: Array | None
    by_u: Array

    def motion(self, order: Literal["C", "F"] = "C") -> Array:
        """(2 nv, 2 nv) A, in numpy's order of memory."""
        nv = len(self.turning)
        A = np.zeros((2 * nv, 2 * nv), order=order)
        A[:nv, :nv] = self.turning
        A[np.arange(nv), nv + np.arange(nv)] = 1.0
        if self.by_q is not None:
            A[nv:, :nv], A[nv:, nv:] = self.by_q, self.by_v
        return A

    def matrix(self) -> Array:
        """(n, n) F."""
        nv, nu = self.by_u.shape
        F = np.zeros((2 * nv + nu, 2 * nv + nu))
        F[: 2 * nv, : 2 * nv], F[nv : 2 * nv, 2 * nv :] = self.motion(), self.by_u
        return F

    def mean(self, other: ForcedRates) -> ForcedRates:
        """The mean of both, of the same blocks."""
        by_q, by_v = _half(self.by_q, other.by_q), _half(self.by_v, other.by_v)
        turning, by_u = 0.5 * (self.turning + other.turning), 0.5 * (self.by_u + other.by_u)
        return ForcedRates(turning, by_q, by_v, by_u)


def _half(a: Array | None, b: Array | None) -> Array | None:
    return None if a is None or b is None else 0.5 * (a + b)


class ForceDensity(NamedTuple):
    """Spectral density of plant noise: ``velocities`` (nv,) of each, ``forces`` (nu, nu); 0 in q."""

    velocities: Array
    forces: Array

    def matrix(self) -> Array:
        """(n, n) Σ."""
        nv = len(self.velocities)
        return np.asarray(scipy.linalg.block_diag(np.zeros((nv, nv)), np.diag(self.velocities), self.forces))


class MotionStep(NamedTuple):
    """Φ of a step: ``motion`` E (2 nv, 2 nv) and ``push`` G (2 nv, nu); forces stay."""

    motion: Array
    push: Array

    def transition(self) -> Array:
        """(n, n) Φ."""
        m, nu = self.push.shape
        phi = np.eye(m + nu)
        phi[:m, :m], phi[:m, m:] = self.motion, self.push
        return phi


class ForcedStep(NamedTuple):
    """A step of the error.

    Attributes:
        motion: (2 nv, 2 nv) E.
        push: (2 nv, nu) G.
        noise: (2 nv, 2 nv) covariance that the plant adds to x.
        cross: (2 nv, nu) to x and the forces.
        forces: (nu, nu) to the forces.
    """

    motion: Array
    push: Array
    noise: Array
    cross: Array
    forces: Array

    def transition(self) -> Array:
        """(n, n) Φ."""
        return MotionStep(self.motion, self.push).transition()

    def covariance(self) -> Array:
        """(n, n) Q."""
        return np.block([[self.noise, self.cross], [self.cross.T, self.forces]])

    def propagated(self, P: Array) -> Array:
        """(n, n) Φ P Φᵀ + Q of a symmetric P, exactly symmetric."""
        m = len(self.motion)
        rows = np.hstack([self.motion, self.push])
        carried = rows @ P
        after = np.empty(P.shape)
        own = carried @ rows.T
        own += self.noise
        after[:m, :m] = 0.5 * (own + own.T)
        after[:m, m:] = carried[:, m:] + self.cross
        after[m:, :m] = after[:m, m:].T
        forces = P[m:, m:] + self.forces
        after[m:, m:] = 0.5 * (forces + forces.T)
        return after


class LightStep(NamedTuple):
    """A step of the simplified F to the first or second order: Φ = [[A, B, p U], [0, 1, Δt U], [0, 0, 1]].

    Attributes:
        A, B: (nv, nv) derivatives of the next configuration by this one and by the velocity; zero between joints.
        by_u: (nv, nu) U.
        dt_s: Δt.
        push_s2: p, Δt²/2 or 0.
    """

    A: Array
    B: Array
    by_u: Array
    dt_s: float
    push_s2: float

    @classmethod
    def of(cls, rates: ForcedRates, dt_s: float, second: bool) -> LightStep:
        """Of a simplified F.

        Args:
            rates: F.
            dt_s: Time step.
            second: To the second order (thesis eq. 3.52), else the first (thesis eq. 3.51).
        """
        B, A = np.zeros(rates.turning.shape), dt_s * rates.turning
        if second:
            B += (0.5 * dt_s) * A
            A += 0.5 * (A @ A)
        for matrix, one in ((A, 1.0), (B, dt_s)):
            matrix.reshape(-1)[:: len(matrix) + 1] += one
        return cls(A, B, rates.by_u, dt_s, 0.5 * dt_s**2 if second else 0.0)

    def transition(self) -> Array:
        """(n, n) Φ."""
        nv, nu = self.by_u.shape
        phi = np.eye(2 * nv + nu)
        phi[:nv, :nv], phi[:nv, nv : 2 * nv], phi[:nv, 2 * nv :] = self.A, self.B, self.push_s2 * self.by_u
        phi[nv : 2 * nv, 2 * nv :] = self.dt_s * self.by_u
        return phi


def forced_step(
    rates: ForcedRates, density: ForceDensity, dt_s: float, propagation: str, covariance: str
) -> ForcedStep:
    """One step by the methods of :func:`mbkf.numerics.discretisation.discretise`.

    Args:
        rates: F, 1/s.
        density: Noise.
        dt_s: Time step.
        propagation: "first", "second" or "exponential".
        covariance: "series" or "van_loan".
    """
    A = rates.motion()
    if propagation == "exponential" or covariance == "van_loan":
        exact = _exact(A, rates.by_u, density, dt_s)
        if propagation == "exponential" and covariance == "van_loan":
            return exact
    E, G = exact[:2] if propagation == "exponential" else _taylor(A, rates.by_u, dt_s, propagation)
    noise = exact[2:] if covariance == "van_loan" else _series(A, rates.by_u, density, dt_s)
    return ForcedStep(E, G, *noise)


def _taylor(A: Array, U: Array, dt_s: float, propagation: str) -> tuple[Array, Array]:
    """E and G to the first or second order (thesis eqs. 3.51, 3.52)."""
    nv = len(U)
    E, G = dt_s * A, np.zeros((2 * nv, U.shape[1]))
    G[nv:] = dt_s * U
    if propagation == "second":
        half = 0.5 * dt_s
        G += half * (A[:, nv:] @ G[nv:])
        E = E + half * (A @ E)
    E.reshape(-1)[:: len(E) + 1] += 1.0
    return E, G


def _series(A: Array, U: Array, density: ForceDensity, dt_s: float) -> tuple[Array, Array, Array]:
    """Q by the series of thesis eq. 2.45."""
    nv, own, D = len(U), density.velocities, density.forces
    pushed = U @ D
    carried = A[:, nv:] * own
    noise, cross = np.zeros((2 * nv, 2 * nv)), np.zeros((2 * nv, U.shape[1]))
    noise[:, nv:] = (0.5 * dt_s**2) * carried
    noise += noise.T
    noise[nv:, nv:] += dt_s * np.diag(own) + (dt_s**3 / 3.0) * (pushed @ U.T)
    moving = own.nonzero()[0]
    if len(moving):
        noise += (dt_s**3 / 3.0) * (carried[:, moving] @ A[:, nv + moving].T)
    cross[nv:] = (0.5 * dt_s**2) * pushed
    return noise, cross, dt_s * D


def _exact(A: Array, U: Array, density: ForceDensity, dt_s: float) -> ForcedStep:
    """E = exp(A Δt), G and Q to rounding (thesis eqs. 2.39, 2.43).

    With W(s) the integral of exp(A t) [0; 1] over 0 … s, G(s) = W(s) U and the noise of x is the integral of
    W U Σ Uᵀ Wᵀ, by Gauss's rule on W's Taylor series; exp(A s) follows from W's derivative, its columns of v, and
    A exp = exp A.
    """
    nv, D = len(U), density.forces
    terms = _terms(A, dt_s)
    if terms is None:
        return _halved(A, U, density, dt_s)
    order, flat = np.arange(len(terms)), terms.reshape(len(terms), -1)
    nodes, weights = _gauss(len(terms), dt_s)
    W = terms.sum(axis=0).T
    E = np.empty(A.shape)
    E[:, nv:] = ((order + 1.0) / dt_s @ flat).reshape(nv, 2 * nv).T
    E[:, :nv] = A @ E[:, nv:] - E[:, nv:] @ A[nv:, nv:]
    pushed = U @ D
    at = ((nodes[:, None] ** (order + 1)) @ flat).reshape(len(nodes), nv, 2 * nv)
    loaded = (weights[:, None, None] * (pushed @ U.T)) @ at
    noise = at.reshape(-1, 2 * nv).T @ loaded.reshape(-1, 2 * nv)
    moving = density.velocities.nonzero()[0]
    if len(moving):
        powers = (order + 1.0) / dt_s * nodes[:, None] ** order
        own = np.tensordot(powers, terms[:, moving], axes=1)
        loaded = own * (weights[:, None] * density.velocities[moving])[:, :, None]
        noise += own.reshape(-1, 2 * nv).T @ loaded.reshape(-1, 2 * nv)
    cross = (dt_s / (order + 2.0) @ flat).reshape(nv, 2 * nv).T @ pushed
    return ForcedStep(E, W @ U, noise, cross, dt_s * D)


def _terms(A: Array, dt_s: float) -> Array | None:
    """(k, nv, 2 nv) transposed terms Aʲ [0; 1] Δtʲ⁺¹/(j + 1)! of W; None where A Δt is too large for one series."""
    nv, rows = len(A) // 2, np.abs(A).reshape(len(A), 2, -1).sum(axis=2)
    # Positions in units that make the norm least: [[T, 1], [K, D]] becomes [[T, s], [K / s, D]].
    size = dt_s * np.max([rows[:nv, 0].max() + 1.0, rows[nv:, 1].max(), np.sqrt(rows[nv:, 0].max())])
    if not size <= LARGEST:
        return None
    term = np.zeros((nv, 2 * nv))
    term.reshape(-1)[nv :: 2 * nv + 1] = dt_s
    found, step, enough = [term], (dt_s * A).T, (ROUNDING * dt_s**2) ** 2
    for j in range(1, TERMS):
        term = term @ step
        term *= 1.0 / (j + 1)
        found.append(term)
        if j % 2 and float(np.vdot(term, term)) <= enough:
            break
    return np.array(found)


def _gauss(terms: int, dt_s: float) -> tuple[Array, Array]:
    """Nodes in 0 … 1 and weights, s, of the integral over a step: so many that the error is rounding."""
    points = terms // 3 + 1
    nodes, weights = gauss_rules()[points - 1, :points].T
    return nodes, dt_s * weights


def _halved(A: Array, U: Array, density: ForceDensity, dt_s: float) -> ForcedStep:
    """The same from the whole F, by halved steps."""
    m = len(A)
    whole = ForcedRates(A[: m // 2, : m // 2], A[m // 2 :, : m // 2], A[m // 2 :, m // 2 :], U)
    found: Discrete = van_loan(whole.matrix(), density.matrix(), dt_s)
    return ForcedStep(
        found.phi[:m, :m], found.phi[:m, m:], found.noise[:m, :m], found.noise[:m, m:], found.noise[m:, m:]
    )
