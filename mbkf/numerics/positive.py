"""Positive definite matrices: inverse, solution, elimination, and the nearest one to a spoilt covariance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from mbkf.conventions import Array


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


def inverse(matrix: Array) -> Array:
    """Inverse (n, n) of a symmetric positive definite matrix, by Cholesky: half the time of the general one.

    A matrix that rounding has made indefinite gets the general inverse.

    Raises:
        numpy.linalg.LinAlgError: It is singular.
    """
    root, failed = lapack.dpotrf(matrix.T, lower=1)
    if failed:
        return np.asarray(np.linalg.inv(matrix))
    found = np.asarray(lapack.dpotri(root, lower=1)[0])
    return np.asarray(np.tril(found) + np.tril(found, -1).T)


def regular_inverse(matrix: Array, least_pivot: float) -> Array | None:
    """Inverse (n, n) of a symmetric positive definite matrix, exactly symmetric; None where rounding would decide it.

    Args:
        matrix: (n, n).
        least_pivot: Least pivot of the matrix with its diagonal scaled to 1: the share of a component that those
            before it leave open.
    """
    diagonal = matrix.diagonal()
    if not (diagonal > 0.0).all():
        return None
    scale = 1.0 / np.sqrt(diagonal)
    scales = scale * scale[:, None]
    root, failed = lapack.dpotrf((matrix * scales).T, lower=1)
    if failed or not root.diagonal().min() ** 2 >= least_pivot:  # also of NaN
        return None
    found = np.tril(lapack.dpotri(root, lower=1)[0]) * scales
    return np.asarray(found + np.tril(found, -1).T)


def solved_with_spreads(matrix: Array, right: Array) -> tuple[Array, Array]:
    """Solution (n,) of a symmetric positive definite system, and the diagonal (n,) of the matrix's inverse.

    By Cholesky: half the time of the whole inverse. The general inverse serves where rounding has made it indefinite.

    Args:
        matrix: (n, n); its lower triangle is read.
        right: (n,).

    Raises:
        numpy.linalg.LinAlgError: It is singular.
    """
    root, failed = lapack.dpotrf(matrix, lower=1)
    if failed:
        whole = np.tril(matrix) + np.tril(matrix, -1).T
        found = np.asarray(np.linalg.inv(whole))
        return found @ right, np.diagonal(found)
    back = lapack.dtrtri(root, lower=1)[0].T  # rows are columns of the root's inverse
    return back @ (right @ back), np.einsum("ij,ij->i", back, back)


def whitened(matrix: Array, root: Array) -> Array:
    """(n, n) L⁻¹ A L⁻ᵀ of a symmetric matrix A, its lower triangle alone.

    Args:
        matrix: (n, n) A.
        root: (n, n) L, lower triangular.
    """
    return np.asarray(lapack.dsygst(matrix.T, root, lower=1)[0])


def eliminated(information: Array, unknowns: NDArray[np.intp]) -> Array:
    """Information (n - k, n - k) on the other unknowns where k of n are unknown, too: the inverse of their covariance.

    Args:
        information: (n, n) on all of them.
        unknowns: (k,) numbers of those to eliminate.

    Raises:
        numpy.linalg.LinAlgError: Nothing is known about one of them.
    """
    if not len(unknowns):
        return information
    others = np.delete(np.arange(len(information)), unknowns)
    across, alone = information[np.ix_(others, unknowns)], information[np.ix_(unknowns, unknowns)]
    return np.asarray(information[np.ix_(others, others)] - across @ np.linalg.solve(alone, across.T))
