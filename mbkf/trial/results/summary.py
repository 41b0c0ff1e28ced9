"""The key numbers of a reconstruction (summary.json): how well it fits, how consistent it is, how fast."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput
from mbkf.io.axes import axes_matrix
from mbkf.io.contacts import ContactInterval
from mbkf.io.dimensions import AXES
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.results import Reconstruction, SdPart
from mbkf.io.results_folder import (
    ContactTold,
    LimbDoubtTold,
    StatedAxes,
    Summary,
    TrunkTold,
    UnexplainedTold,
)
from mbkf.io.truth import Truth
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.model.human import HumanModel, reference_body
from mbkf.trial.results import innovations
from mbkf.trial.results.progression import kind_of

ROOT_DOFS = 6
_MM = 1e3


def summarise(reconstruction: Reconstruction, truth: Truth | None = None) -> Summary:
    """The contents of summary.json, as plain data; null where a number does not apply.

    Marker errors are distances, over samples that were seen and not hidden on purpose, in frames in which the
    body was tracked; samples the innovation gate refused count, too. ``missing_fraction`` is the share that the filter
    did not receive.

    Args:
        reconstruction: The results.
        truth: True motion of the synthetic subject; adds the object ``truth``.

    Returns:
        The keys of the command line's contract.
    """
    r = reconstruction
    missing = ~r.present
    seen_mm, hidden_mm = marker_errors(r)
    change = np.full((0, 1, 6), np.nan) if r.plate_change is None else r.plate_change
    peaks, sd, sd_offset, sd_varying = _torques(r)
    computing = float(np.nansum(r.step_seconds))
    weight_n = GRAVITY_M_S2 * float(r.subject.mass_kg)
    force_n, moment_nm = (_rms_of_norm(one[r.measured]) for one in (r.residual_force_n, r.residual_moment_nm))
    return {
        "trial": r.trial,
        "verdict": None if r.verdict is None else r.verdict.as_table(),
        "protocol": r.protocol,
        "filter": r.filter,
        "smoothed": bool(r.smoothed),
        "later_frames": r.later_frames,
        "version": r.version,
        "direction": r.direction,
        "progression": progression_summary(r.direction, r.heading_rad),
        "mass_kg": float(r.subject.mass_kg),
        "frames": r.frames,
        "rate_hz": float(r.rate_hz),
        "duration_s": r.frames / float(r.rate_hz),
        "markers_used": len(r.marker_names),
        "markers_ignored": dict(r.markers_ignored),
        "markers_explained": r.markers_explained,
        "names_exchanged": list(r.names_exchanged),
        "missing_fraction": float(missing.mean()) if missing.size else None,
        "marker_rms_mm": _rms(seen_mm),
        "marker_max_mm": _largest(seen_mm),
        "marker_rms_mm_by_name": {name: _rms(seen_mm[:, m]) for m, name in enumerate(r.marker_names)},
        "hidden_marker_rms_mm": _rms(hidden_mm),
        "hidden_marker_max_mm": _largest(hidden_mm),
        "residual_force_rms_n": force_n,
        "residual_moment_rms_nm": moment_nm,
        "residual_force_share": None if force_n is None else force_n / weight_n,
        "residual_lever_m": None if moment_nm is None else moment_nm / weight_n,
        "valid_frames": int(r.valid.sum()),
        "measured_frames": int(r.measured.sum()),
        "contacts": [contact_summary(one) for one in r.contacts],
        "unexplained": [unexplained_summary(one) for one in r.unexplained],
        "limb_doubts": [limb_doubt_summary(one) for one in r.limb_doubts],
        "plate_force_change_rms_n": _rms(change[..., :3]),
        "plate_moment_change_rms_nm": _rms(change[..., 3:]),
        "torque_peak_nm_per_kg": peaks,
        "torque_sd_nm": sd,
        "torque_sd_offset_nm": sd_offset,
        "torque_sd_varying_nm": sd_varying,
        "trunk_moments": trunk_summary(r),
        "nis_per_dof": innovations.per_reading(r),
        "nis": innovations.by_kind(r),
        "marker_noise_mm_by_name": innovations.marker_noise_mm(r),
        "step_seconds_median": quantile(r.step_seconds, 50),
        "step_seconds_p99": quantile(r.step_seconds, 99),
        "realtime_factor": r.frames / float(r.rate_hz) / computing if computing > 0 else None,
        "truth": None if truth is None else compare_with_truth(r, truth),
        "axes": stated_axes(r.file_axes, r.file_axes_source),
        "checks": [check.as_table() for check in r.checks],
        "warnings": list(r.warnings),
        "settings": dict(r.settings),
    }


def contact_summary(contact: ContactInterval) -> ContactTold:
    """A contact as summaries have it."""
    return {
        "part": contact.part,
        "from_s": contact.from_s,
        "to_s": contact.to_s,
        "peak_n": contact.peak_n,
        "sd_n": contact.sd_n if np.isfinite(contact.sd_n) else None,
        "how": contact.how,
    }


def unexplained_summary(load: UnexplainedLoad) -> UnexplainedTold:
    """An unexplained load as summaries have it."""
    return {
        "from_s": load.from_s,
        "to_s": load.to_s,
        "force_n": load.force_n,
        "sd_n": load.sd_n,
        "vector_n": list(load.vector_n),
        "direction": load.direction,
        "share_of_weight": load.share,
        "cause": load.cause,
        "hint": load.hint,
    }


def limb_doubt_summary(doubt: LimbDoubt) -> LimbDoubtTold:
    """A limb in doubt as summaries have it."""
    return {
        "limb": doubt.limb,
        "kind": doubt.kind,
        "from_s": doubt.from_s,
        "to_s": doubt.to_s,
        "joint": doubt.joint,
        "beyond_rad": doubt.beyond_rad,
        "misfit_m": doubt.misfit_m,
        "others_m": doubt.others_m,
        "mended": doubt.mended,
        "exchanged": [list(pair) for pair in doubt.exchanged],
        "right_from_s": doubt.right_from_s,
    }


def trunk_summary(r: Reconstruction) -> dict[str, TrunkTold]:
    """The trunk's extension moment by level of the spine, over tracked frames."""
    per_kg, found = 1.0 / float(r.subject.mass_kg), {}
    for level in r.level_names:
        down, up = (r.trunk_moment(level, way=way)[r.tracked] for way in AXES["way"].labels)
        sds = [_mean(r.trunk_moment_sd(level, way=way)[r.tracked]) for way in AXES["way"].labels]
        peaks = [_largest(np.abs(one) * per_kg) for one in (down, up)]
        told: TrunkTold = {
            "peak_nm_per_kg": peaks[0],
            "sd_nm": sds[0],
            "bottom_up_peak_nm_per_kg": peaks[1],
            "bottom_up_sd_nm": sds[1],
            "difference_rms_nm_per_kg": _rms((down - up) * per_kg),
        }
        found[level] = told
    return found


