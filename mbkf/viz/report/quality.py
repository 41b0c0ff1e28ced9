"""The report's first section: quality measures of the result, each with its bound and a verdict."""

from __future__ import annotations

from dataclasses import dataclass, replace
from html import escape

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, JsonTable
from mbkf.io.results import Reconstruction
from mbkf.numerics.printed import percent
from mbkf.trial.verdict.judge import verdict_of
from mbkf.trial.verdict.restated import unstated
from mbkf.viz.markup import grid, key, paragraph, section, table
from mbkf.viz.report.checks import findings_table
from mbkf.viz.report.marker_chart import CLASSES, LABELS, longest_gap_s, marker_chart, states
from mbkf.viz.svg import Line, chart, number

MARKER_RMS_MM, MARKER_MAX_MM = 15.0, 40.0
BAD_MARKER_RMS_MM = 25.0
"""Marker errors that are good, and from which an RMS is bad. Hicks et al. (J. Biomech. Eng. 137, 2015, 020905) accept
20 mm RMS and 40 mm at most for inverse kinematics, whose markers stay where they were put; here their places are fitted
to the trial, and 3 to 6 mm are usual."""

KEYPOINT_RMS, KEYPOINT_BAD_RMS, KEYPOINT_MAX = 2.0, 2.5, 6.0
"""The same bounds for keypoints, in units of their noise per coordinate: noise alone gives an RMS distance of 1.7."""

FORCE_SHARE, MOMENT_SHARE = 0.05, 0.01
"""Bounds of Hicks et al.: peak residual force over peak external force, peak residual moment over that force times the
height of the centre of mass."""

TRACKED_PERCENT, BAD_TRACKED_PERCENT = 99.9, 95.0
"""Frames in which the body was followed: good above the first, bad below the second."""

LEAST_EXPLAINED = 0.6
"""A smaller share of the capture's markers in the protocol means that the marker set is not understood."""

CENTRE_OF_MASS_SHARE = 0.55
"""Height of a standing person's centre of mass over body height."""

NIS_RANGE = (0.7, 1.4)
"""Normalised innovation squared per reading: 1 if readings err as they did just before."""

MOST_NAMED = 8
"""Most ignored markers that are named for each reason."""

MANY = 6
"""Number of remarks above which they stand in two columns."""

CORRECTING = ("torque",)
"""Filters that impose Newton's law on their estimates: their residual is one after correction."""

ESTIMATING = ("dynamic",)
"""Filters that estimate the residual as a state."""

GOOD, CARE, BAD, NONE = "good", "care", "bad", "none"


@dataclass(frozen=True)
class Verdict:
    """A number with its verdict: ``kind`` is "good", "care", "bad" or "none" (without a bound)."""

    title: str
    value: str
    kind: str
    remark: str


def quality_section(r: Reconstruction, summary: JsonTable, labels: JsonTable | None) -> str:
    """The section.

    Args:
        r: The reconstruction.
        summary: Its summary.json.
        labels: The JSON of ``mbkf label`` for the labelled file, or None.
    """
    ghosts = None if labels is None else labels.get("ghosts_per_frame")
    shown = set(np.unique(states(r)).tolist())
    legend = [(CLASSES[i], LABELS[i]) for i in range(len(CLASSES)) if i == 0 or i in shown]
    counted = None if ghosts is None or len(ghosts) != r.frames else np.array(ghosts, float)
    chart_of_markers = ("<h3>Markers</h3>", _labelling(labels), key(*legend), marker_chart(r, counted))
    return section(
        "quality",
        "Quality",
        findings_table(r.checks, verdict_of(r)),
        '<div class="tiles">' + "".join(_tile(v) for v in verdicts(r, summary)) + "</div>",
        f'<div class="beside"><div>{_flags(r)}</div>{_truth(summary)}</div>',
        grid(_curves(r), 3),
        *(chart_of_markers if r.marker_names else ()),
    )


def verdicts(r: Reconstruction, summary: JsonTable) -> list[Verdict]:
    """The main quality measures, each with its verdict.

    If the body does not fit the markers or was not tracked, its forces have no meaning: no other verdict is good then.
    """
    gap = float(longest_gap_s(r).max(initial=0.0))
    missing = summary.get("missing_fraction") or 0.0
    tracked = float(r.tracked.mean()) if r.frames else 0.0
    fit = [_markers(r, summary), _tracked(r, tracked), *_ignored(summary)]
    others = [*_unexplained(r), *_residuals(r, summary), _nis(summary)]
    if any(one.kind == BAD for one in fit):
        others = [_doubted(one) for one in others]
        fit = [_doubted(one) for one in fit]
    if not r.marker_names:
        return [*fit[1:], *others]
    longest = f"longest gap of one marker {gap:.2f} s"
    return [fit[0], *others, Verdict("Markers missing", percent(missing, 1), NONE, longest), *fit[1:]]


