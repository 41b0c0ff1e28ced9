"""Kalman updates in compressed form: any number of readings enters as n×n information and an n-vector."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from mbkf.conventions import Array


@dataclass(frozen=True)
class Information:
    """What a set of independent readings says about n state components.

    For innovations y with Jacobian H and noise R: ``matrix`` = HᵀR⁻¹H (n, n), ``vector`` = HᵀR⁻¹y (n,),
    ``innovation`` = yᵀR⁻¹y, ``readings`` = length of y.
    """

    matrix: Array
    vector: Array
    innovation: float
    readings: int

    def __add__(self, other: Information) -> Information:
        """Both sets of readings together."""
        return Information(
            self.matrix + other.matrix,
            self.vector + other.vector,
            self.innovation + other.innovation,
            self.readings + other.readings,
        )


@dataclass(frozen=True)
class Correction:
    """Result of an update: ``step`` (N,), ``covariance`` (N, N), ``gain_effect`` (N, n) and normalised innovation.

    ``gain_effect`` is K H restricted to the n observed components, so that I − K H can be formed.
    """

    step: Array
    covariance: Array
    gain_effect: Array
    nis: float


def information(innovation: Array, jacobian: Array, sd: Array) -> Information:
    """Compresses independent readings: y (m,), H (m, n), standard deviations (m,)."""
    scaled = jacobian / sd[:, None]
    whitened = innovation / sd
    return Information(scaled.T @ scaled, scaled.T @ whitened, float(whitened @ whitened), len(whitened))


def correct(covariance: Array, readings: Information) -> Correction:
    """Kalman update of a state whose first n of N components are observed.

    With Λ = HᵀR⁻¹H, b = HᵀR⁻¹y and Λ = G Gᵀ: P⁺ = P − W S⁻¹ Wᵀ, W = P G, S = I + Gᵀ P G, which equals the textbook
    update for every R (matrix inversion lemma) and keeps P symmetric positive.

    Args:
        covariance: (N, N) prior covariance P.
        readings: Information on the first n components.
    """
    n = len(readings.vector)
    root = _square_root(readings.matrix)
    columns = covariance[:, :n]
    W = columns @ root
    S = root.T @ W[:n]
    S[np.diag_indices_from(S)] += 1.0
    factor = scipy.linalg.cholesky(S, lower=True, check_finite=False)
    half = scipy.linalg.solve_triangular(factor, W.T, lower=True, check_finite=False)
    posterior = covariance - half.T @ half
    posterior = 0.5 * (posterior + posterior.T)
    step = posterior[:, :n] @ readings.vector
    nis = readings.innovation - float(readings.vector @ step[:n])
    return Correction(step, posterior, posterior[:, :n] @ readings.matrix, nis)


def _square_root(matrix: Array) -> Array:
    """(n, n) G with G Gᵀ = matrix, for a symmetric positive semidefinite matrix."""
    scale = float(np.trace(matrix)) / len(matrix)
    regular = matrix + (1e-13 * scale + 1e-300) * np.eye(len(matrix))
    try:
        return scipy.linalg.cholesky(regular, lower=True, check_finite=False)
    except scipy.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(matrix)
        return vectors * np.sqrt(np.maximum(values, 0.0))
