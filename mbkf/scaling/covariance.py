"""Covariance of scale factors and of marker places in their segments' frames after scaling.

The unknowns are factors k, offsets δ and displacements by flexion c; a marker's place in the neutral posture is
p = D_b(k) m̄ + δ. At the minimum the inverse of the information on (k, δ, c), frames eliminated, is their covariance;
that of (k, p, c) follows linearly.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag

from mbkf.conventions import Array
from mbkf.io.body_covariance import BodyCovariance
from mbkf.model.joint_centres import centre_covariance, centre_names
from mbkf.numerics.positive import eliminated, inverse
from mbkf.scaling.problem import ScalingProblem
from mbkf.sensors.flexed_skin import slide_covariance


def body_covariance(problem: ScalingProblem, information: Array) -> BodyCovariance:
    """The covariance of (k, e, p, c), e the displacements of joint centres.

    Scaling leaves e at 0. As consider parameters (S. F. Schmidt 1966) they put the other unknowns wrong by S e,
    S = −J⁻¹ J_e.

    Args:
        problem: The problem that was solved.
        information: (K + E + 3 M (1 + D), …) J on (k, δ, c) and J_e at the minimum, as
            :meth:`ScalingProblem.information` has them.
    """
    count, centres = len(problem.body.scale_factors), centre_names(problem.body)
    e = np.arange(count, count + len(centres))
    found = np.delete(np.arange(len(information)), e)
    covariance = np.zeros_like(information)
    alone = inverse(information[np.ix_(found, found)])
    S = np.zeros((len(information), len(centres)))
    S[e] = np.eye(len(centres))
    S[found] = -_in_places(problem, alone @ information[np.ix_(found, e)])
    covariance[np.ix_(found, found)] = _in_places(problem, _in_places(problem, alone).T)
    covariance += S @ centre_covariance(problem.body) @ S.T
    names = tuple(marker.name for marker in problem.markers)
    return BodyCovariance.of(
        tuple(problem.body.scale_factors), names, covariance, problem.prior.flexions, centres
    )


def factor_errors(problem: ScalingProblem, information: Array) -> Array:
    """(K,) standard errors of the scale factors, joint centres known.

    Args:
        problem: The problem that was solved.
        information: That of :func:`body_covariance`.
    """
    count, centres = len(problem.body.scale_factors), len(centre_names(problem.body))
    known = np.delete(np.arange(len(information)), np.arange(count, count + centres))
    alone = information[np.ix_(known, known)]
    factors = eliminated(alone, np.arange(count, len(alone)))
    return np.asarray(np.sqrt(np.diagonal(inverse(factors))))


def _in_places(problem: ScalingProblem, rows: Array) -> Array:
    """Rows (K + 3 M (1 + D), n) of (k, δ, c) as rows of (k, p, c): :meth:`ScalingProblem.places_by_unknowns` @ rows."""
    by_factors = problem.places_by_factors()
    count, found = by_factors.shape[2], rows.copy()
    by_factors = by_factors.reshape(-1, count)
    found[count : count + len(by_factors)] += by_factors @ rows[:count]
    return found


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
        information: (K + E + 3 M (1 + D), …) that on (k, e, δ, c) at the minimum
            (:meth:`ScalingProblem.information`); e acts as k does.
    """
    factors, prior = len(problem.body.scale_factors), problem.prior.without_girdle()
    count = before.sizes
    found_anew = slice(count, len(information))
    precision = block_diag(
        prior.precision[:factors, :factors],
        np.zeros((count - factors,) * 2),
        prior.precision[factors:, factors:],
    )
    by_factors, data = problem.places_by_unknowns()[factors:, :factors], information - precision
    data[:, :factors] -= data[:, count:] @ by_factors
    data[:factors] -= by_factors.T @ data[count:]
    precision = precision[found_anew, found_anew]
    alone = inverse(data[found_anew, found_anew] + precision)
    names, segments = zip(*((marker.name, marker.segment) for marker in problem.markers), strict=True)
    skin = slide_covariance(problem.body, segments)[: prior.flexions]
    root = before.rows(names, {marker.name: marker.placement_sd_m for marker in problem.markers}, skin)
    gain = alone @ np.hstack([-data[found_anew, :count], precision])
    moved = np.vstack([root[:count], gain @ root])
    covariance = moved @ moved.T
    covariance[found_anew, found_anew] += alone
    return BodyCovariance.of(before.factors, names, covariance, prior.flexions, before.centres)
