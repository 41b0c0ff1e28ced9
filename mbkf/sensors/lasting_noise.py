"""Lasting noise as white noise of equal weight for a slowly moving body.

A reading's error is r_k = w_k + c_k: w white with variance σ² − σ_c², c a Gauss–Markov process (Bryson & Henrikson
1968) with variance σ_c² and correlation time τ, ρ = e^(−Δt/τ). Its power at the angular frequency ω, per reading, is

    R(ω) = σ² − σ_c² + σ_c² (1 − ρ²) / (1 − 2 ρ cos ωΔt + ρ²)

A filter with white noise of the variance R(ω) weighs the readings by their errors at that frequency. At ω = 0 this is
σ² − σ_c² + σ_c² coth(Δt/2τ) ≈ σ² − σ_c² + 2 τ σ_c² / Δt, the variance of a mean of many readings times their number.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.sides import mirrored
from mbkf.sensors.marker_sensor import MarkerSensor

MOVEMENT_HZ = 0.5
"""Frequency at which noise is weighed: the slow end of everyday movement. At 0 Hz, a gait's quick turns of the ankle
are smoothed away; at 0.7 Hz, stated intervals are too narrow (synthetic walks)."""

LINE_M = 0.03
"""Least scatter of points about their best line that determines a segment's turn about it."""


def white_noise_m(
    noise_m: Array, correlated_m: Array, correlation_s: Array, dt_s: float, frequency_hz: float = 0.0
) -> Array:
    """(M,) standard deviation √R of the white noise of equal weight at a frequency, m.

    Args:
        noise_m: (M,) standard deviation of the whole noise, m.
        correlated_m: (M,) standard deviation of the lasting part, m.
        correlation_s: (M,) its correlation time, s; 0 for white noise.
        dt_s: Time between readings.
        frequency_hz: The frequency.
    """
    lasts = (correlated_m > 0.0) & (correlation_s > 0.0)
    rho = np.where(lasts, np.exp(-dt_s / np.where(lasts, correlation_s, 1.0)), 0.0)
    gain = (1.0 - rho**2) / (1.0 - 2.0 * rho * np.cos(2.0 * np.pi * frequency_hz * dt_s) + rho**2)
    return np.sqrt(noise_m**2 - correlated_m**2 + gain * correlated_m**2)


def prior_dilution(sensor: MarkerSensor, noise_m: Array, spread_m: Array) -> Array:
    """(nv,) factor on a prior that is read in every frame, so that it does not outweigh diluted markers.

    A frame of markers counts as (spread/noise)² of an independent reading, and so does a prior beside it. If the root's
    own points lie on a line, as the hips do, its tilt shows only by the bend of the trunk above it; that is all but
    straight, so that millimetres bend it by many degrees. The prior on the trunk then keeps its weight.

    Args:
        sensor: The markers on the body.
        noise_m: (M,) white noise of equal weight.
        spread_m: (M,) spread of one reading.
    """
    model = sensor.model
    factor = np.full(model.nv, float(np.sqrt(np.mean((noise_m / spread_m) ** 2))))
    root = model.roles.root
    places = sensor.local_m[[segment == root for segment in sensor.segments]]
    off_line_m = 0.0
    if len(places) > 2:
        scatter = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
        off_line_m = float(scatter[1]) / np.sqrt(len(places))
    if off_line_m < LINE_M:
        for segment in model.description.segments:
            if segment.parent == root and segment.name == mirrored(segment.name):
                factor[model.joint(segment.name).v] = 1.0
    return factor
