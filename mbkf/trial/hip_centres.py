"""Hip centres as scaling knows them: their spread about the truth in a deep flexion, given the markers on the pelvis.

Pelvis markers that err by δm on the body put its pose wrong by the rigid displacement that fits −δm best, and with it a
hip centre, which errs by δh on the body itself. Scale factors, joint centres, marker places and displacements of the
skin, together p, have the covariance L Lᵀ, so that

    δ = (∂h/∂p − [I, −h×] (AᵀA)⁻¹ Aᵀ ∂m/∂p) δp,   A = rows [I, −m×].
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.joint_centres import centre_levers
from mbkf.model.subject_covariance import covariance_of
from mbkf.sensors.flexed_skin import FlexedSkin, slide_covariance

DEEP_DEG = 100.0
"""Flexion of hips and knees in a deep squat, degrees."""

LEAST_MARKERS = 3
"""Least number of markers on the pelvis that determine its pose."""

WITH_SQUAT_MM = 9.0
"""The spread with a walk and a deep squat beside standing: 9.1 and 8.8 mm of two persons, without them 28 mm."""


def hip_spread_m(subject: Subject, flexion_deg: float = DEEP_DEG) -> float | None:
    """RMS distance of the hip centres from their true places that scaling expects, m.

    Args:
        subject: The scaled person.
        flexion_deg: Flexion of both hips, degrees; 0 for standing.

    Returns:
        The distance; None for a body without legs, without covariance or with fewer than :data:`LEAST_MARKERS` markers
        on the pelvis.
    """
    model = HumanModel.of(subject)
    body, roles = model.description, model.roles
    known = covariance_of(subject, body)
    if known is None or not roles.knees:
        return None
    by_name = {marker.name: marker for marker in subject.markers}
    segments = [by_name[name].segment if name in by_name else "" for name in known.markers]
    own = [n for n, segment in enumerate(segments) if segment == roles.root]
    if len(own) < LEAST_MARKERS:
        return None
    rows = known.rows(known.markers, {}, slide_covariance(body, segments))
    sizes, moved = rows[: known.sizes], rows[known.sizes :].reshape(-1, len(segments), 3, rows.shape[1])
    shares = FlexedSkin(model, segments).shares(_flexed(model, flexion_deg))
    places = moved[0] + np.einsum("md,dmcr->mcr", shares, moved[1:])
    fitted = _rigid(np.array([by_name[known.markers[n]].position_m for n in own]))
    turned = -np.linalg.pinv(fitted) @ places[own].reshape(len(fitted), -1)
    pelvis, squared = body.segment(roles.root), []
    by_centres = dict(zip(model.joints, centre_levers(model, list(model.joints)), strict=True))
    for thigh, _ in roles.knees:
        reference = body.segment(thigh).origin_m
        centre = reference * (pelvis.scale_matrix @ model.scale)
        by_sizes = np.hstack([reference[:, None] * pelvis.scale_matrix, by_centres[thigh]])
        error = by_sizes @ sizes + _rigid(centre[None]) @ turned
        squared.append(float((error**2).sum()))
    return float(np.sqrt(np.mean(squared)))


def hip_note(subject: Subject) -> str:
    """Sentences on the hip centres of a person scaled without a deep flexion, and on the remedy."""
    spread_m = hip_spread_m(subject)
    known = (
        "" if spread_m is None else f"hip centres are uncertain by {1e3 * spread_m:.0f} mm (RMS) in a squat: "
    )
    reduced = "" if spread_m is None else f" and reduce this to about {WITH_SQUAT_MM:.0f} mm"
    return (
        f"{known}no deep flexion distinguishes skin that moves from the bones under it. A walk and a deep squat, or "
        f"getting up from a chair, do{reduced}: add them with --trial, or to the session's folder"
    )


def _flexed(model: HumanModel, flexion_deg: float) -> Array:
    """(nq,) both hips and knees flexed."""
    q = model.neutral()
    for thigh, shank in model.roles.knees:
        for segment, turn in ((thigh, -1.0), (shank, 1.0)):
            joint = model.joint(segment)
            dof = np.zeros(model.nv)
            dof[joint.v.start + (1 if joint.v.stop - joint.v.start > 1 else 0)] = turn * np.radians(
                flexion_deg
            )
            q = model.integrate(q, dof)
    return q


def _rigid(points_m: Array) -> Array:
    """(3 N, 6) derivatives of points (N, 3) by a displacement and a turn about the origin."""
    found = np.zeros((len(points_m), 3, 6))
    found[:, :, :3] = np.eye(3)
    x, y, z = points_m.T
    found[:, 0, 4], found[:, 0, 5] = z, -y
    found[:, 1, 3], found[:, 1, 5] = -z, x
    found[:, 2, 3], found[:, 2, 4] = y, -x
    return found.reshape(-1, 6)
