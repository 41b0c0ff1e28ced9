"""The next frame's markers where motion goes on steadily, for filters that cannot predict before they have read."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Estimate, Foresight
from mbkf.sensors.expectation import MarkerExpectation
from mbkf.sensors.markers import MarkerSensor


def steady_motion(estimate: Estimate, covariance: Array, sensor: MarkerSensor, dt_s: float) -> Foresight:
    """The frame after an estimate by steady velocity (eqs. 3.1–3.3).

    P⁻ = P_qq + Δt (P_qv + P_vq) + Δt² P_vv + Δt⁴/4 σ_a², with the body's own table of accelerations.

    Args:
        estimate: A posterior.
        covariance: (2 nv, 2 nv) its covariance P of (q, v).
        sensor: The markers on the body.
        dt_s: Time step Δt.
    """
    model, P = sensor.model, covariance
    nv = model.nv
    cross = dt_s * P[:nv, nv:]
    predicted: Array = P[:nv, :nv] + cross + cross.T + dt_s**2 * P[nv:, nv:]
    predicted[np.arange(nv), np.arange(nv)] += 0.25 * dt_s**4 * model.acceleration_sd**2
    q = model.integrate(estimate.q, dt_s * estimate.v)
    return Foresight(q, MarkerExpectation(sensor.reading(q), predicted), None)
