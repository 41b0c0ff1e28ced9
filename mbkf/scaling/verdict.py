"""What a fitted body is worth: refused where it is no person, told where it is doubtful.

How closely markers fit says little of a standing trial: one posture is fitted to some millimetres by a body that is
wrong, since markers may sit elsewhere and segments be longer. What gives a wrong body away are its proportions: factors
that differ from each other by far more than those of persons do, S = sd(k) / mean(k) in units of the prior's spread of
a proportion. Persons of 15 public captures have S of 0.3 to 2.3; bodies fitted to eight markers in a circle of each
other's names most often more than 4.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array

DOUBTFUL_SPREADS, IMPOSSIBLE_SPREADS = 2.5, 4.5
"""Spread of the factors about their mean, in units of the prior's of a proportion, that is told and that is refused."""

DOUBTFUL_NOISE, IMPOSSIBLE_NOISE = 2.0, 4.0
"""RMS distance of markers over the RMS of their noise per coordinate (noise alone gives 1.7, and fitting takes part of
it) that is told, and that is refused where the fit has not settled either."""

DOUBTFUL_SHARE = 0.1
"""Share of the samples that are left out, since they lie too far from the body, that is told."""

MOVED_M, NEARER = 0.04, 0.4
"""Two markers of a segment that were moved by more than this, at least one of them, and that lie nearer to each other's
places, by this share of the squared distances, may bear each other's names. The wrist's markers of the gait2354 walk,
which do, have 0.31; no pair of fifteen other captures has less than 0.6."""

DOUBTS_KEY = "doubts"
"""Key of a subject's report under which doubts of the fit stand, in words; absent where there are none."""


def proportion_spreads(factors: Array, proportion_sd: float) -> float:
    """Spread of scale factors about their mean, in units of what proportions of persons stray by.

    Args:
        factors: (K,) scale factors.
        proportion_sd: Prior standard deviation of a factor about the person's overall size.
    """
    return float(np.std(factors) / np.mean(factors) / proportion_sd)


def refusal(factors: Array, proportion_sd: float, rms_per_noise: float, settled: bool) -> str:
    """Why a fitted body is no person, "" where it may be one.

    Args:
        factors: (K,) scale factors.
        proportion_sd: Prior standard deviation of a factor about the person's overall size.
        rms_per_noise: RMS distance of the markers over their noise per coordinate.
        settled: Whether the fit converged.
    """
    if proportion_spreads(factors, proportion_sd) > IMPOSSIBLE_SPREADS:
        return (
            f"no person is made so: the segments that fit the markers are {factors.min():.2f} to {factors.max():.2f} "
            "of the reference body's; are markers exchanged or named for others?"
        )
    if not settled and rms_per_noise > IMPOSSIBLE_NOISE:
        return (
            f"the fit did not settle, and markers lie {rms_per_noise:.1f} times as far from the body as their noise "
            "explains; are markers exchanged or named for others?"
        )
    return ""


def doubts(
    factors: dict[str, float],
    at_bound: tuple[str, ...],
    proportion_sd: float,
    rms_per_noise: float,
    share_left_out: float,
    settled: bool,
) -> tuple[str, ...]:
    """What speaks against a fitted body that may be a person, in words.

    Args:
        factors: Scale factors by name.
        at_bound: Names of those at a bound.
        proportion_sd: Prior standard deviation of a factor about the person's overall size.
        rms_per_noise: RMS distance of the markers over their noise per coordinate.
        share_left_out: Share of the samples that were left out.
        settled: Whether the fit converged.
    """
    values = np.array(list(factors.values()))
    found = []
    if not settled:
        found.append("the fit did not settle")
    if at_bound or proportion_spreads(values, proportion_sd) > DOUBTFUL_SPREADS:
        names = at_bound or _farthest(factors)
        told = ", ".join(f"{name.replace('_', ' ')} {factors[name]:.2f}" for name in names)
        found.append(f"proportions are unusual ({told} of the reference body's): are markers exchanged?")
    if rms_per_noise > DOUBTFUL_NOISE:
        found.append(f"markers lie {rms_per_noise:.1f} times as far from the body as their noise explains")
    if share_left_out > DOUBTFUL_SHARE:
        found.append(
            f"{100.0 * share_left_out:.0f} % of the samples lie too far from the body and were left out"
        )
    return tuple(found)


def as_each_other(segments: Sequence[str], places_m: Array, found_m: Array) -> list[tuple[int, int]]:
    """Pairs of markers of a segment that sit where the other one should.

    Args:
        segments: Segment of each of the M markers.
        places_m: (M, 3) where the protocol has them on the scaled body, in their segments' frames, m.
        found_m: (M, 3) where they were found.
    """
    squared = ((found_m[:, None] - places_m) ** 2).sum(axis=2)  # of marker i from the place of j
    own, names = np.diag(squared), np.array(segments)
    stay, trade = own[:, None] + own, squared + squared.T
    far = np.maximum(own[:, None], own) > MOVED_M**2
    pairs = (names[:, None] == names) & far & (trade < NEARER * stay)
    return [(int(i), int(j)) for i, j in np.argwhere(np.triu(pairs, 1))]


def _farthest(factors: dict[str, float]) -> tuple[str, ...]:
    """Names of the smallest and the largest."""
    return min(factors, key=factors.__getitem__), max(factors, key=factors.__getitem__)