def _tracked(r: Reconstruction, share: float) -> Verdict:
    known, measured = int(r.valid.sum()), int(r.measured.sum())
    remark = f"all loads known in {known} of {r.frames} frames, measured in {measured}"
    kind = GOOD if 100.0 * share > TRACKED_PERCENT else CARE if 100.0 * share >= BAD_TRACKED_PERCENT else BAD
    return Verdict("Frames tracked", percent(share, 1), kind, remark)


def _ignored(summary: JsonTable) -> list[Verdict]:
    """Markers of the capture that were not used, if there are any."""
    ignored = summary.get("markers_ignored")
    if not ignored:
        return []
    explained = summary.get("markers_explained", 1.0)
    kind = BAD if explained < LEAST_EXPLAINED else CARE if explained < 1.0 else NONE
    listed = []
    for reason in dict.fromkeys(ignored.values()):
        names = [name for name in ignored if ignored[name] == reason]
        more = " …" if len(names) > MOST_NAMED else ""
        listed.append(f"{', '.join(names[:MOST_NAMED])}{more} ({reason})")
    remark = f"the protocol knows {percent(explained)} of the capture's markers; ignored: {'; '.join(listed)}"
    return [Verdict("Markers ignored", str(len(ignored)), kind, remark)]


def _doubted(verdict: Verdict) -> Verdict:
    """The verdict without a tick: the number belongs to a body that is not the one in the capture."""
    if verdict.kind != GOOD:
        return verdict
    remark = f"{verdict.remark}; has no meaning while markers or tracking are bad"
    return replace(verdict, kind=CARE, remark=remark)


def _markers(r: Reconstruction, summary: JsonTable) -> Verdict:
    rms, largest = summary.get("marker_rms_mm"), summary.get("marker_max_mm")
    if rms is None or largest is None:
        return Verdict("Marker error", "–", NONE, "no marker was tracked")
    noise = _keypoint_noise_mm(r)
    most, limit = max(MARKER_RMS_MM, KEYPOINT_RMS * noise), max(MARKER_MAX_MM, KEYPOINT_MAX * noise)
    good = rms <= most and largest <= limit
    kind = GOOD if good else CARE if rms <= max(BAD_MARKER_RMS_MM, KEYPOINT_BAD_RMS * noise) else BAD
    remark = f"RMS; largest {largest:.1f} mm. Good: {most:.0f} and {limit:.0f} mm"
    return Verdict("Marker error", f"{rms:.1f} mm", kind, remark)


def _keypoint_noise_mm(r: Reconstruction) -> float:
    """RMS of the stated noise per coordinate of keypoints; 0 for other markers."""
    used = [m for m in r.subject.markers if m.name in r.marker_names]
    if not any(marker.correlated_m for marker in used):
        return 0.0
    return 1e3 * float(np.sqrt(np.mean([marker.noise_m**2 for marker in used])))


def _unexplained(r: Reconstruction) -> list[Verdict]:
    """The largest force that no contact explains; nothing where plates read no foot."""
    if not r.unexplained:
        seen = np.isfinite(r.unexplained_force_n).all(axis=1)
        if not seen.any():
            return []
        share = np.abs(r.unexplained_force_n[seen]).max() / (r.subject.mass_kg * GRAVITY_M_S2)
        remark = (
            "of body weight at most over half a second, from positions and contacts alone; good: below 8 %"
        )
        return [Verdict("Unexplained force", percent(share, 1), GOOD, remark)]
    largest = max(r.unexplained, key=lambda one: one.force_n)
    more = f"; {len(r.unexplained) - 1} more below" if len(r.unexplained) > 1 else ""
    remark = f"{largest.direction}, {largest.from_s:.2f} to {largest.to_s:.2f} s{more}"
    return [Verdict("Unexplained force", f"{largest.force_n:.0f} N", BAD, remark)]


def _residuals(r: Reconstruction, summary: JsonTable) -> list[Verdict]:
    force, moment = summary.get("residual_force_rms_n"), summary.get("residual_moment_rms_nm")
    if force is None or moment is None:
        remark = "not known without frames in which plates measure every contact"
        return [Verdict(_residual(r, what), "–", NONE, remark) for what in ("force", "moment")]
    external = float(np.nanmax(np.linalg.norm(r.foot_wrench[r.measured, :, :3].sum(axis=1), axis=1)))
    centre_m = CENTRE_OF_MASS_SHARE * (r.subject.height_m or 1.75)
    found = []
    weight_n = GRAVITY_M_S2 * r.subject.mass_kg
    shares = (
        f"{percent(force / weight_n, 1)} of body weight",
        f"a lever of {1e3 * moment / weight_n:.0f} mm",
    )
    for what, rms, vectors, allowed, unit, share in (
        ("force", force, r.residual_force_n, FORCE_SHARE * external, "N", shares[0]),
        ("moment", moment, r.residual_moment_nm, MOMENT_SHARE * external * centre_m, "N m", shares[1]),
    ):  # fmt: skip
        peak = float(np.nanmax(np.linalg.norm(vectors[r.measured], axis=1)))
        remark = f"RMS at the pelvis, {share}; peak {peak:.1f} {unit}, in accepted practice below {allowed:.0f} {unit}"
        if r.filter in ESTIMATING:
            remark += "; the filter estimates it as a state"
        elif r.filter in CORRECTING:
            remark += "; the filter makes it small in any case: see the checks above"
        kind = GOOD if peak <= allowed else CARE
        found.append(Verdict(_residual(r, what), f"{rms:.1f} {unit}", kind, remark))
    return found


