"""Update of a covariance by the compiled kernel (``covariance.c``), or by the reference without it."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from mbkf.conventions import Array, Int32Array
from mbkf.kernel.loading import library
from mbkf.numerics import information_update


def joint_ranges(joints: Iterable[slice]) -> Int32Array:
    """(J, 2) first dof and end of each joint."""
    return np.array([(dofs.start, dofs.stop) for dofs in joints], dtype=np.int32)


def informed_with_rows(covariance: Array, matrix: Array, rows: Array, memory: Array | None = None) -> Array:
    """(N, N) as :func:`mbkf.numerics.information_update.informed_with_rows`, by the compiled kernel where there is one.

    The reference updates covariances that the kernel cannot factorise.

    Args:
        covariance: (N, N) prior covariance P.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; their values do not enter.
        memory: (N, N) array that may receive the answer.
    """
    kernel = library()
    if kernel is not None:
        informed = np.empty(covariance.shape) if memory is None else memory
        if kernel.add_information(covariance, matrix, np.ascontiguousarray(rows), informed) == 0:
            return informed.T
    return information_update.informed_with_rows(covariance, matrix, rows)


def correction(covariance: Array, vector: Array, rows: Array, values: Array) -> Array:
    """(N,) P (λ + Hᵀ y): the step of a mean by its readings.

    Args:
        covariance: (N, N) posterior covariance P, symmetric.
        vector: (n,) λ on the first n components.
        rows: (m, N) H, whitened.
        values: (m,) y, their innovations.
    """
    kernel = library()
    if kernel is not None:
        return kernel.correction(covariance, vector, rows, values)
    total = values @ rows
    total[: len(vector)] += vector
    return np.asarray(covariance @ total)


def positive_informed(covariance: Array, matrix: Array, rows: Array) -> Array:
    """(N, N) as :func:`informed_with_rows`, for covariances that must not be mended.

    Args:
        covariance: (N, N) prior covariance P.
        matrix: (n, n) information Λ on the first n components.
        rows: (m, N) whitened Jacobian of the other readings; their values do not enter.

    Raises:
        numpy.linalg.LinAlgError: The covariance is not positive.
    """
    kernel = library()
    if kernel is not None:
        informed = np.empty(covariance.shape)
        if kernel.add_information(covariance, matrix, np.ascontiguousarray(rows), informed) == 0:
            return informed.T
    return information_update.positive_informed(covariance, matrix, rows)
