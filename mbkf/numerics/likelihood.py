"""Log-likelihood of a Kalman filter's innovations, from information form.

A frame's innovations y are drawn from N(0, S) with S = H P Hᵀ + R if the filter's model is right; then
log p(y) = −½ (yᵀ S⁻¹ y + log det S + m log 2π). Summed over frames it is the log-likelihood of
a filter's settings, which tuning maximises.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from mbkf.conventions import Array
from mbkf.numerics.kalman import Information

LOG_2_PI = math.log(2.0 * math.pi)


class LogLikelihood(NamedTuple):
    """In nats: of the ``readings`` compressed as information, and of the ``rows`` given those."""

    readings: float
    rows: float


def log_likelihood(
    covariance: Array,
    readings: Information,
    log_det_noise: float,
    rows: Array | None = None,
    values: Array | None = None,
    log_det_rows_noise: float = 0.0,
) -> LogLikelihood:
    """Of one frame's innovations, with the density of the unscaled readings.

    With Λ = Hᵀ R⁻¹ H and M = I + Λ P: det S = det M det R, and w = M⁻¹ Hᵀ R⁻¹ y gives
    yᵀ S⁻¹ y = yᵀ R⁻¹ y − yᵀ R⁻¹ H P w.
    Given the readings, whitened rows A have innovation a − A P w and covariance I + A P Aᵀ − A P M⁻¹ Λ P Aᵀ.

    Args:
        covariance: (N, N) prior P.
        readings: Information on the first n components.
        log_det_noise: log det R of those readings.
        rows: (k, N) rows R^(-1/2) H of further readings.
        values: (k,) their innovations R^(-1/2) y.
        log_det_rows_noise: log det R of the rows' readings.

    Raises:
        LinAlgError: The covariance is not finite or not positive.
    """
    n = len(readings.vector)
    P = covariance[:n, :n]
    M = np.eye(n) + readings.matrix @ P
    if not np.isfinite(M).all():
        raise np.linalg.LinAlgError("the covariance is not finite")
    factor = lu_factor(M, check_finite=False)
    w = lu_solve(factor, readings.vector, check_finite=False)
    nis = readings.innovation - float(readings.vector @ (P @ w))
    log_det = float(np.log(np.abs(np.diagonal(factor[0]))).sum())
    first = -0.5 * (nis + log_det + log_det_noise + readings.readings * LOG_2_PI)
    if rows is None or values is None or not len(rows):
        return LogLikelihood(first, 0.0)
    C = covariance[:n] @ rows.T
    S = rows @ (covariance @ rows.T) - C.T @ lu_solve(factor, readings.matrix @ C, check_finite=False)
    S[np.arange(len(S)), np.arange(len(S))] += 1.0
    L = np.linalg.cholesky(0.5 * (S + S.T))
    white = np.linalg.solve(L, values - C.T @ w)
    log_det = 2.0 * float(np.log(np.diagonal(L)).sum())
    second = -0.5 * (float(white @ white) + log_det + log_det_rows_noise + len(values) * LOG_2_PI)
    return LogLikelihood(first, second)
