"""Scores of errors against stated standard deviations: RMS, offsets, cover of intervals, calibration and sharpness."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from benchmarks.foreign.errors import Judged, Series
from benchmarks.references import rms
from mbkf.conventions import Array

LEVELS = np.append(np.arange(0.1, 0.95, 0.1), 0.95)
"""Nominal shares of truth inside the intervals, at which calibration is judged."""

INTERVAL = 0.95
HIP_FLEXION = ("hip_flexion_r", "hip_flexion_l")


def cover(error: Array, sd: Array, level: float = INTERVAL) -> float:
    """Share of errors inside the symmetric interval of a level; samples without error or deviation do not count.

    Args:
        error: Errors.
        sd: Their stated standard deviations.
        level: Nominal share, between 0 and 1.
    """
    known = np.isfinite(error) & np.isfinite(sd)
    if not known.any():
        return float("nan")
    return float(np.mean(np.abs(error[known]) <= norm.ppf(0.5 + 0.5 * level) * sd[known]))


def reliability(error: Array, sd: Array) -> Array:
    """(L,) observed share at each nominal level of :data:`LEVELS`."""
    return np.array([cover(error, sd, level) for level in LEVELS])


def calibration_error(error: Array, sd: Array) -> float:
    """Mean of |nominal − observed share| over :data:`LEVELS` (Kuleshov 2018, Levi 2022): 0 is calibrated."""
    return float(np.mean(np.abs(LEVELS - reliability(error, sd))))


@dataclass(frozen=True)
class AngleScore:
    """Scores of a set of angles, pooled over all samples.

    Attributes:
        raw, varying: RMS error, and that without each motion's mean, degrees.
        cover, varying_cover: Shares inside the 95 % interval of error and total deviation, and of both varying parts.
        calibration: Expected calibration error of the total deviation.
        sharpness: Median total deviation, degrees.
    """

    raw: float
    varying: float
    cover: float
    varying_cover: float
    calibration: float
    sharpness: float


def angle_score(series: Sequence[Series]) -> AngleScore:
    """Scores of pooled series.

    Args:
        series: Errors of angles.
    """
    error, sd = _joined(one.error for one in series), _joined(one.sd for one in series)
    varying, varying_sd = _joined(one.varying for one in series), _joined(one.varying_sd for one in series)
    return AngleScore(
        rms(error),
        rms(varying),
        cover(error, sd),
        cover(varying, varying_sd),
        calibration_error(error, sd),
        float(np.nanmedian(sd)) if sd.size else float("nan"),
    )


@dataclass(frozen=True)
class OffsetScore:
    """Mean errors of hip flexion.

    Attributes:
        size: RMS over persons, motions and sides, degrees.
        shift: RMS over persons and sides of the standard deviation between a person's motions, degrees.
        widest: Largest range between a person's motions, degrees.
    """

    size: float
    shift: float
    widest: float


def offset_score(series: Iterable[Series]) -> OffsetScore:
    """Size of mean errors, and their change between the motions of one person and coordinate.

    Args:
        series: Errors of angles; one series a motion.
    """
    offsets: dict[tuple[str, str], list[float]] = defaultdict(list)
    for one in series:
        offsets[one.person, one.name].append(one.offset)
    if not offsets:
        return OffsetScore(*[float("nan")] * 3)
    return OffsetScore(
        rms(np.concatenate([np.array(one) for one in offsets.values()])),
        rms(np.array([np.std(one) for one in offsets.values()])),
        max(float(np.ptp(one)) for one in offsets.values()),
    )


@dataclass(frozen=True)
class Score:
    """All scores of a set of reconstructed motions.

    Attributes:
        legs: Hip, knee and ankle angles.
        groups: Every group of angles by name.
        angles: All angles together.
        offsets: Mean errors of hip flexion.
        centres_mm: RMS distance of joint centres by joint.
        moment, moment_cover: RMS error of the legs' moments in N m/kg, and share inside the 95 % interval.
        moment_nees: Mean square of their errors over stated standard deviations.
    """

    legs: AngleScore
    groups: dict[str, AngleScore]
    angles: AngleScore
    offsets: OffsetScore
    centres_mm: dict[str, float]
    moment: float
    moment_cover: float
    moment_nees: float


def score(found: Sequence[Judged]) -> Score:
    """Scores of motions, pooled over all samples.

    Args:
        found: Reconstructed motions.
    """
    angles = [series for one in found for series in one.angles]
    moments = [series for one in found for series in one.moments]
    by_group: dict[str, list[Series]] = defaultdict(list)
    for series in angles:
        by_group[series.group].append(series)
    centres: dict[str, list[Array]] = defaultdict(list)
    for one in found:
        for (joint, _), away in one.centres_m.items():
            centres[joint].append(1e3 * away)
    error, sd = _joined(one.error for one in moments), _joined(one.sd for one in moments)
    return Score(
        angle_score(by_group["legs"]),
        {group: angle_score(held) for group, held in by_group.items()},
        angle_score(angles),
        offset_score(one for one in angles if one.name in HIP_FLEXION),
        {joint: rms(np.concatenate(held)) for joint, held in centres.items()},
        rms(error),
        cover(error, sd),
        float(np.nanmean((error / sd) ** 2)) if error.size else float("nan"),
    )


def _joined(parts: Iterable[Array]) -> Array:
    held = list(parts)
    return np.concatenate(held) if held else np.zeros(0)
