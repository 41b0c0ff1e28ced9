"""Rows of the campaign: divergences, what failed, stated errors against truth by motion, and the worst trials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.campaign.trials import Error, Outcome
from benchmarks.checks import Check, information, within
from benchmarks.intervals.cells import CELL_NEES, COVER_PERCENT, MEAN_NEES
from benchmarks.intervals.trials import QUANTITIES

FAR_DEG, TOLD_SD, ANYHOW_DEG = 10.0, 3.0, 45.0
"""A joint angle has diverged that errs by more than 10° (RMS of a trial) and more than 3 of its stated standard
deviations, or by more than 45° whatever is stated. Toes and forearms carry their markers 3 to 5 cm apart: skin of 5 mm
turns them by more than 10°, and the filter says so."""

LEAST_TRACKED = 0.9
"""Share of the frames with markers that is tracked."""

WORST = 10


def diverged(error: Error) -> bool:
    """Whether some joint angle is no longer that of the person."""
    finite = np.isfinite(error.angle_rms_deg)
    untold = (error.angle_rms_deg > FAR_DEG) & ~(error.angle_doubt <= TOLD_SD)
    return bool((~finite | untold | (error.angle_rms_deg > ANYHOW_DEG)).any())


def rows(outcomes: Sequence[Outcome]) -> list[Check]:
    """All rows.

    Args:
        outcomes: What became of the trials.
    """
    judged = [one for one in outcomes if one.errors]
    found = [information("trials", float(len(outcomes)))]
    found += [information("refused by name", float(sum(bool(one.refused) for one in outcomes)))]
    found.append(
        Check(
            "ended in an error or a warning of another kind",
            float(sum(bool(one.failed) for one in outcomes)),
            0.0,
            "<=",
        )
    )
    for k, label in enumerate(("causal", "smoothed") if judged else ()):
        found += _of(label, [one.errors[k] for one in judged])
    seconds = [one.seconds for one in outcomes]
    found.append(information("computing time of a trial, mean", float(np.mean(seconds)), "s"))
    found.append(information("computing time of a trial, longest", float(np.max(seconds)), "s"))
    return [*found, *worst_rows(outcomes)]


def _of(label: str, errors: Sequence[Error]) -> list[Check]:
    """Rows of all causal or all smoothed reconstructions."""
    far = [int((one.angle_rms_deg > FAR_DEG).sum()) for one in errors]
    torques = np.array([np.nanmax(one.torque_nm) for one in errors if np.isfinite(one.torque_nm).any()])
    found = [
        Check(f"{label}, divergences", float(sum(map(diverged, errors))), 0.0, "<="),
        information(f"{label}, joint angles beyond {FAR_DEG:.0f}°, as stated", float(sum(far))),
        information(
            f"{label}, worst joint angle of a trial, median", _median([e.worst_deg for e in errors]), "deg"
        ),
        information(f"{label}, worst torque of a trial, median", _median(torques), "N m"),
        information(f"{label}, worst torque of all", float(torques.max(initial=0.0)), "N m"),
        Check(f"{label}, least share tracked", min(one.tracked for one in errors), LEAST_TRACKED, ">="),
    ]
    nees = np.array([one.judged.nees for one in errors])
    motions = np.array([one.judged.key.motion for one in errors])
    for k, quantity in enumerate(QUANTITIES):
        found += within(f"{label}, NEES of {quantity}, mean", float(np.nanmean(nees[:, k])), *MEAN_NEES)
        for motion in sorted(set(motions)):
            mean = float(np.nanmean(nees[motions == motion, k]))
            found += within(f"{label}, NEES of {quantity}: {motion}", mean, *CELL_NEES)
    for kind in ("angle", "torque"):
        covers = np.array([getattr(one.judged, f"{kind}_cover") for one in errors])
        mean = 100.0 * float(np.nanmean(covers))
        found += within(f"{label}, 95 % intervals cover {kind}s", mean, *COVER_PERCENT, "%")
    return found


def _median(values: Sequence[float] | np.ndarray) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def worst_rows(outcomes: Sequence[Outcome]) -> list[Check]:
    """The trials that failed, and those with the worst joint angle against what is stated, by their seeds."""
    failed = [
        information(f"seed {one.trial.seed}: {one.failed or one.refused}"[:110], float("nan"))
        for one in outcomes
        if one.failed
    ]
    ranked = sorted((one for one in outcomes if one.errors), key=lambda one: -severity(one))
    return failed + [
        information(
            f"seed {one.trial.seed}: {one.errors[0].worst_angle}, {one.trial}", one.errors[0].worst_deg, "deg"
        )
        for one in ranked[:WORST]
    ]


def severity(one: Outcome) -> float:
    """How far the worst angle of a trial errs: in degrees, or in stated standard deviations as degrees of 10 to 3."""
    return max(
        float(np.nanmax(np.minimum(e.angle_rms_deg, e.angle_doubt * FAR_DEG / TOLD_SD))) for e in one.errors
    )
