"""Normalised innovation squared of a step in the filter's own P and R."""

from __future__ import annotations

import numpy as np

from mbkf.filters.filter import Step
from mbkf.filters.plant import StateT
from mbkf.numerics.kalman import correct


def nis(step: Step[StateT]) -> tuple[float, int]:
    """yᵀ (H P Hᵀ + R)⁻¹ y of instruments and laws, and how many readings those are; priors do not count."""
    (rows, values), known, P = step.readings.counted, step.readings.instruments, step.prior.state.P
    if not len(values):
        n = len(known.vector)
        return correct(P[:n, :n], known).nis, known.readings
    after = correct(P, known)
    innovation = values - rows @ after.step
    S = rows @ after.covariance @ rows.T + np.eye(len(rows))
    return after.nis + float(innovation @ np.linalg.solve(S, innovation)), known.readings + len(values)
