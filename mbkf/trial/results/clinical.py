"""A tracked trial in clinical coordinates, with standard deviations carried through the change of coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.tracking import Track
from mbkf.model.angle_reading import AngleReading
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.trial.results.progression import LABORATORY, Progression, laboratory

BLOCK = 1000
"""Frames treated at once."""


@dataclass(frozen=True)
class ClinicalMotion:
    """Coordinates, rates and conjugate moments (T, A) with standard deviations; NaN where untracked.

    In ``angles_lab`` the root's angles are in the laboratory's axes, in the others in the frame of progression.
    ``…_offset`` is the part of a standard deviation that repeats in the same posture.
    """

    names: tuple[str, ...]
    angles_lab: Array
    angles: Array
    rates: Array
    moments: Array
    angles_sd: Array
    rates_sd: Array
    moments_sd: Array
    angles_offset: Array
    rates_offset: Array
    moments_offset: Array
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
    rates, moments, moments_sd, moments_offset = (np.full(shape, np.nan) for _ in range(4))
    q, v, theta = track.q[known], track.v[known], angles[known]
    if not in_laboratory:
        v = v.copy()
        v[:, clinical.root_turns] -= frame.turning_rad_s[known, None] * clinical.vertical(q)
    velocity_spreads = np.stack([track.velocity_sd[known], track.velocity_offset[known]])
    rates[known], rate_spreads = _rates(clinical, q, theta, v, velocity_spreads)
    renewed = _renewed(clinical, in_laboratory)
    angles_sd, rates_sd = track.angle_sd.copy(), track.rate_sd.copy()
    angles_offset, rates_offset = track.angle_offset.copy(), track.rate_offset.copy()
    rows = np.ix_(np.flatnonzero(known), renewed)
    if len(renewed):
        angles_sd[rows] = clinical.ball_spread(q, theta, track.ball_covariance[known])[:, renewed]
        angles_offset[rows] = clinical.ball_spread(q, theta, track.ball_offset[known])[:, renewed]
        rates_sd[rows], rates_offset[rows] = rate_spreads[..., renewed]
    own = ClinicalAngles(model)
    own_angles = theta if reading is None or not reading.joints else own.angles(seen)[known]
    moments[known] = own.moments(q, tau[known], own_angles)
    moments_sd[known] = own.moments_sd(q, tau_sd[known], own_angles)
    tau_offset = np.where(np.isnan(tau_sd), np.nan, track.torque_offset)
    moments_offset[known] = own.moments_sd(q, tau_offset[known], own_angles)
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
        angles_offset,
        rates_offset,
        moments_offset,
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
    clinical: ClinicalAngles, q: Array, angles: Array, v: Array, velocity_spreads: Array
) -> tuple[Array, Array]:
    """(T, A) E v and (S, T, A) √(E² sd²) of S spreads, some frames at a time, because E is large.

    Args:
        clinical: The coordinates.
        q: (T, nq) configurations.
        angles: (T, A) their coordinates.
        v: (T, nv) velocities.
        velocity_spreads: (S, T, nv) standard deviations of these, or parts of them.
    """
    width = len(clinical.names)
    rates, spreads = [np.empty((0, width))], [np.empty((len(velocity_spreads), 0, width))]
    for first in range(0, len(q), BLOCK):
        b = slice(first, first + BLOCK)
        E = clinical.rate_matrices(q[b], angles[b])
        rates.append(np.einsum("tai,ti->ta", E, v[b]))
        spreads.append(np.sqrt(np.einsum("tai,sti->sta", E**2, velocity_spreads[:, b] ** 2)))
    return np.concatenate(rates), np.concatenate(spreads, axis=1)
