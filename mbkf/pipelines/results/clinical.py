"""A tracked trial in clinical coordinates, with standard deviations carried through the change of coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.tracking import Track
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles

BLOCK = 1000
"""Frames treated at once."""


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


def clinical_motion(model: Body, track: Track, tau: Array, tau_sd: Array) -> ClinicalMotion:
    """Coordinates θ, rates E v, moments Bᵀτ, and their spreads by the same linear maps.

    Args:
        model: The body.
        track: The tracked trial.
        tau: (T, nv) generalised forces.
        tau_sd: (T, nv) their standard deviations.
    """
    clinical = ClinicalAngles(model)
    angles = clinical.angles(track.q)
    known = ~np.isnan(track.q).any(axis=1)
    shape = angles.shape
    rates, moments, moments_sd = (np.full(shape, np.nan) for _ in range(3))
    q, theta = track.q[known], angles[known]
    rates[known] = _rates(clinical, q, theta, track.v[known])
    moments[known] = clinical.moments(q, tau[known], theta)
    moments_sd[known] = clinical.moments_sd(q, tau_sd[known], theta)
    singular = np.zeros(shape, dtype=bool)
    singular[known] = clinical.singular(theta)
    return ClinicalMotion(
        clinical.names, angles, rates, moments, track.angle_sd, track.rate_sd, moments_sd, singular
    )


def _rates(clinical: ClinicalAngles, q: Array, angles: Array, v: Array) -> Array:
    """(T, A) E v, some frames at a time, because E has (A, nv) numbers per frame."""
    blocks = [slice(first, first + BLOCK) for first in range(0, len(q), BLOCK)]
    return np.concatenate(
        [np.einsum("tai,ti->ta", clinical.rate_matrices(q[b], angles[b]), v[b]) for b in blocks]
    )
