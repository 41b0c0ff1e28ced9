"""Spreads of this person's markers and proportions about protocol and table, learnt from the fit.

The prior's spreads of markers about their landmarks and of proportions are wide enough for anybody. The spreads of this
laboratory and person show in the fit. With residuals u of a group of unknowns (markers at landmarks, markers
anywhere, displacements by flexion, proportions) under the prior precision Λ₀, posterior covariance Σ and prior
covariance Λ₀⁻¹, the evidence of the data is largest where the prior's variance is multiplied by

    s² = (b + uᵀ Λ₀ u) / (b + γ),   γ = n − tr(Σ Λ₀ / s²),

γ the number of unknowns that the data determine (MacKay 1992), drawn to 1 as by b more of them. Near the
minimum the cost is quadratic, so u and Σ follow from s² without another fit, and the equation is solved by repetition.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.positive import solved_with_spreads, whitened
from mbkf.scaling.problem import ScalingProblem
from mbkf.scaling.records import ScalingPrior, ScalingState
from mbkf.scaling.shoulders import without_shoulders

PRIOR_WEIGHT = 1.0
"""b: weight of the prior's own spread, in unknowns that the data determine."""

RANGE = (0.2, 2.0)
"""Least and greatest factor s on a spread."""

PROPORTIONS, SKIN = "", "skin"
"""Groups of the factors and of the displacements; those of the offsets have the names of the markers' kinds."""

ROUNDS = 12
"""Number of iterations of s²; the last ones change it by a few percent."""


def learnt_prior(problem: ScalingProblem, state: ScalingState, information: Array) -> ScalingPrior:
    """The prior with spreads learnt from a fit.

    Args:
        problem: The problem that was solved; offsets of markers of different kinds are independent beforehand.
        state: Its solution.
        information: (K + 3 T G + 3 M (1 + D), …) information there, frames eliminated. The spreads of the
            shoulders' displacements are not learnt: they are few.
    """
    prior, kinds = problem.prior, _kinds(problem)
    groups = {str(kind): kinds == kind for kind in np.unique(kinds)}
    known = prior.without_girdle()
    squares = variance_factors(
        without_shoulders(information, prior, len(problem.body.scale_factors)),
        known.precision,
        known.away(state),
        list(groups.values()),
    )
    learnt = dict(zip(groups, squares, strict=True))
    of_offsets = np.array([learnt[m.kind] for m in problem.markers for _ in range(3)])
    return replace(
        prior,
        factor_covariance=learnt[PROPORTIONS] * prior.factor_covariance,
        offset_precision=prior.offset_precision / of_offsets[:, None],
        slide_precision=prior.slide_precision / learnt.get(SKIN, 1.0),
    )


def _kinds(problem: ScalingProblem) -> NDArray[np.str_]:
    """(K + 3 M (1 + D),) group of each unknown."""
    markers = [m.kind for m in problem.markers for _ in range(3)]
    skin = [SKIN] * (len(markers) * problem.prior.flexions)
    return np.array([PROPORTIONS] * len(problem.body.scale_factors) + markers + skin)


def variance_factors(
    information: Array, precision: Array, away: Array, groups: list[BoolArray]
) -> list[float]:
    """s² of each group of unknowns.

    Args:
        information: (n, n) on all unknowns at the minimum, the prior's included.
        precision: (n, n) Λ₀, block by block by groups.
        away: (n,) the unknowns at the minimum minus the prior's mean.
        groups: Masks (n,) of the groups.
    """
    # in units of the prior's spreads, a factor on these shifts the diagonal
    root = np.asarray(np.linalg.cholesky(precision), dtype=np.float64)
    data = whitened(information - precision, root)
    pull = np.asarray(np.linalg.solve(root, information @ away), dtype=np.float64)
    squares, diagonal = np.ones(len(groups)), np.arange(len(data))
    of = np.array(groups).T
    for _ in range(ROUNDS):
        variance, posterior = of @ squares, data.copy(order="F")
        posterior[diagonal, diagonal] += 1.0 / variance
        u, spread = solved_with_spreads(posterior, pull)
        determined = 1.0 - spread / variance
        squares = np.array(
            [
                (PRIOR_WEIGHT + (u[group] ** 2).sum()) / (PRIOR_WEIGHT + max(0.0, determined[group].sum()))
                for group in groups
            ]
        )
        squares = np.clip(squares, RANGE[0] ** 2, RANGE[1] ** 2)
    return [float(square) for square in squares]
