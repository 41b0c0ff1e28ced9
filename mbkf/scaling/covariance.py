"""Covariance of scale factors and of marker places in their segments' frames after scaling.

The unknowns are factors k and offsets δ; a marker's place is p = D_b(k) m̄ + δ. At the minimum the inverse of the
information on (k, δ), frames eliminated, is their covariance; that of (k, p) follows linearly.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.body_covariance import BodyCovariance
from mbkf.scaling.problem import ScalingProblem


def body_covariance(problem: ScalingProblem, information: Array) -> BodyCovariance:
    """The covariance of (k, p).

    Args:
        problem: The problem that was solved.
        information: (K + 3 M, K + 3 M) information on (k, δ) at the minimum, frames eliminated.
    """
    to_places = problem.places_by_factors_and_offsets()
    covariance = to_places @ np.linalg.inv(information) @ to_places.T
    names = tuple(marker.name for marker in problem.markers)
    return BodyCovariance.of(tuple(problem.body.scale_factors), names, covariance)


def corrected_covariance(
    before: BodyCovariance, problem: ScalingProblem, information: Array
) -> BodyCovariance:
    """The covariance of (k, p) after places alone were found anew on a trial, with unchanged factors.

    With J = J_d + Π, the information of the trial and of the prior about the places before,

        p̂ − p = J⁻¹ (Π (p̂₀ − p₀) − J_d,pk (k̂ − k) + noise),

    where the noise of the trial and the movement of markers between sessions together have the covariance J⁻¹.

    Args:
        before: That of scaling.
        problem: The correction's problem, whose factors are fixed and whose offsets have the prior precision Π.
        information: (K + 3 M, K + 3 M) information on (k, δ) at the minimum, frames eliminated.
    """
    count = len(problem.body.scale_factors)
    places = slice(count, len(information))
    data = information.copy()
    data[:count, :count] -= problem.factor_root.T @ problem.factor_root
    precision = problem.prior.offset_precision
    data[places, places] -= precision
    back = 2.0 * np.eye(len(data)) - problem.places_by_factors_and_offsets()
    data = back.T @ data @ back
    J = data[places, places] + precision
    names = tuple(marker.name for marker in problem.markers)
    root = before.rows(names, {marker.name: marker.placement_sd_m for marker in problem.markers})
    gain = np.linalg.solve(J, np.hstack([-data[places, :count], precision]))
    moved = np.vstack([root[:count], gain @ root])
    covariance = moved @ moved.T
    covariance[places, places] += np.linalg.inv(J)
    return BodyCovariance.of(before.factors, names, covariance)