def stated_axes(axes: str, source: str) -> StatedAxes:
    """A capture's axes as summaries have them.

    Args:
        axes: Axes of the file that became x, y and z.
        source: Where that is known from.
    """
    forward, _, up = axes.split(",")
    mirrored = bool(np.linalg.det(axes_matrix(axes)) < 0.0)
    return {"up": up, "forward": forward, "mirrored": mirrored, "source": source}


def progression_summary(direction: str, heading_rad: Array | None) -> dict[str, str | float]:
    """Kind of the frame of the pelvis's angles, its mean heading in −180…180°, and how far it turns in all.

    Args:
        direction: Reference of the frame.
        heading_rad: (T,) its heading; None where it is not known.
    """
    heading = np.zeros(1) if heading_rad is None or not len(heading_rad) else heading_rad
    mean = np.arctan2(np.sin(heading).mean(), np.cos(heading).mean())
    return {
        "kind": kind_of(direction, heading),
        "heading_deg": float(np.rad2deg(mean)),
        "turned_deg": float(np.rad2deg(heading[-1] - heading[0])),
    }


def marker_errors(r: Reconstruction) -> tuple[Array, Array]:
    """(T, M) distances in mm of markers seen while the body was tracked, and of hidden ones; NaN for the others."""
    distance = _MM * np.linalg.norm(r.measured_m - r.predicted_m, axis=2)
    return np.where(r.present & r.tracked[:, None], distance, np.nan), np.where(r.hidden, distance, np.nan)


def _torques(r: Reconstruction) -> list[dict[str, float | None]]:
    """Flexion torque of every joint but the root by the joint's name: peak in N m/kg; mean deviations in N m."""
    main = main_coordinates(r)
    peaks = {joint: _largest(np.abs(r.moment(name)[r.tracked])) for joint, name in main.items()}
    parts: tuple[SdPart, ...] = ("total", "offset", "varying")
    spreads = [
        {joint: _mean(r.moment_sd(name, part)[r.tracked]) for joint, name in main.items()} for part in parts
    ]
    per_kg = {joint: None if peak is None else peak / r.subject.mass_kg for joint, peak in peaks.items()}
    return [per_kg, *spreads]


