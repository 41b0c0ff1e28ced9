"""Kalman updates in compressed form: any number of readings enters as n×n information and an n-vector.

At these sizes every call and copy counts, so BLAS and LAPACK are called directly; covariances come out in Fortran
order, which those take without a copy. All results are new arrays.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import blas, lapack

from mbkf.conventions import Array


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

    @property
    def gain_effect(self) -> Array:
        """(N, n) K H restricted to the n observed components, so that I − K H can be formed."""
        return self.covariance[:, : len(self.readings.vector)] @ self.readings.matrix


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


def informed(covariance: Array, matrix: Array) -> Array:
    """(N, N) posterior covariance after information Λ (n, n) on the first n of N components.

    With Λ = HᵀR⁻¹H = G Gᵀ and S = I + Gᵀ P G: P⁺ = P − P G S⁻¹ Gᵀ P, which equals the textbook update for every R
    (matrix inversion lemma) and keeps P symmetric positive.
    """
    n = len(matrix)
    return _reduced(covariance, blas.dgemm(1.0, covariance[:, :n], _informed_root(covariance, matrix)))


def informed_with_rows(covariance: Array, matrix: Array, rows: Array) -> Array:
    """(N, N) posterior covariance after :func:`informed` and readings with whitened Jacobian R^(-1/2) H.

    Both together take P − h₁ h₁ᵀ − h₂ h₂ᵀ in one product.

    Args:
        covariance: (N, N) prior covariance P.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; their values do not enter.
    """
    try:
        return _informed_with_rows(covariance, matrix, rows)
    except np.linalg.LinAlgError:
        return _informed_with_rows(made_positive(covariance), matrix, rows)


def made_positive(covariance: Array) -> Array:
    """The nearest symmetric matrix without negative eigenvalues, for a covariance that rounding has spoilt.

    Components are first brought to a common scale, which a state of metres, radians and newtons does not have.

    Raises:
        numpy.linalg.LinAlgError: It holds NaN or infinite numbers.
    """
    scale = np.sqrt(np.maximum(np.abs(np.diagonal(covariance)), 1e-300))
    correlation = covariance / scale / scale[:, None]
    values, vectors = np.linalg.eigh(0.5 * (correlation + correlation.T))
    positive = (vectors * np.maximum(values, 1e-12)) @ vectors.T * scale * scale[:, None]
    return np.asfortranarray(0.5 * (positive + positive.T))


def _informed_with_rows(covariance: Array, matrix: Array, rows: Array) -> Array:
    N, n, m = len(covariance), len(matrix), len(rows)
    if not m:
        return informed(covariance, matrix)
    halves = np.empty((N, n + m), order="F")
    # Columns of an array in Fortran order, so that BLAS writes into them.
    first, W = halves[:, :n], halves[:, n:]
    blas.dgemm(1.0, covariance[:, :n], _informed_root(covariance, matrix), c=first, overwrite_c=1)
    blas.dgemm(1.0, covariance, rows.T, c=W, overwrite_c=1)
    blas.dgemm(-1.0, first, blas.dgemm(1.0, first, rows.T, trans_a=1), beta=1.0, c=W, overwrite_c=1)
    _half(W, blas.dgemm(1.0, rows.T, W, trans_a=1))
    return _reduced(covariance, halves)


def informed_after_rows(covariance: Array, matrix: Array, rows: Array) -> Array:
    """The same as :func:`informed_with_rows`, one after the other: quicker where there are hardly ever rows.

    Args:
        covariance: (N, N) prior covariance P.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; the values do not enter.
    """
    if len(rows):
        W = blas.dgemm(1.0, covariance, rows.T)
        covariance = _reduced(covariance, _half(W, blas.dgemm(1.0, rows.T, W, trans_a=1)))
    return informed(covariance, matrix)


def informed_whole(covariance: Array, matrix: Array, rows: Array) -> Array:
    """The same from all readings as one information matrix, made exactly symmetric: slower, for any prior covariance.

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


def _informed_root(covariance: Array, matrix: Array) -> Array:
    """(n, n) G C⁻ᵀ with C Cᵀ = S, see :func:`informed`: P times it is the square root of the reduction of P."""
    n = len(matrix)
    root = _square_root(matrix)
    S = blas.dgemm(1.0, root, blas.dgemm(1.0, covariance[:n, :n], root), trans_a=1)
    return _half(root, S)


def _half(W: Array, S: Array) -> Array:
    """W C⁻ᵀ with C Cᵀ = I + S; overwrites S (m, m) and W (N, m), both in Fortran order."""
    S.ravel(order="K")[:: len(S) + 1] += 1.0
    factor, failed = lapack.dpotrf(S, lower=1, clean=0, overwrite_a=1)
    if failed:
        raise np.linalg.LinAlgError("the covariance is not positive")
    return blas.dtrsm(1.0, factor, W, side=1, lower=1, trans_a=1, overwrite_b=1)


def _reduced(covariance: Array, half: Array) -> Array:
    """P − h hᵀ, exactly symmetric if P is, in Fortran order."""
    reduction = (half @ half.T).T
    return np.subtract(covariance, reduction, out=reduction)


def _square_root(matrix: Array) -> Array:
    """(n, n) G with G Gᵀ = matrix, for a symmetric positive semidefinite matrix.

    Where some directions carry no information the Cholesky factor fails: components without information are
    then set aside, and if that is not enough the matrix is raised by its rounding.
    """
    # Which of the two triangles is read does not matter, and so no order needs a copy.
    root, failed = lapack.dpotrf(matrix if matrix.flags.f_contiguous else matrix.T, lower=1, clean=1)
    if not failed:
        return root
    diagonal = np.diagonal(matrix)
    silent = diagonal == 0.0
    for rounding in (0.0, 1e-13 * float(diagonal.mean())):
        regular = matrix + np.diag(np.where(silent, 1.0, rounding))
        root, failed = lapack.dpotrf(regular, lower=1, clean=1)
        if not failed:
            root[silent] = 0.0
            return root
    values, vectors = np.linalg.eigh(matrix)
    return vectors * np.sqrt(np.maximum(values, 0.0))
