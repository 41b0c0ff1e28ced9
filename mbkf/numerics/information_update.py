"""Covariance update in information form: P⁺ = (P⁻¹ + Λ)⁻¹ without inverting P, for any number of readings.

With Λ = HᵀR⁻¹H = G Gᵀ and S = I + Gᵀ P G: P⁺ = P − P G S⁻¹ Gᵀ P, which equals the textbook update for every R (matrix
inversion lemma) and keeps P symmetric positive. At these sizes every call and copy counts, so BLAS and LAPACK are
called directly; covariances come out in Fortran order, which those take without a copy. All results are new arrays.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import blas, lapack

from mbkf.conventions import Array
from mbkf.numerics.positive import made_positive


def informed(covariance: Array, matrix: Array) -> Array:
    """(N, N) posterior covariance after information Λ (n, n) on the first n of N components."""
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

    Components that nothing informs about are set aside. Where other directions carry no information either, the
    Cholesky factor fails: the matrix is then raised by its rounding.
    """
    diagonal = np.diagonal(matrix)
    silent = None
    if np.count_nonzero(diagonal) < len(matrix):
        silent = diagonal == 0.0
        matrix = matrix + np.diag(np.where(silent, 1.0, 0.0))
    # Which of the two triangles is read does not matter, and so no order needs a copy.
    root, failed = lapack.dpotrf(matrix if matrix.flags.f_contiguous else matrix.T, lower=1, clean=1)
    if failed:
        level = float(diagonal.mean())
        root, failed = lapack.dpotrf(matrix + 1e-13 * level * np.eye(len(matrix)), lower=1, clean=1)
    if failed:
        values, vectors = np.linalg.eigh(matrix)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
    if silent is not None:
        root[silent] = 0.0
    return root
