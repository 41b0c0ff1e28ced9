"""Net moments of the trunk at levels of the spine of a tracked trial, top-down and bottom-up."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.record import Track
from mbkf.io.contacts import bearing
from mbkf.io.result_groups import TrunkMoments
from mbkf.model.body import Body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.newton_euler import ROOT
from mbkf.model.trunk_sections import WAYS, TrunkSections
from mbkf.trial.results.reactions import GroundReactions

AXES = "yxz"
"""Axes of a segment about which extension, bending and rotation turn."""


def trunk_moments(model: Body, track: Track, ground: GroundReactions) -> TrunkMoments:
    """The moments at the body's levels.

    Bottom-up they are given where plates read the load of every loaded foot and no other part below the level bears:
    elsewhere the loads below follow from the motion above, and would only say the same again.

    Args:
        model: The body.
        track: The tracked trial.
        ground: Loads on it, and the torques with them.
    """
    sections = TrunkSections(model)
    if not sections.levels:
        return TrunkMoments()
    own, support = ClinicalAngles(model), np.nan_to_num(track.support)
    residual = ground.torques.tau[:, :ROOT]
    above = [np.array(sections.bears_above(level)) for level in sections.levels]
    moments = np.full((len(track.q), len(WAYS), len(above), 3), np.nan)
    followed = np.asarray(np.isfinite(np.hstack([track.a, residual])).all(axis=1))
    carried = np.stack([support[:, one].sum(axis=1) for one in above], axis=1)
    motion = (track.q, track.v, track.a, carried, residual)
    moments[followed] = sections.moments(*(one[followed] for one in motion))
    bears = bearing(track.support)
    for k, one in enumerate(above):
        moments[~ground.judged | bears[:, ~one].any(axis=1), 1, k] = np.nan
    sd, offset = _spreads(track, moments)
    maps = _velocity_maps(own, {one.above for one in sections.levels}, track.q, followed)
    for k, level in enumerate(sections.levels):
        B = maps[level.above]
        moments[:, :, k] = np.einsum("tij,twi->twj", B, moments[:, :, k])
        for spread in (sd, offset):
            spread[:, :, k] = np.sqrt(np.einsum("tij,twi->twj", B**2, spread[:, :, k] ** 2))
    return TrunkMoments(
        level_names=sections.names,
        level_columns=tuple(level.column for level in sections.levels),
        trunk_moments=moments,
        trunk_moments_sd=sd,
        trunk_moments_sd_offset=offset,
    )


def _spreads(track: Track, moments: Array) -> tuple[Array, Array]:
    """Standard deviations of the moments, and the offset's part; NaN where a moment or its spread is not known."""
    unknown = np.where(np.isnan(moments), np.nan, 0.0)
    if track.level_sd is None or track.level_offset is None:
        return np.full(moments.shape, np.nan), np.full(moments.shape, np.nan)
    return track.level_sd + unknown, track.level_offset + unknown


def _velocity_maps(
    own: ClinicalAngles, segments: set[str], q: Array, followed: BoolArray
) -> dict[str, Array]:
    """(T, 3, 3) B of moments Bᵀ τ about extension, bending and rotation of segments' joints; NaN where untracked.

    Args:
        own: The coordinates, in the body's own axes.
        segments: The segments.
        q: (T, nq) configurations.
        followed: (T,) frames with an estimate.
    """
    known, joints = q[followed], own.model.joints.values()
    angles, axis = own.angles(known), np.concatenate([np.arange(j.v.stop - j.v.start) % 3 for j in joints])
    # No coordinate mixes two joints, so one axis of all joints is taken at a time.
    turned = (axis == np.arange(3)[:, None, None]).astype(float)
    by_axis = own.moments(known, np.broadcast_to(turned, (3, len(known), len(axis))), angles)
    maps = {}
    for segment in segments:
        (joint,) = (one for one in own.model.description.clinical_joints if one.distal == segment)
        columns = {angle.axis: own.names.index(angle.name) for angle in joint.angles}
        B = np.full((len(q), 3, 3), np.nan)
        for i, dof in enumerate(range(*own.model.joint(segment).v.indices(own.model.nv))):
            B[followed, i] = by_axis[axis[dof]][:, [columns[one] for one in AXES]]
        maps[segment] = B
    return maps