def _residual(r: Reconstruction, what: str) -> str:
    """Title of a residual; a filter that imposes Newton's law has corrected it."""
    return f"Residual {what}" + (" after correction" if r.filter in CORRECTING else "")


def _nis(summary: JsonTable) -> Verdict:
    """Innovations as a whole; by kind in the remark."""
    title, value = "Innovation (NIS)", summary.get("nis_per_dof")
    if value is None:
        return Verdict(title, "–", NONE, "not known")
    kinds = [f"{name.replace('_', ' ')} {nis:.2f}" for name, nis in (summary.get("nis") or {}).items()]
    remark = "per reading" + (f": {', '.join(kinds)}" if kinds else "")
    kind, meaning = GOOD, "1 in a coherent trial"
    if value > NIS_RANGE[1]:
        kind, meaning = CARE, "above 1: readings err more than just before"
    elif value < NIS_RANGE[0]:
        kind, meaning = NONE, "below 1: readings err less than expected"
    return Verdict(title, f"{value:.2f}", kind, f"{remark}; {meaning}")


def _tile(v: Verdict) -> str:
    sign = {GOOD: "✓", CARE: "!", BAD: "✗", NONE: ""}[v.kind]
    title = {GOOD: "as it should be", CARE: "check it", BAD: "not usable as it is", NONE: ""}[v.kind]
    mark = f'<i title="{title}">{sign}</i>' if sign else ""
    return (
        f'<div class="tile {v.kind}"><span>{escape(v.title)}{mark}</span><b>{escape(v.value)}</b>'
        f"<small>{escape(v.remark)}</small></div>"
    )


def _flags(r: Reconstruction) -> str:
    remarks = unstated(r.warnings, verdict_of(r))
    if not remarks:
        return paragraph("No remarks.")
    items = "".join(f"<li>{escape(text)}</li>" for text in remarks)
    many = " many" if len(remarks) > MANY else ""
    return f'<h3>Remarks</h3><ul class="flags{many}">{items}</ul>'


def _truth(summary: JsonTable) -> str:
    truth = summary.get("truth")
    if not truth:
        return ""
    names = {
        "angle_rms_deg": ("posture, per dof", "°"),
        "velocity_rms_rad_s": ("velocity", "rad/s"),
        "torque_rms_nm": ("torque", "N m"),
        "reaction_rms_n": ("reaction", "N"),
        "nees_per_dof": ("error² / stated variance (1 is right)", ""),
    }
    rows = [(text, f"{truth[name]:.3g} {unit}") for name, (text, unit) in names.items() if truth.get(name)]
    found = table(("RMS error of", ""), rows, "small")
    return f"<div><h3>Against the known truth (synthetic capture)</h3>{found}</div>"


def _curves(r: Reconstruction) -> list[str]:
    t = r.times_s
    if not r.frames:
        return []
    span = (float(t[0]), float(max(t[-1], t[0] + 1e-3)))
    per_reading = np.where(r.nis_readings > 0, r.nis / np.maximum(r.nis_readings, 1), np.nan)
    error = 1e3 * np.linalg.norm(r.measured_m - r.predicted_m, axis=2)
    counted = r.present & r.tracked[:, None]
    mean_square = np.where(counted, error**2, 0.0).sum(axis=1) / np.maximum(counted.sum(axis=1), 1)
    rms = np.where(counted.any(axis=1), np.sqrt(mean_square), np.nan)
    weight = r.subject.mass_kg * GRAVITY_M_S2
    error_curve = chart("Marker error, RMS over markers", "mm", [Line(t, rms)], span, "s")
    innovation = chart("Innovation squared per reading", "", [Line(t, per_reading)], span, "s", level=1.0)
    found = [error_curve, innovation] if r.marker_names else [innovation]
    force = np.where(r.measured, np.linalg.norm(r.residual_force_n, axis=1), np.nan)
    if np.isfinite(force).any():
        title, note = f"{_residual(r, 'force')}, at the pelvis", f"body weight is {number(weight, 0)} N"
        found.insert(-1, chart(title, "N", [Line(t, force)], span, "s", note=note))
    return found


def _labelling(labels: JsonTable | None) -> str:
    if labels is None:
        return ""
    text = (
        f"Labelled by mbkf from points without names: {percent(labels.get('assigned_fraction', 0.0), 2)} of "
        f"marker-frames assigned, {labels.get('ghosts_dropped', 0)} ghost points dropped, "
        f"{labels.get('swaps_repaired', 0)} swaps repaired."
    )
    if labels.get("correct_fraction") is not None:
        text += (
            f" Against the known labels: {percent(labels['correct_fraction'], 3)} correct, "
            f"{percent(labels['wrong_fraction'], 3)} wrong, {percent(labels['missed_fraction'], 3)} missed."
        )
    return paragraph(text)
