"""From a continuous linear error model ẋ = F x + w̃ to one step: transition Φ and plant-noise covariance (thesis 2.3.1).

F (n, n) is held constant over the step; w̃ is white with spectral density Σ (n, n), which is G Σᴾ Gᵀ of thesis eq. 2.46.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from mbkf.conventions import Array
from mbkf.errors import UnknownName

TAYLOR_TERMS, ROUNDING = 24, 1e-17
"""Series end when a term no longer counts; with ‖F h‖ ≤ 1 that is after some twenty terms."""


@dataclass(frozen=True)
class Discrete:
    """One step of the error: ``phi`` (n, n) transition and ``noise`` (n, n) covariance added by the plant."""

    phi: Array
    noise: Array

    def transition(self) -> Array:
        """(n, n) ``phi``."""
        return self.phi


def symmetric(matrix: Array) -> Array:
    """The symmetric part; rounding makes covariances a little lopsided."""
    return 0.5 * (matrix + matrix.T)


def first_order(F: Array, dt_s: float) -> Array:
    """Φ = I + F Δt (thesis eq. 3.51)."""
    return np.eye(len(F)) + dt_s * F


def second_order(F: Array, dt_s: float) -> Array:
    """Φ = I + F Δt + F² Δt²/2 (thesis eq. 3.52)."""
    return first_order(F, dt_s) + 0.5 * dt_s**2 * (F @ F)


def exponential(F: Array, dt_s: float) -> Array:
    """Φ = exp(F Δt) (thesis eq. 2.39), by Padé approximation."""
    phi: Array = scipy.linalg.expm(dt_s * F)
    return phi


def series_covariance(F: Array, density: Array, dt_s: float) -> Array:
    """Q = Σ Δt + (F Σ + Σ Fᵀ) Δt²/2 + F Σ Fᵀ Δt³/3, the plant noise with Φ = I + F Δt (thesis eq. 2.45).

    Args:
        F: (n, n) error dynamics, 1/s.
        density: (n, n) spectral density Σ of the noise.
        dt_s: Time step Δt.
    """
    carried = F @ density
    noise = density * dt_s + (carried + carried.T) * (dt_s**2 / 2.0) + carried @ F.T * (dt_s**3 / 3.0)
    return symmetric(noise)


def van_loan(F: Array, density: Array, dt_s: float) -> Discrete:
    """Exact Φ = exp(F Δt) and Q = ∫ exp(F s) Σ exp(Fᵀ s) ds, to rounding (thesis eqs. 2.43, 2.44).

    Van Loan reads both off exp([[−F, Σ], [0, Fᵀ]] Δt) = [[·, Φ⁻¹ Q], [0, Φᵀ]]. The same numbers come ten times
    cheaper from their Taylor series over h = Δt/2ᵏ on balanced states, Q = Σ hʲ⁺¹/(j+1)! Lʲ(Σ) with
    L(X) = F X + X Fᵀ, then k times two steps at once. Rows of zeros in F, constant states, are left out.

    Args:
        F: (n, n) error dynamics, 1/s.
        density: (n, n) spectral density Σ of the noise.
        dt_s: Time step Δt.
    """
    n = len(F)
    balanced, (scale, _) = scipy.linalg.matrix_balance(F, permute=False, separate=True)
    weight = scale[:, None] * scale
    size = max(dt_s * float(np.abs(balanced).sum(axis=0).max()), 1e-300)
    halvings = max(0, int(np.ceil(np.log2(size))))
    h = dt_s / 2.0**halvings
    live = np.flatnonzero(balanced.any(axis=1))
    step = h * balanced[live]
    inner = step[:, live]
    power, phi = step.copy(), np.eye(n)
    phi[live] += power
    term = (h / weight) * density
    noise = term.copy()
    for j in range(1, TAYLOR_TERMS):
        carried = np.zeros((n, n))
        carried[live] = step @ term
        term = (carried + carried.T) / (j + 1)
        noise += term
        power = inner @ power / (j + 1)
        phi[live] += power
        if np.abs(power).max(initial=0.0) < ROUNDING and np.abs(term).max() <= ROUNDING * np.abs(noise).max():
            break
    for _ in range(halvings):
        noise = symmetric(phi @ noise @ phi.T + noise)
        phi = phi @ phi
    return Discrete(phi * (scale[:, None] / scale), symmetric(noise * weight))


PROPAGATIONS: dict[str, Callable[[Array, float], Array]] = {
    "first": first_order,
    "second": second_order,
    "exponential": exponential,
}
"""Transition Φ as a function of F, by name."""

COVARIANCES = ("series", "van_loan")
"""Covariance of plant noise as a function of F and Σ, by name."""


def discretise(F: Array, density: Array, dt_s: float, propagation: str, covariance: str) -> Discrete:
    """One step of the error by the named methods.

    Args:
        F: (n, n) error dynamics, 1/s.
        density: (n, n) spectral density Σ of the noise.
        dt_s: Time step Δt.
        propagation: How Φ follows from F, one of :data:`PROPAGATIONS`.
        covariance: How Q follows from F and Σ, one of :data:`COVARIANCES`.

    Raises:
        UnknownName: The propagation or covariance does not exist.
    """
    if propagation not in PROPAGATIONS:
        raise UnknownName("propagation", propagation, PROPAGATIONS)
    if covariance not in COVARIANCES:
        raise UnknownName("plant-noise covariance", covariance, COVARIANCES)
    if covariance == "series":
        return Discrete(PROPAGATIONS[propagation](F, dt_s), series_covariance(F, density, dt_s))
    exact = van_loan(F, density, dt_s)
    return (
        exact if propagation == "exponential" else Discrete(PROPAGATIONS[propagation](F, dt_s), exact.noise)
    )