def main_coordinates(r: Reconstruction) -> dict[str, str]:
    """The coordinate of flexion of every joint but the root, by the joint's name."""
    return {
        j.name: j.main
        for j in reference_body(r.subject).clinical_joints
        if j.proximal != "world" and j.main in r.coordinate_names
    }


def compare_with_truth(reconstruction: Reconstruction, truth: Truth) -> dict[str, float | None]:
    """Errors against a synthetic subject's known motion, over tracked frames.

    Errors of posture are tangent vectors (``HumanModel.difference``), so no angle convention enters. Angles,
    velocities and torques are those of the joints, without the root's six dofs.

    Args:
        reconstruction: The results.
        truth: True motion, with at least the reconstruction's frames.

    Returns:
        ``angle_rms_deg``, ``velocity_rms_rad_s``, ``torque_rms_nm``, ``reaction_rms_n`` (per component of the
        feet's forces), ``nees_per_dof`` (of q and v together; None unless covariances were kept).

    Raises:
        InvalidInput: The truth does not cover the reconstruction's times, or belongs to another body.
    """
    r = reconstruction
    model = HumanModel.of(r.subject)
    if truth.q.shape[1] != model.nq or truth.v.shape[1] != model.nv:
        raise InvalidInput(f"the truth has {truth.v.shape[1]} dofs, the subject's body {model.nv}")
    rows = _matching_rows(r.times_s, truth.times_s, r.rate_hz)
    error_q = np.full(r.v.shape, np.nan)
    for t in np.flatnonzero(r.tracked & np.isfinite(r.q).all(axis=1)):
        error_q[t] = model.difference(r.q[t], truth.q[rows[t]])
    error_v = np.where(r.tracked[:, None], truth.v[rows] - r.v, np.nan)
    error_tau = np.where(r.tracked[:, None], truth.tau[rows] - r.tau, np.nan)
    error_force = np.where(
        r.tracked[:, None, None], (truth.foot_wrench[rows] - r.foot_wrench)[..., :3], np.nan
    )
    angle = _rms(error_q[:, ROOT_DOFS:])
    return {
        "angle_rms_deg": None if angle is None else float(np.rad2deg(angle)),
        "velocity_rms_rad_s": _rms(error_v[:, ROOT_DOFS:]),
        "torque_rms_nm": _rms(error_tau[:, ROOT_DOFS:]),
        "reaction_rms_n": _rms(error_force),
        "nees_per_dof": _nees_per_dof(r, np.hstack([error_q, error_v])),
    }


def _matching_rows(times_s: Array, truth_s: Array, rate_hz: float) -> Array:
    """(T,) row of the truth nearest to each time, at most half a frame away."""
    if not len(truth_s):
        raise InvalidInput("the truth holds no frames")
    right = np.clip(np.searchsorted(truth_s, times_s), 1, max(len(truth_s) - 1, 1))
    left = right - 1
    right = np.minimum(right, len(truth_s) - 1)
    rows = np.where(np.abs(truth_s[left] - times_s) <= np.abs(truth_s[right] - times_s), left, right)
    far = np.abs(truth_s[rows] - times_s) > 0.5 / rate_hz
    if far.any():
        raise InvalidInput(
            f"the truth has no frame at {times_s[far][0]:.3f} s; it belongs to another capture"
        )
    return rows


def _nees_per_dof(r: Reconstruction, error: Array) -> float | None:
    """Mean of eᵀ P⁻¹ e / n over frames; 1 for a consistent covariance."""
    if r.covariance is None:
        return None
    known = np.flatnonzero(np.isfinite(error).all(axis=1) & np.isfinite(r.covariance).all(axis=(1, 2)))
    e, P = error[known], r.covariance[known]
    try:
        weighted = np.linalg.solve(P, e[..., None])[..., 0]
    except np.linalg.LinAlgError:  # a dof without any uncertainty
        weighted = np.einsum("tij,tj->ti", np.linalg.pinv(P, hermitian=True), e)
    return _mean((e * weighted).sum(axis=1) / error.shape[1])


def _finite(values: Array) -> Array:
    return values[np.isfinite(values)]


def _rms(values: Array) -> float | None:
    known = _finite(values)
    return float(np.sqrt(np.mean(known**2))) if known.size else None


def _rms_of_norm(vectors: Array) -> float | None:
    return _rms(np.linalg.norm(vectors, axis=-1))


def _largest(values: Array) -> float | None:
    known = _finite(values)
    return float(known.max()) if known.size else None


def _mean(values: Array) -> float | None:
    known = _finite(values)
    return float(known.mean()) if known.size else None


def quantile(values: Array, percent: float) -> float | None:
    """A percentile of the finite values; None without any."""
    known = _finite(values)
    return float(np.percentile(known, percent)) if known.size else None
