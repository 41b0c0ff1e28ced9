"""Segment lengths of a trial against those of a subject file: does the file belong to the person in the trial?

A correction on a trial leaves the scale factors k as the file has them. Near its solution the trial's cost is quadratic
in k and in the markers' offsets δ; poses are eliminated. With the offsets eliminated, too, the trial states S κ = y
with noise of covariance S, κ the difference of k from the file. Two statements about κ compete (Jeffreys 1961):

    this person     κ ~ N(0, P), P the covariance that scaling left
    anybody         κ ~ N(0, Q), Q the spread of sizes and proportions among people

Under each, y is normal with covariance S + S P S or S + S Q S, and the logarithm of the ratio of both densities is the
evidence. Markers are attached anew in every session, so δ has its spread between sessions, and a marker far from its
place (one that was put on elsewhere) loses weight as by Huber (1964): lengths are then those of the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.description import BodyDescription
from mbkf.model.sides import mirrored
from mbkf.model.subject_covariance import covariance_of
from mbkf.numerics.positive import inverse
from mbkf.scaling.problem import ScalingProblem
from mbkf.scaling.records import ScalingSettings, ScalingState

KNOWN_SD = 0.01
"""Spread of the factors of a subject file that states none."""

FAR_SD = 3.0
"""Distance of a marker from its place, in spreads between sessions, beyond which it loses weight."""

ROUNDS = 8
"""Number of times that weights follow from distances."""

LEAST_SHARE = 1e-9
"""Least variance of y in units of its mean one: directions of k that the trial does not show say nothing."""

CLEAR_SD, MOST_LISTED = 2.0, 3
"""Differences beyond so many of their standard deviations are listed, at most so many."""


class LengthChange(NamedTuple):
    """A length in the trial less that in the subject file.

    Attributes:
        name: The segment, or the width of one.
        longer_mm: Difference; of left and right the mean.
        sd_mm: Its standard deviation, with that of the file.
    """

    name: str
    longer_mm: float
    sd_mm: float


@dataclass(frozen=True)
class LengthEvidence:
    """Evidence that a trial's segment lengths are another person's.

    Attributes:
        powers: Logarithm to base 10 of the density of the trial for anybody over that for the subject's own lengths.
        changes: The clearest differences of lengths, the clearest first.
    """

    powers: float
    changes: tuple[LengthChange, ...] = ()


class _Fit(NamedTuple):
    """S (K, K) and y (K,), and the change of factors (K,) with its covariance (K, K) if anybody may be in the trial."""

    information: Array
    pull: Array
    change: Array
    covariance: Array


def length_evidence(subject: Subject, problem: ScalingProblem, state: ScalingState) -> LengthEvidence:
    """The evidence of a correction.

    Args:
        subject: The person as the file has it.
        problem: The correction's problem, whose factors are fixed.
        state: Its solution.
    """
    anybody = spread_of_people(problem.body)
    fit = _fit(subject, problem, state, inverse(anybody))
    own = _stated(subject, problem.body)
    gain = _log_density(fit, anybody) - _log_density(fit, own)
    changes = _changes(problem.body, state.factors, fit.change, fit.covariance + own)
    return LengthEvidence(float(gain / np.log(10.0)), changes)


def spread_of_people(body: BodyDescription) -> Array:
    """(K, K) covariance of scale factors among people: overall size, proportion, and the difference of both sides.

    Args:
        body: The reference body.
    """
    names, usual = np.array(body.scale_factors), ScalingSettings()
    other = np.array([mirrored(name) for name in names])
    alike = np.eye(len(names)) + ((names[:, None] == other) & (names != other))
    one_side = usual.side_sd**2 * np.diag((names != other).astype(np.float64))
    return np.asarray(usual.stature_sd**2 + usual.proportion_sd**2 * alike + one_side)


def _stated(subject: Subject, body: BodyDescription) -> Array:
    """(K, K) covariance of the factors as the file states it."""
    known, count = covariance_of(subject, body), len(body.scale_factors)
    return KNOWN_SD**2 * np.eye(count) if known is None else known.covariance[:count, :count]


def _fit(subject: Subject, problem: ScalingProblem, state: ScalingState, precision: Array) -> _Fit:
    """The trial's statement about the factors, with markers far from their places of less weight.

    Args:
        subject: The person as the file has it.
        problem: The correction's problem.
        state: Its solution.
        precision: (K, K) inverse covariance of the factors among people.
    """
    information, gradient = problem.reduced_data(state)
    count, raised = len(problem.body.scale_factors), problem.prior.raised
    own = {marker.name: np.hypot(marker.session_sd_m, marker.correlated_m) for marker in subject.markers}
    sd_m = np.array([own[marker.name] for marker in problem.markers])
    girdle = state.girdle_m - problem.prior.girdle_m if raised else np.zeros(0)
    away = np.concatenate([girdle, (state.offsets_m - problem.prior.offsets_m).ravel()])
    steady = [inverse(problem.prior.girdle_covariance)] if raised else []
    weights = np.ones(len(sd_m))
    sizes, rest = slice(0, count), slice(count, None)
    across = information[sizes, rest]
    for _ in range(ROUNDS):
        prior = block_diag(*steady, np.diag(np.repeat(weights / sd_m**2, 3)))
        right = np.column_stack([across.T, gradient[rest] + prior @ away])
        moved = np.linalg.solve(information[rest, rest] + prior, right)
        S = np.asarray(information[sizes, sizes] - across @ moved[:, :count])
        y = across @ moved[:, count] - gradient[sizes]
        change = np.asarray(np.linalg.solve(S + precision, y))
        offsets = (away - moved[:, count] - moved[:, :count] @ change)[raised:].reshape(-1, 3)
        far = np.linalg.norm(offsets, axis=1) / (np.sqrt(3.0) * sd_m)
        weights = np.minimum(1.0, FAR_SD / np.maximum(far, 1e-9))
    return _Fit(S, y, change, inverse(S + precision))


def _log_density(fit: _Fit, covariance: Array) -> float:
    """Logarithm of the density of y for factors of a covariance, up to a constant."""
    S = fit.information
    spread = S + S @ covariance @ S
    spread += LEAST_SHARE * np.trace(S) / len(S) * np.eye(len(S))
    _, size = np.linalg.slogdet(spread)
    return -0.5 * float(size + fit.pull @ np.linalg.solve(spread, fit.pull))


def _changes(
    body: BodyDescription, factors: Array, change: Array, covariance: Array
) -> tuple[LengthChange, ...]:
    """The clearest differences of lengths; the clearest one of all where no difference is clear."""
    found = []
    for name, rows in _lengths(body, factors).items():
        row = 1e3 * np.mean(rows, axis=0)
        sd = float(np.sqrt(row @ covariance @ row))
        if sd > 0.0:
            found.append(LengthChange(name, float(row @ change), sd))
    found.sort(key=lambda one: -abs(one.longer_mm) / one.sd_mm)
    clear = [one for one in found if abs(one.longer_mm) > CLEAR_SD * one.sd_mm]
    return tuple(clear[:MOST_LISTED] or found[:1])


def _lengths(body: BodyDescription, factors: Array) -> dict[str, list[Array]]:
    """Derivatives (K,) of lengths by the factors: segments with one joint at their end, widths of those with two."""
    ends: dict[str, list[str]] = {}
    for one in body.segments:
        ends.setdefault(one.parent, []).append(one.name)
    found: dict[str, list[Array]] = {}
    for parent, children in ends.items():
        if parent == "world":
            continue
        scale = body.segment(parent).scale_matrix
        pairs = [(c, mirrored(c)) for c in children if c.startswith("right_") and mirrored(c) in children]
        plain = parent.removeprefix("right_").removeprefix("left_").replace("_", " ")
        for right, left in pairs:
            across = body.segment(right).origin_m - body.segment(left).origin_m
            found.setdefault(f"width of the {plain}", []).append(_by_factors(across, scale, factors))
        if len(children) == 1:
            along = body.segment(children[0]).origin_m
            found.setdefault(plain, []).append(_by_factors(along, scale, factors))
    return found


def _by_factors(reference_m: Array, scale: Array, factors: Array) -> Array:
    """(K,) derivative of the length of a vector (3,) of the reference body by the factors, m."""
    scaled = (scale @ factors) * reference_m
    size = float(np.linalg.norm(scaled))
    return np.asarray((scaled * reference_m) @ scale / size) if size > 0.0 else np.zeros(len(factors))
