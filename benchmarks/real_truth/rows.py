"""Rows of the benchmark from trials beside their references."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.checks import Check, information
from benchmarks.foreign.errors import Series
from benchmarks.foreign.score import cover
from benchmarks.real_truth.before import stated
from benchmarks.real_truth.followed import STATIC, Compared
from benchmarks.real_truth.persons import STANDING

FLEXIONS = ("hip_flexion", "knee_angle", "ankle_angle")
LEGS = tuple(f"{name}_{side}" for name in FLEXIONS for side in "rl")

MOST_SHIFT_DEG = 3.0
"""Of the hip-flexion offset's range between the motions of one person, and of the pelvis's tilt beside its markers."""

MOST_VARYING_DEG = 5.0
"""As for the reference angles of ``main_job``: references err by some degrees themselves."""

MOST_HIP_MM = 15.0
"""As for persons made with OpenSim that no setting was chosen on."""

LEAST_R = {"hip_flexion": 0.95, "knee_angle": 0.95, "ankle_angle": 0.8}
"""The ankle moves by 25° only, of which a difference of 3° takes much."""

LEAST_MOMENT_R, MOST_MOMENT = 0.85, 0.3


@dataclass(frozen=True)
class Agreement:
    """Agreement of a coordinate of a trial with its reference, right and left together.

    Attributes:
        offsets: Mean difference by side.
        varying: Largest RMS without the mean of both sides.
        r: Smaller correlation.
        cover, varying_cover: Share of reference inside our 95 % interval, and of both without their means.
    """

    offsets: tuple[float, ...]
    varying: float
    r: float
    cover: float
    varying_cover: float


def agreement(one: Compared, group: str, coordinate: str) -> Agreement | None:
    """The agreement of a coordinate; None where the reference lacks it.

    Args:
        one: A trial.
        group: "angle" or "moment".
        coordinate: Name without side, or of the trunk.
    """
    held = one.angles if group == "angle" else one.moments
    sides = [series for series in held if series.name.removesuffix("_r").removesuffix("_l") == coordinate]
    if not sides:
        return None
    return Agreement(
        tuple(series.offset for series in sides),
        max(float(np.nanstd(series.error)) for series in sides),
        min(one.r[group, series.name] for series in sides),
        _pooled(sides, varying=False),
        _pooled(sides, varying=True),
    )


def _pooled(held: Sequence[Series], *, varying: bool) -> float:
    """Share of reference values inside the 95 % interval, of all series together."""
    errors = [series.varying if varying else series.error for series in held]
    sds = [series.varying_sd if varying else series.sd for series in held]
    return cover(np.concatenate(errors), np.concatenate(sds)) if held else float("nan")


def hip_shifts(found: Iterable[Compared]) -> dict[str, tuple[int, float, float]]:
    """By person with several motions: their number, sd and range of the hip-flexion offset, worst side, degrees."""
    offsets: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for one in found:
        for series in one.angles:
            if series.name.startswith("hip_flexion"):
                offsets[one.person][series.name].append(series.offset)
    return {
        person: (
            len(next(iter(sides.values()))),
            max(float(np.std(each)) for each in sides.values()),
            max(float(np.ptp(each)) for each in sides.values()),
        )
        for person, sides in offsets.items()
        if min(len(each) for each in sides.values()) > 1
    }


def offset_rows(scaling: str, found: Sequence[Compared]) -> list[Check]:
    """Change of the hip-flexion offset between motions of one person.

    Args:
        scaling: For the rows.
        found: Trials.
    """
    rows = []
    for person, (count, sd, widest) in hip_shifts(found).items():
        label = f"{person}, {scaling}: hip-flexion offset over {count} trials"
        rows += [
            Check(f"{label}, range", widest, MOST_SHIFT_DEG, "<=", "°"),
            information(f"{label}, sd", sd, "°"),
        ]
    return rows


def trial_rows(scaling: str, one: Compared) -> list[Check]:
    """Angles and moments of a trial against its reference; of standing the offset alone.

    Args:
        scaling: For the rows.
        one: The trial.
    """
    label = f"{one.person}, {one.trial}, {scaling}"
    rows = []
    for coordinate in FLEXIONS:
        angle = agreement(one, "angle", coordinate)
        if angle is None:
            continue
        name = f"{label}: {coordinate.split('_')[0]}"
        for side, offset in zip("rl", angle.offsets, strict=False):
            rows.append(information(f"{name} {side}, mean difference", offset, "°"))
        if one.trial != STANDING:
            rows += [
                Check(f"{name}, r", angle.r, LEAST_R[coordinate], ">="),
                Check(f"{name}, RMS without the mean", angle.varying, MOST_VARYING_DEG, "<=", "°"),
            ]
        moment = agreement(one, "moment", coordinate)
        if moment is not None:
            rows += [
                Check(f"{name} moment, r", moment.r, LEAST_MOMENT_R, ">="),
                Check(f"{name} moment, RMS without the mean", moment.varying, MOST_MOMENT, "<=", "N m/kg"),
                *(information(f"{name} moment, mean difference", o, "N m/kg") for o in moment.offsets),
            ]
    return rows


def median_varying(found: Sequence[Compared], coordinate: str) -> float:
    """Median over trials, standing left out, of the RMS without the mean, degrees.

    Args:
        found: Trials.
        coordinate: Name without side.
    """
    each = [agreement(one, "angle", coordinate) for one in found if one.trial != STANDING]
    known = [one.varying for one in each if one is not None]
    return float(np.median(known)) if known else float("nan")


def reference_rows(scaling: str, found: Sequence[Compared]) -> list[Check]:
    """Median over trials of what varies against the references; bounded by the tree before where it scaled alike.

    Args:
        scaling: For the rows.
        found: Trials.
    """
    rows = []
    for coordinate, before in stated("varying_deg").items():
        value = median_varying(found, coordinate)
        name = f"all trials, {scaling}: {coordinate.split('_')[0]}, median RMS without the mean"
        rows.append(Check(name, value, before if scaling == STATIC else float("inf"), "<=", "°"))
    return rows


def tilt_rows(scaling: str, one: Compared) -> list[Check]:
    """Change of the pelvis's tilt since standing, beside that of the line between its markers.

    Args:
        scaling: For the rows.
        one: A trial.
    """
    if not np.isfinite(one.line_deg) or one.trial == STANDING:
        return []
    away = abs(one.tilt_deg - one.line_deg)
    name = f"{one.person}, {one.trial}, {scaling}: pelvis tilt since standing, away from its markers' line"
    if one.trial.startswith("lift"):
        return [information(name, away, "°")]
    return [Check(name, away, MOST_SHIFT_DEG, "<=", "°")]


def newton_rows(scaling: str, one: Compared) -> list[Check]:
    """Force that inverse dynamics leaves at the pelvis, ours and the reference's.

    Args:
        scaling: For the rows.
        one: A trial.
    """
    ours, theirs = one.residual_n
    if not np.isfinite(theirs):
        return []
    name = f"{one.person}, {one.trial}, {scaling}: force left at the pelvis, RMS"
    return [information(f"{name}, ours", ours, "N"), information(f"{name}, {one.kind}", theirs, "N")]


def hip_rows(scaling: str, one: Compared) -> list[Check]:
    """Distance of our hip centres from functional ones; bounded where these took no part in scaling.

    Args:
        scaling: For the rows.
        one: A trial.
    """
    rows = []
    for side, (away, apart) in one.hips_mm.items():
        name = f"{one.person}, {one.trial}, {scaling}: hip centre {side} from functional ones"
        bounded = scaling == STATIC
        rows.append(Check(name, away, MOST_HIP_MM, "<=", "mm") if bounded else information(name, away, "mm"))
        rows.append(information(f"{name}, their own spread", apart, "mm"))
    return rows


def cover_rows(scaling: str, found: Sequence[Compared]) -> list[Check]:
    """Share of reference values inside our 95 % intervals by program of the reference, which counts as exact.

    Args:
        scaling: For the rows.
        found: Trials.
    """
    rows = []
    for kind in dict.fromkeys(one.kind for one in found):
        whole, varying = pooled_cover(found, kind)
        label = f"{kind}, {scaling}: hip, knee, ankle, share of reference inside 95 % intervals"
        rows += [information(label, whole), information(f"{label}, without means", varying)]
    return rows


def pooled_cover(found: Sequence[Compared], kind: str) -> tuple[float, float]:
    """Share of a program's sagittal angles inside our 95 % intervals, and of both without their means.

    Args:
        found: Trials; standing is left out.
        kind: The program.
    """
    held = [
        series
        for one in found
        if one.kind == kind and one.trial != STANDING
        for series in one.angles
        if series.name in LEGS
    ]
    return _pooled(held, varying=False), _pooled(held, varying=True)
