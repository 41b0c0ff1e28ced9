"""Readings in compressed form: any number of them enters a Kalman update as n×n information and an n-vector.

Departs from thesis eq. 2.54, whose P − K H P loses symmetry to rounding: the posterior is (P⁻¹ + Λ)⁻¹, symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.information_update import informed


class Information(NamedTuple):
    """Information of a set of independent readings on n state components.

    For innovations y with Jacobian H and noise R: ``matrix`` = HᵀR⁻¹H (n, n), ``vector`` = HᵀR⁻¹y (n,),
    ``innovation`` = yᵀR⁻¹y, ``readings`` = length of y.
    """

    matrix: Array
    vector: Array
    innovation: float
    readings: int

    def __add__(self, other: Information) -> Information:  # type: ignore[override]
        """Both sets of readings together."""
        return Information(
            self.matrix + other.matrix,
            self.vector + other.vector,
            self.innovation + other.innovation,
            self.readings + other.readings,
        )

    def scaled(self, certainty: float) -> Information:
        """The same readings with their R divided by ``certainty``."""
        return Information(
            self.matrix * certainty, self.vector * certainty, self.innovation * certainty, self.readings
        )


@dataclass(frozen=True)
class Correction:
    """Result of an update: ``step`` (N,), ``covariance`` (N, N), normalised innovation, and the readings used."""

    step: Array
    covariance: Array
    nis: float
    readings: Information


def information(innovation: Array, jacobian: Array, sd: Array) -> Information:
    """Compresses independent readings.

    Args:
        innovation: (m,) innovations y.
        jacobian: (m, n) Jacobian H of the readings.
        sd: (m,) standard deviations of their noise.
    """
    scaled = jacobian / sd[:, None]
    whitened = innovation / sd
    return Information(scaled.T @ scaled, scaled.T @ whitened, float(whitened @ whitened), len(whitened))


def correct(covariance: Array, readings: Information) -> Correction:
    """Kalman update of a state whose first n of N components are observed.

    The step is P⁺ Hᵀ R⁻¹ y, with P⁺ by :func:`informed`, here made exactly symmetric.

    Args:
        covariance: (N, N) prior covariance P.
        readings: Information on the first n components.
    """
    n = len(readings.vector)
    posterior = informed_whole(covariance, readings.matrix, np.zeros((0, 0)))
    step = posterior[:, :n] @ readings.vector
    nis = readings.innovation - float(readings.vector @ step[:n])
    return Correction(step, posterior, nis, readings)


def informed_whole(covariance: Array, matrix: Array, rows: Array) -> Array:
    """(N, N) posterior covariance from all readings as one information matrix, made exactly symmetric.

    Slower than the other updates, and for any prior covariance.

    Args:
        covariance: (N, N) prior covariance P, symmetric up to rounding.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings, whatever was read.
    """
    if len(rows):
        total = rows.T @ rows
        total[: len(matrix), : len(matrix)] += matrix
        matrix = total
    posterior = informed(covariance, matrix)
    return 0.5 * (posterior + posterior.T)
