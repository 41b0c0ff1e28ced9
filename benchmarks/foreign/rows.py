"""Rows of the table of bounds, from scores of foreign persons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.checks import Check, information, within
from benchmarks.foreign.errors import Judged
from benchmarks.foreign.score import Score
from benchmarks.references import rms

GROUP_COVER = (0.88, 0.98)
CALIBRATION = 0.05
STATIC_COVER = 0.88


@dataclass(frozen=True)
class Bounds:
    """Bounds of the legs.

    Attributes:
        shift_deg: Of the hip-flexion offset's standard deviation between motions.
        hip_mm: Of the hip centre.
        varying_deg: Of the RMS without the mean.
        cover: Least and largest share inside 95 % intervals, of errors and of their varying part, and of moments.
        moment: Of the moments' RMS, N m/kg.
        moment_nees: Least and largest mean square of the moments' errors over their standard deviations.
    """

    shift_deg: float
    hip_mm: float
    varying_deg: float
    cover: tuple[float, float]
    moment: float
    moment_nees: tuple[float, float]


CHOSEN_ON = Bounds(1.5, 12.0, 1.4, (0.90, 0.97), 0.058, (0.7, 1.5))
SHOWN_ON = Bounds(3.0, 15.0, 1.7, (0.88, 0.98), 0.075, (0.6, 1.7))


def bounded_rows(name: str, score: Score, bounds: Bounds) -> list[Check]:
    """The rows of persons who are scaled from a session.

    Args:
        name: Whose rows they are.
        score: Their scores.
        bounds: Bounds of the legs.
    """
    legs, offsets = score.legs, score.offsets
    rows = [
        Check(f"{name}: hip-flexion offset, sd between motions", offsets.shift, bounds.shift_deg, "<=", "°"),
        information(f"{name}: hip-flexion offset, widest range between motions", offsets.widest, "°"),
        information(f"{name}: hip-flexion offset, RMS", offsets.size, "°"),
        Check(f"{name}: hip centre, RMS", score.centres_mm["hip"], bounds.hip_mm, "<=", "mm"),
        information(f"{name}: knee centre, RMS", score.centres_mm["knee"], "mm"),
        information(f"{name}: ankle centre, RMS", score.centres_mm["ankle"], "mm"),
        information(f"{name}: angles of legs, RMS", legs.raw, "°"),
        Check(
            f"{name}: angles of legs without their means, RMS", legs.varying, bounds.varying_deg, "<=", "°"
        ),
        *within(f"{name}: legs, share in 95 % intervals", legs.cover, *bounds.cover),
        *within(f"{name}: legs, share in 95 % intervals, varying", legs.varying_cover, *bounds.cover),
        Check(f"{name}: moments of legs, RMS", score.moment, bounds.moment, "<=", "N m/kg"),
        *within(f"{name}: moments of legs, share in 95 % intervals", score.moment_cover, *bounds.cover),
        *within(f"{name}: moments of legs, NEES", score.moment_nees, *bounds.moment_nees),
    ]
    for group, one in score.groups.items():
        if group != "legs":
            rows += within(f"{name}: {group}, share in 95 % intervals", one.cover, *GROUP_COVER)
            rows.append(information(f"{name}: {group}, share, varying", one.varying_cover))
            rows.append(information(f"{name}: {group}, RMS", one.raw, "°"))
    return rows


def calibration_rows(name: str, score: Score) -> list[Check]:
    """Calibration error of all angles, and their median standard deviation.

    Args:
        name: Whose rows they are.
        score: Their scores.
    """
    return [
        Check(f"{name}: expected calibration error of angles", score.angles.calibration, CALIBRATION, "<="),
        information(f"{name}: median sd of angles", score.angles.sharpness, "°"),
    ]


def static_rows(name: str, score: Score) -> list[Check]:
    """Rows of persons who are scaled from a standing trial alone.

    Args:
        name: Whose rows they are.
        score: Their scores.
    """
    return [
        Check(f"{name}: legs, share in 95 % intervals", score.legs.cover, STATIC_COVER, ">="),
        *shown_rows(name, score),
    ]


def shown_rows(name: str, score: Score) -> list[Check]:
    """Scores without bounds.

    Args:
        name: Whose rows they are.
        score: Their scores.
    """
    numbers: Sequence[tuple[str, float, str]] = (
        ("hip-flexion offset, sd between motions", score.offsets.shift, "°"),
        ("hip centre, RMS", score.centres_mm["hip"], "mm"),
        ("angles of legs, RMS", score.legs.raw, "°"),
        ("angles of legs without their means, RMS", score.legs.varying, "°"),
        ("legs, share in 95 % intervals, all", score.legs.cover, ""),
        ("legs, share in 95 % intervals, varying", score.legs.varying_cover, ""),
        ("expected calibration error of angles", score.angles.calibration, ""),
    )
    return [information(f"{name}: {what}", value, unit) for what, value, unit in numbers]


def smoothing_rows(name: str, smoothed: Sequence[Judged], causal: Sequence[Judged]) -> list[Check]:
    """Smoothing is never worse than filtering: moments of the same trials in frames that both state.

    Args:
        name: Whose rows they are.
        smoothed: Their smoothed motions.
        causal: The same motions, causal.
    """
    ratios = {}
    for one, other in zip(smoothed, causal, strict=True):
        late, early = (np.array([series.error for series in each.moments]) for each in (one, other))
        both = np.isfinite(late) & np.isfinite(early)
        if both.any():
            ratios[f"{one.person}, {one.motion}"] = rms(late[both]) / rms(early[both])
    worst = max(ratios, key=lambda trial: ratios[trial], default="")
    most = ratios.get(worst, float("nan"))
    return [Check(f"{name}: moments, smoothed over causal RMS, largest ({worst})", most, 1.0, "<=")]
