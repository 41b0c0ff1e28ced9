"""A tracked trial in clinical coordinates, with standard deviations carried through the change of coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.tracking import Track
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.pipelines.results.progression import LABORATORY, Progression, laboratory

BLOCK = 1000
"""Frames treated at once."""


@dataclass(frozen=True)
class ClinicalMotion:
    """Coordinates, rates and conjugate moments (T, A) with standard deviations; NaN where untracked.

    In ``angles_lab`` the root's angles are in the laboratory's axes, in the others in the frame of progression.
    """

    names: tuple[str, ...]
    angles_lab: Array
    angles: Array
    rates: Array
    moments: Array
    angles_sd: Array
    rates_sd: Array
    moments_sd: Array
    singular: BoolArray


def clinical_motion(
    model: Body, track: Track, tau: Array, tau_sd: Array, frame: Progression | None = None
) -> ClinicalMotion:
    """Coordinates θ, rates E v, moments Bᵀτ, and their spreads by the same linear maps.

    The root's angles are told in the frame of progression; its position stays in the laboratory's axes. The heading
    counts as known. Where it turns, rates are those against the turning axes: E (v − ψ̇ e), with e the vertical.

    Args:
        model: The body.
        track: The tracked trial.
        tau: (T, nv) generalised forces.
        tau_sd: (T, nv) their standard deviations.
        frame: The frame of the root's angles; the laboratory's when None.
    """
    frame = frame or laboratory(len(track.q))
    clinical = ClinicalAngles(model)
    in_laboratory = frame.direction == LABORATORY
    angles_lab = angles = clinical.angles(track.q)
    if not in_laboratory:
        angles = clinical.angles(clinical.against(frame.heading_rad, track.q))
    known = np.asarray(np.isfinite(track.q).all(axis=1))
    shape = angles.shape
    rates, moments, moments_sd = (np.full(shape, np.nan) for _ in range(3))
    angles_sd, rates_sd = track.angle_sd, track.rate_sd
    q, v, theta = track.q[known], track.v[known], angles[known]
    if not in_laboratory:
        angles_sd, rates_sd = _root_spread(clinical, track, known, theta)
        v = v.copy()
        v[:, clinical.root_turns] -= frame.turning_rad_s[known, None] * clinical.vertical(q)
    rates[known] = _rates(clinical, q, theta, v)
    moments[known] = clinical.moments(q, tau[known], theta)
    moments_sd[known] = clinical.moments_sd(q, tau_sd[known], theta)
    singular = np.zeros(shape, dtype=bool)
    singular[known] = clinical.singular(theta)
    return ClinicalMotion(
        clinical.names, angles_lab, angles, rates, moments, angles_sd, rates_sd, moments_sd, singular
    )


def _root_spread(
    clinical: ClinicalAngles, track: Track, known: BoolArray, angles: Array
) -> tuple[Array, Array]:
    """(T, A) spreads of angles and rates, the root's renewed for its known (n, A) angles."""
    angles_sd, rates_sd = track.angle_sd.copy(), track.rate_sd.copy()
    rows = np.ix_(np.flatnonzero(known), clinical.root_angles)
    E = clinical.root_rate_matrices(angles)
    covariance = track.root_covariance[known]
    angles_sd[rows] = np.sqrt(np.maximum(np.einsum("tai,tij,taj->ta", E, covariance, E), 0.0))
    rates_sd[rows] = np.sqrt(
        np.einsum("tai,ti->ta", E**2, track.velocity_sd[known][:, clinical.root_turns] ** 2)
    )
    return angles_sd, rates_sd


def _rates(clinical: ClinicalAngles, q: Array, angles: Array, v: Array) -> Array:
    """(T, A) E v, some frames at a time, because E has (A, nv) numbers per frame."""
    blocks = [slice(first, first + BLOCK) for first in range(0, len(q), BLOCK)]
    return np.concatenate(
        [np.einsum("tai,ti->ta", clinical.rate_matrices(q[b], angles[b]), v[b]) for b in blocks]
    )
