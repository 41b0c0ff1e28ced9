"""Covariance update in information form: P⁺ = (P⁻¹ + Λ)⁻¹ without inverting P, for any number of readings.

With Λ = G Gᵀ this is the textbook's update by readings H = Gᵀ whose noise is 1 (matrix inversion lemma):

    P⁺ = P − P G S⁻¹ Gᵀ P = P − h hᵀ,  h = P G C⁻ᵀ,  C Cᵀ = S = 1 + Gᵀ P G
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import blas, lapack

from mbkf.conventions import Array
from mbkf.numerics.positive import made_positive


def informed(covariance: Array, matrix: Array) -> Array:
    """(N, N) posterior covariance after information Λ (n, n) on the first n of N components.

    Raises:
        numpy.linalg.LinAlgError: The covariance is not positive.
    """
    h = _reduction(covariance, matrix)
    return np.asfortranarray(covariance - h @ h.T)


def informed_with_rows(covariance: Array, matrix: Array, rows: Array) -> Array:
    """(N, N) posterior covariance after :func:`informed` and readings with whitened Jacobian R^(-1/2) H.

    Args:
        covariance: (N, N) prior covariance P; the nearest positive one takes its place if rounding has spoilt it.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; their values do not enter.
    """
    try:
        return positive_informed(covariance, matrix, rows)
    except np.linalg.LinAlgError:
        return positive_informed(made_positive(covariance), matrix, rows)


def positive_informed(P: Array, matrix: Array, rows: Array) -> Array:
    """(N, N) as :func:`informed_with_rows`, for covariances that must not be mended.

    Args:
        P: (N, N) prior covariance.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings.

    Raises:
        numpy.linalg.LinAlgError: The covariance is not positive.
    """
    if not len(rows):
        return informed(P, matrix)
    h = _reduction(P, matrix)
    # Of the rows, from the covariance P - h h' that the information leaves.
    across = blas.dgemm(1.0, h, rows.T, trans_a=1)
    W = blas.dgemm(-1.0, h, across, beta=1.0, c=blas.dgemm(1.0, P, rows.T))
    both = np.asfortranarray(np.hstack([h, _divided(W, blas.dgemm(1.0, rows.T, W, trans_a=1))]))
    return np.asfortranarray(P - both @ both.T)


def _reduction(P: Array, matrix: Array) -> Array:
    """(N, n) h of information on the first n components."""
    n, G = len(matrix), _square_root(matrix)
    own = blas.dgemm(1.0, G, blas.dgemm(1.0, P[:n, :n], G), trans_a=1)
    return blas.dgemm(1.0, P[:, :n], _divided(G, own))


def _divided(W: Array, S: Array) -> Array:
    """(N, m) W C⁻ᵀ with C Cᵀ = 1 + S."""
    C, failed = lapack.dpotrf(S + np.eye(len(S)), lower=1)
    if failed:
        raise np.linalg.LinAlgError("the covariance is not positive")
    return blas.dtrsm(1.0, C, W, side=1, lower=1, trans_a=1)


def _square_root(matrix: Array) -> Array:
    """(n, n) G with G Gᵀ = matrix, for a symmetric positive semidefinite matrix.

    Components without information are set aside. Where other directions carry no information either, the Cholesky
    factor fails: the matrix is then raised by its rounding.
    """
    diagonal = np.diagonal(matrix)
    silent = None
    if np.count_nonzero(diagonal) < len(matrix):
        silent = diagonal == 0.0
        matrix = matrix + np.diag(np.where(silent, 1.0, 0.0))
    root, failed = lapack.dpotrf(matrix, lower=1, clean=1)
    if failed:
        level = float(diagonal.mean())
        root, failed = lapack.dpotrf(matrix + 1e-13 * level * np.eye(len(matrix)), lower=1, clean=1)
    if failed:
        values, vectors = np.linalg.eigh(matrix)
        root = vectors * np.sqrt(np.maximum(values, 0.0))
    if silent is not None:
        root[silent] = 0.0
    return root
