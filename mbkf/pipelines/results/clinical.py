"""A tracked trial in clinical coordinates, with standard deviations carried through the change of coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.tracking import Track
from mbkf.model.angle_reading import AngleReading
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
    model: Body,
    track: Track,
    tau: Array,
    tau_sd: Array,
    frame: Progression | None = None,
    reading: AngleReading | None = None,
    zero_q: Array | None = None,
) -> ClinicalMotion:
    """Coordinates θ, rates E v, moments Bᵀτ, and their spreads by the same linear maps.

    The root's angles are told in the frame of progression; its position stays in the laboratory's axes. The heading
    counts as known. Where it turns, rates are those against the turning axes: E (v − ψ̇ e), with e the vertical.
    Moments stay about the body's own axes, in whatever axes angles are read.

    Args:
        model: The body.
        track: The tracked trial.
        tau: (T, nv) generalised forces.
        tau_sd: (T, nv) their standard deviations.
        frame: The frame of the root's angles; the laboratory's when None.
        reading: The axes that angles are read in; the body's own when None.
        zero_q: (nq,) posture in which the angles of joints are to be zero; the root's are not changed.
    """
    frame = frame or laboratory(len(track.q))
    clinical = ClinicalAngles(model, reading)
    in_laboratory = frame.direction == LABORATORY
    seen = track.q if in_laboratory else clinical.against(frame.heading_rad, track.q)
    angles_lab = angles = clinical.angles(track.q)
    if not in_laboratory:
        angles = clinical.angles(seen)
    known = np.asarray(np.isfinite(track.q).all(axis=1))
    shape = angles.shape
    rates, moments, moments_sd = (np.full(shape, np.nan) for _ in range(3))
    q, v, theta = track.q[known], track.v[known], angles[known]
    if not in_laboratory:
        v = v.copy()
        v[:, clinical.root_turns] -= frame.turning_rad_s[known, None] * clinical.vertical(q)
    rates[known], spread = _rates(clinical, q, theta, v, track.velocity_sd[known])
    renewed = _renewed(clinical, in_laboratory)
    angles_sd, rates_sd = track.angle_sd.copy(), track.rate_sd.copy()
    rows = np.ix_(np.flatnonzero(known), renewed)
    if len(renewed):
        angles_sd[rows] = clinical.ball_spread(q, theta, track.ball_covariance[known])[:, renewed]
        rates_sd[rows] = spread[:, renewed]
    own = ClinicalAngles(model)
    own_angles = theta if reading is None or not reading.joints else own.angles(seen)[known]
    moments[known] = own.moments(q, tau[known], own_angles)
    moments_sd[known] = own.moments_sd(q, tau_sd[known], own_angles)
    singular = np.zeros(shape, dtype=bool)
    singular[known] = clinical.singular(theta)
    zero = 0.0 if zero_q is None else _of_joints(clinical, zero_q)
    return ClinicalMotion(
        clinical.names,
        angles_lab - zero,
        angles - zero,
        rates,
        moments,
        angles_sd,
        rates_sd,
        moments_sd,
        singular,
    )


def _of_joints(clinical: ClinicalAngles, q: Array) -> Array:
    """(A,) angles of the joints in a posture (nq,), 0 for the root's coordinates."""
    angles = np.where(clinical.rotational, clinical.angles(q[None])[0], 0.0)
    angles[clinical.root_angles] = 0.0
    return angles


def _renewed(clinical: ClinicalAngles, in_laboratory: bool) -> Array:
    """Columns whose spreads the filter tells in other axes than they are read in."""
    if clinical.reading.joints:
        return clinical.ball_columns.ravel()
    return clinical.root_angles[:0] if in_laboratory else clinical.root_angles


def _rates(
    clinical: ClinicalAngles, q: Array, angles: Array, v: Array, velocity_sd: Array
) -> tuple[Array, Array]:
    """(T, A) E v and √(E² sd²), some frames at a time, because E has (A, nv) numbers per frame."""
    rates, spreads = [np.empty((0, len(clinical.names)))], [np.empty((0, len(clinical.names)))]
    for first in range(0, len(q), BLOCK):
        b = slice(first, first + BLOCK)
        E = clinical.rate_matrices(q[b], angles[b])
        rates.append(np.einsum("tai,ti->ta", E, v[b]))
        spreads.append(np.sqrt(np.einsum("tai,ti->ta", E**2, velocity_sd[b] ** 2)))
    return np.concatenate(rates), np.concatenate(spreads)
