"""A followed trial in clinical coordinates, with standard deviations carried through the change of coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.tracking import Track
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel


@dataclass(frozen=True)
class ClinicalMotion:
    """Coordinates, rates and conjugate moments (T, A) with standard deviations; NaN where untracked."""

    names: tuple[str, ...]
    angles: Array
    rates: Array
    moments: Array
    angles_sd: Array
    rates_sd: Array
    moments_sd: Array
    singular: BoolArray


def clinical_motion(model: HumanModel, track: Track, tau: Array, sd_tau: Array) -> ClinicalMotion:
    """Coordinates θ, rates E v, moments Bᵀτ, and their spreads by the same linear maps.

    Args:
        model: The body.
        track: The followed trial.
        tau: (T, nv) generalised forces.
        sd_tau: (T, nv) their standard deviations.
    """
    clinical = ClinicalAngles(model)
    angles = clinical.angles(track.q)
    known = ~np.isnan(track.q).any(axis=1)
    shape = angles.shape
    rates, angles_sd, rates_sd, moments, variance = (np.full(shape, np.nan) for _ in range(5))
    q, theta = track.q[known], angles[known]
    E = clinical.rate_matrices(q, theta)
    rates[known] = np.einsum("tai,ti->ta", E, track.v[known])
    spread = np.einsum("tai,tij,taj->ta", E, track.position_covariance[known], E, optimize=True)
    angles_sd[known] = np.sqrt(np.maximum(spread, 0.0))
    rates_sd[known] = np.sqrt(np.einsum("tai,ti->ta", E**2, track.velocity_sd[known] ** 2))
    moments[known] = clinical.moments(q, tau[known], theta)
    variance[known] = _moment_variance(clinical, q, sd_tau[known], theta)
    singular = np.zeros(shape, dtype=bool)
    singular[known] = clinical.singular(theta)
    return ClinicalMotion(
        clinical.names, angles, rates, moments, angles_sd, rates_sd, np.sqrt(variance), singular
    )


def _moment_variance(clinical: ClinicalAngles, q: Array, sd_tau: Array, angles: Array) -> Array:
    """Σ B² sd² per joint, one axis of every joint at a time (no coordinate mixes two joints)."""
    axis = np.concatenate(
        [np.arange(joint.v.stop - joint.v.start) % 3 for joint in clinical.model.joints.values()]
    )
    by_axis = [clinical.moments(q, np.where(axis == one, sd_tau, 0.0), angles) for one in range(3)]
    return np.square(by_axis).sum(axis=0)
