"""The body in one frame of points: many starts fitted roughly, the best of them finely, and the likeliest kept."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import NotObservable
from mbkf.marker_sets.equipment import EQUIPMENTS, Equipment, count_log_probability, equipped_weight
from mbkf.marker_sets.places import WornPlaces
from mbkf.marker_sets.posed_cloud import CloudProblem, PosedBody
from mbkf.marker_sets.starts import starts
from mbkf.model.human import HumanModel
from mbkf.numerics.runs import spread_indices

FEWEST_POINTS = 12
"""Least number of points in a frame."""

COARSE_M = (0.12, 0.12, 0.10, 0.10, 0.08, 0.08)
"""Widths of the rough fit of every start."""

FINE_M = (0.08, 0.07, 0.06, 0.05, 0.04, 0.035, 0.03, 0.03, 0.025, 0.025)
"""Widths of the fine fit of the best starts."""

THINNEST_M = 0.2
"""Least side of the box around the points."""

MOST_ROUGH = 96
"""Most points of a rough fit; of more, so many are taken all over their order, which mostly goes segment by segment.
Public sets have fewer."""

KEPT_EACH, KEPT = 3, 9
"""Rough fits of every equipment, and in all, that are fitted finely."""


@dataclass(frozen=True)
class FoundBody:
    """The likeliest body in a frame.

    Attributes:
        body: Its pose, size and shares.
        equipment: The part of it that carries markers.
        log_posterior: Logarithm of likelihood and priors, that of the equipment among them.
        other_heading: The same of the best body with another heading, −inf without any.
        log_ratio_per_point: Mean log-likelihood ratio of a point on this body and one anywhere in the box around the
            points, without names.
        log_odds: Log odds of this body against points strewn over that box: the log ratios of all points and the
            priors, without names.
    """

    body: PosedBody
    equipment: Equipment
    log_posterior: float
    other_heading: float
    log_ratio_per_point: float
    log_odds: float


def find_body(
    places: WornPlaces, points_m: Array, named: Array | None = None, *, standing: bool = False
) -> FoundBody:
    """The body that explains a frame of points.

    Args:
        places: Where markers are worn.
        points_m: (N, 3) the points, z up.
        named: (N, C) likelihood ratio of each component by a point's name; None without names.
        standing: True where the person is known to stand, with level soles.

    Raises:
        NotObservable: The points are too few, or their height is not a person's.
    """
    if len(points_m) < FEWEST_POINTS:
        raise NotObservable(
            f"a frame shows {len(points_m)} points; fewer than {FEWEST_POINTS} do not show which part of a body they "
            "are on"
        )
    names = b"" if named is None or (named == 1.0).all() else named.tobytes()
    return _searched(places, points_m.tobytes(), names, standing)


@lru_cache(maxsize=8)
def _searched(places: WornPlaces, points: bytes, names: bytes, standing: bool) -> FoundBody:
    """The result of :func:`find_body`, cached: a frame is searched for its axes, and again for its marker set."""
    points_m = np.frombuffer(points).reshape(-1, 3)
    named = np.frombuffer(names).reshape(len(points_m), -1) if names else 1.0
    rough: list[_Candidate] = []
    reference: HumanModel | None = None
    for equipment in EQUIPMENTS:
        worn = ~equipment.bare(places)
        weight = (equipped_weight(places, equipment) * named)[..., worn]
        problem = CloudProblem(places.only(worn), points_m, weight, reference, standing=standing)
        reference = problem.model
        thinned = problem.of_points(spread_indices(len(points_m), MOST_ROUGH))
        own = [
            _Candidate(thinned.posed(start.q, start.size, COARSE_M), problem, equipment)
            for start in starts(problem.model, points_m, equipment)
        ]
        rough += sorted(own, key=lambda one: -one.log_posterior)[:KEPT_EACH]
    if not rough:
        raise NotObservable(
            f"no upright body is found: the points extend over {np.ptp(points_m[:, 2]):.2f} m of height; give the axis "
            "that points up (--up), or the unit (--unit)"
        )
    rough.sort(key=lambda one: -one.log_posterior)
    fine = [replace(one, body=one.problem.fitted(one.body, FINE_M)) for one in rough[:KEPT]]
    best, *others = sorted(fine, key=lambda one: -one.log_posterior)
    others = [one for one in others if _angle(best.problem, best.body.q, one.body.q) > math.pi / 4.0]
    ratio = _log_ratio_per_point(places, points_m, best.body, best.equipment)
    q, factors, shares = map(read_only, (best.body.q, best.body.factors, _all_shares(places, best)))
    return FoundBody(
        PosedBody(q, factors, shares, best.body.log_posterior),
        best.equipment,
        best.log_posterior,
        max((one.log_posterior for one in others), default=-math.inf),
        ratio,
        len(points_m) * ratio + best.prior,
    )


@dataclass(frozen=True)
class _Candidate:
    body: PosedBody
    problem: CloudProblem
    equipment: Equipment

    @cached_property
    def log_posterior(self) -> float:
        """Logarithm of likelihood and priors, that of the equipment among them."""
        return self.body.log_posterior + self._equipped

    @property
    def prior(self) -> float:
        """Logarithm of all priors."""
        return self.problem.priors(self.body.q, self.body.factors) + self._equipped

    @property
    def _equipped(self) -> float:
        count = count_log_probability(self.problem.places, self.equipment, self.body.shares)
        return math.log(self.equipment.share) + count


def _all_shares(places: WornPlaces, found: _Candidate) -> Array:
    """(N, C) shares of all components, 0 on segments without markers."""
    shares = np.zeros((len(found.body.shares), len(places.segments)))
    shares[:, ~found.equipment.bare(places)] = found.body.shares
    return shares


def _log_ratio_per_point(places: WornPlaces, points_m: Array, body: PosedBody, equipment: Equipment) -> float:
    problem = CloudProblem(places, points_m, equipped_weight(places, equipment))
    _, likelihood = problem.shares(problem.reading(body.q, body.factors)[0].positions_m, FINE_M[-1])
    box = float(np.prod(np.maximum(np.ptp(points_m, axis=0), THINNEST_M)))
    return likelihood / len(points_m) + math.log(box)


def _angle(problem: CloudProblem, one: Array, other: Array) -> float:
    """Angle between the headings of two poses, rad."""
    forward = [problem.model.placements(q)[0][problem.model.root.joint_id][:2, 0] for q in (one, other)]
    cross = forward[0][0] * forward[1][1] - forward[0][1] * forward[1][0]
    return abs(math.atan2(cross, float(forward[0] @ forward[1])))
