"""Covariance of scale factors and of marker places in their segments' frames after scaling.

The unknowns are factors k, offsets δ and displacements by flexion c; a marker's place in the neutral posture is
p = D_b(k) m̄ + δ. At the minimum the inverse of the information on (k, δ, c), frames eliminated, is their covariance;
that of (k, p, c) follows linearly.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.io.body_covariance import BodyCovariance
from mbkf.scaling.problem import ScalingProblem
from mbkf.sensors.flexed_skin import slide_covariance


def body_covariance(problem: ScalingProblem, information: Array) -> BodyCovariance:
    """The covariance of (k, p, c).

    Args:
        problem: The problem that was solved.
        information: (K + 3 M (1 + D), …) information on (k, δ, c) at the minimum, frames eliminated.
    """
    to_places = problem.places_by_unknowns()
    covariance = to_places @ np.linalg.inv(information) @ to_places.T
    names = tuple(marker.name for marker in problem.markers)
    return BodyCovariance.of(tuple(problem.body.scale_factors), names, covariance, problem.prior.flexions)


def corrected_covariance(
    before: BodyCovariance, problem: ScalingProblem, information: Array
) -> BodyCovariance:
    """The covariance of (k, p, c) after places and displacements were found anew on a trial, with unchanged factors.

    With s = (p, c) and J = J_d + Π, the information of the trial and of the prior about s before,

        ŝ − s = J⁻¹ (Π (ŝ₀ − s₀) − J_d,sk (k̂ − k) + noise),

    where the noise of the trial and the movement of markers between sessions together have the covariance J⁻¹.

    Args:
        before: That of scaling.
        problem: The correction's problem, whose factors are fixed and whose offsets and displacements have the prior
            precision Π.
        information: (K + 3 M (1 + D), …) information on (k, δ, c) at the minimum, frames eliminated.
    """
    count, prior = len(problem.body.scale_factors), problem.prior
    found_anew = slice(count, len(information))
    precision = prior.precision
    back = 2.0 * np.eye(len(information)) - problem.places_by_unknowns()
    data = back.T @ (information - precision) @ back
    precision = precision[found_anew, found_anew]
    J = data[found_anew, found_anew] + precision
    names, segments = zip(*((marker.name, marker.segment) for marker in problem.markers), strict=True)
    skin = slide_covariance(problem.body, segments)[: prior.flexions]
    root = before.rows(names, {marker.name: marker.placement_sd_m for marker in problem.markers}, skin)
    gain = np.linalg.solve(J, np.hstack([-data[found_anew, :count], precision]))
    moved = np.vstack([root[:count], gain @ root])
    covariance = moved @ moved.T
    covariance[found_anew, found_anew] += np.linalg.inv(J)
    return BodyCovariance.of(before.factors, names, covariance, prior.flexions)
