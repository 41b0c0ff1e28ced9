"""A tracked trial in clinical coordinates, with standard deviations carried through the change of coordinates."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.record import Track
from mbkf.io.result_groups import Moments, Motion, Torques
from mbkf.model.angle_reading import AngleReading
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles, configuration_names, dof_names
from mbkf.model.clinical_table import opensim_zeros_rad, positive_senses
from mbkf.model.osim import osim_origin_m
from mbkf.trial.results.progression import LABORATORY, Progression, laboratory
from mbkf.trial.results.readings import AXES, STATIC

BLOCK = 1000
"""Frames treated at once."""


def clinical_motion(
    model: Body,
    track: Track,
    torques: Torques,
    frame: Progression | None = None,
    reading: AngleReading | None = None,
    zero_q: Array | None = None,
) -> tuple[Motion, Moments]:
    """Coordinates θ, rates E v, moments Bᵀτ, and their spreads by the same linear maps; NaN where untracked.

    The root's angles are given in the frame of progression; its position stays in the laboratory's axes. The heading
    counts as known. Where it turns, rates are those against the turning axes: E (v − ψ̇ e), with e the vertical.
    Moments stay about the body's own axes, in whatever axes angles are read.

    Args:
        model: The body.
        track: The tracked trial.
        torques: The generalised forces.
        frame: The frame of the root's angles; None: the laboratory's.
        reading: The axes of angles; None: the body's own.
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
    rates = np.full(shape, np.nan)
    q, v, theta = track.q[known], track.v[known], angles[known]
    if not in_laboratory:
        v = v.copy()
        v[:, clinical.root_turns] -= frame.turning_rad_s[known, None] * clinical.vertical(q)
    velocity_spreads = np.stack([track.sd_v[known], track.sd_v_offset[known]])
    rates[known], rate_spreads = _rates(clinical, q, theta, v, velocity_spreads)
    renewed = _renewed(clinical, in_laboratory)
    angles_sd, rates_sd = track.angle_sd.copy(), track.rate_sd.copy()
    angles_offset, rates_offset = track.angle_offset.copy(), track.rate_offset.copy()
    angles_change, rates_change = track.angle_change.copy(), track.rate_change.copy()
    rows = np.ix_(np.flatnonzero(known), renewed)
    if len(renewed):
        angles_sd[rows] = clinical.ball_spread(q, theta, track.ball_covariance[known])[:, renewed]
        angles_offset[rows] = clinical.ball_spread(q, theta, track.ball_offset[known])[:, renewed]
        rates_sd[rows], rates_offset[rows] = rate_spreads[..., renewed]
        for changes, before, after in (
            (angles_change, track.angle_offset, angles_offset),
            (rates_change, track.rate_offset, rates_offset),
        ):
            changes[rows] = _in_other_axes(changes[rows], before[rows], after[rows])
    own = ClinicalAngles(model)
    own_angles = theta if reading is None or not reading.joints else own.angles(seen)[known]
    singular = np.zeros(shape, dtype=bool)
    singular[known] = clinical.singular(theta)
    zero = 0.0 if zero_q is None else joint_angles(clinical, zero_q)
    motion = Motion(
        dof_names=dof_names(model),
        configuration_names=configuration_names(model),
        coordinate_names=clinical.names,
        angles=angles - zero,
        angles_sd=angles_sd,
        angles_sd_offset=angles_offset,
        angles_sd_change=angles_change,
        angle_rates=rates,
        angle_rates_sd=rates_sd,
        angle_rates_sd_offset=rates_offset,
        angle_rates_sd_change=rates_change,
        angles_lab=angles_lab - zero,
        singular=singular,
        heading_rad=frame.heading_rad,
        direction=frame.direction,
        angles_read=clinical.reading.name,
        opensim_origin_m=_opensim_origin(model),
        opensim_zeros_rad=opensim_zeros_rad(model.description.clinical_joints),
        positive_senses=positive_senses(model.description.clinical_joints),
        angles_zero=AXES if zero_q is None else STATIC,
    )
    return motion, _moments(own, track, torques, known, own_angles)


def _opensim_origin(model: Body) -> tuple[float, ...]:
    """OpenSim's origin of the root in the root's frame, of the person's size, m; empty where it is the root's own."""
    if model.description.clinical_joints[0].opensim_origin_m is None:
        return ()
    return tuple(float(one) for one in osim_origin_m(model))


def _moments(own: ClinicalAngles, track: Track, torques: Torques, known: BoolArray, angles: Array) -> Moments:
    """Moments conjugate to the coordinates, with their spreads.

    Args:
        own: The coordinates, read in the body's own axes.
        track: The tracked trial.
        torques: The generalised forces.
        known: (T,) frames with an estimate, K of them.
        angles: (K, A) their coordinates.
    """
    q, unknown = track.q[known], np.isnan(torques.sd_tau)
    offset, change = (np.where(unknown, np.nan, sd) for sd in (torques.sd_tau_offset, track.torque_change))
    moments, *spreads = (np.full((len(known), len(own.names)), np.nan) for _ in range(4))
    moments[known] = own.moments(q, torques.tau[known], angles)
    tau_sd = np.stack([one[known] for one in (torques.sd_tau, offset, change)])
    for spread, found in zip(spreads, own.moments_sd(q, tau_sd, angles), strict=True):
        spread[known] = found
    total, offset, change = spreads
    return Moments(moments=moments, moments_sd=total, moments_sd_offset=offset, moments_sd_change=change)


def joint_angles(clinical: ClinicalAngles, q: Array) -> Array:
    """(A,) angles of the joints in a posture (nq,), 0 for the root's coordinates."""
    angles = np.where(clinical.rotational, clinical.angles(q[None])[0], 0.0)
    angles[clinical.root_angles] = 0.0
    return angles


def _renewed(clinical: ClinicalAngles, in_laboratory: bool) -> Array:
    """Columns whose spreads the filter gives in other axes than those of the result."""
    if clinical.reading.joints:
        return clinical.ball_columns.ravel()
    return clinical.root_angles[:0] if in_laboratory else clinical.root_angles


def _in_other_axes(change: Array, offset: Array, other_offset: Array) -> Array:
    """(T, 3 n) change of the offset of n joints in other axes: the same share of each joint's offset.

    Args:
        change: (T, 3 n) change in the body's own axes.
        offset: (T, 3 n) offset there.
        other_offset: (T, 3 n) offset in the other axes.
    """
    joints = (len(change), -1, 3)
    changed, whole = (np.square(one).reshape(joints).sum(axis=2) for one in (change, offset))
    share = np.sqrt(changed / np.where(whole > 0.0, whole, 1.0))
    return np.asarray((other_offset.reshape(joints) * share[:, :, None]).reshape(change.shape))


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
