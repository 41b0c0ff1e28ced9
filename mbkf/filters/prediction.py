"""Where any filter expects the markers of the next frame: what a labeller needs between prediction and correction."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Estimate, Follower
from mbkf.sensors.expectation import MarkerExpectation
from mbkf.sensors.markers import MarkerSensor


def expected_markers(follower: Follower, estimate: Estimate, sensor: MarkerSensor) -> MarkerExpectation:
    """The markers one frame after an estimate, by steady velocity (eqs. 3.1–3.3), alike for every filter.

    P⁻ = P_qq + Δt (P_qv + P_vq) + Δt² P_vv + Δt⁴/4 σ_a², with the body's own table of accelerations.

    Args:
        follower: The filter that made the estimate.
        estimate: Its posterior of the frame before.
        sensor: The markers, on the filter's body.
    """
    dt, model = follower.dt_s, follower.model
    nv = model.nv

    def covariance() -> Array:
        P = follower.covariance(estimate)
        cross = dt * P[:nv, nv:]
        found: Array = P[:nv, :nv] + cross + cross.T + dt**2 * P[nv:, nv:]
        found[np.arange(nv), np.arange(nv)] += 0.25 * dt**4 * model.acceleration_sd**2
        return found

    q = model.integrate(estimate.q, dt * estimate.v)
    return MarkerExpectation(sensor.positions(q), lambda: sensor.reading(q), covariance)
