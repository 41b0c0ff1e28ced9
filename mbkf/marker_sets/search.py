"""The body in one frame of points: many starts fitted roughly, the best of them finely, the likeliest kept."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import NotObservable
from mbkf.marker_sets.equipment import EQUIPMENTS, Equipment, count_worth, equipped_weight
from mbkf.marker_sets.places import WornPlaces
from mbkf.marker_sets.posed_cloud import CloudProblem, PosedBody
from mbkf.marker_sets.starts import starts
from mbkf.model.human import HumanModel

FEWEST_POINTS = 12
"""Fewer points do not show which part of which body they are on."""

COARSE_M = (0.12, 0.12, 0.10, 0.10, 0.08, 0.08)
"""Widths of the rough fit of every start."""

FINE_M = (0.08, 0.07, 0.06, 0.05, 0.04, 0.035, 0.03, 0.03, 0.025, 0.025)
"""Widths of the fine fit of the best starts."""

THINNEST_M = 0.2
"""Least side of the box around the points."""

KEPT_EACH, KEPT = 3, 9
"""So many rough fits of every equipment, and in all, are fitted finely."""


@dataclass(frozen=True)
class FoundBody:
    """The likeliest body in a frame.

    Attributes:
        body: Its pose, size and shares.
        equipment: The part of it that carries markers.
        worth: Logarithm of likelihood and priors, the equipment's among them.
        rival: The same of the best body that faces another way, −inf where there is none.
        evidence: How much likelier a point is on this body than anywhere in the box around the points: mean logarithm,
            names aside.
        odds: Logarithm of how much likelier all points are this body than strewn over that box: the evidence of all
            points and the priors, names aside.
    """

    body: PosedBody
    equipment: Equipment
    worth: float
    rival: float
    evidence: float
    odds: float


def find_body(places: WornPlaces, points_m: Array, named: Array | None = None) -> FoundBody:
    """The body that explains a frame of points.

    Args:
        places: Where markers are worn.
        points_m: (N, 3) the points, z up.
        named: (N, C) how much likelier each component is by a point's name than without it; None without names.

    Raises:
        NotObservable: The points are too few, or too low or too tall for a person.
    """
    if len(points_m) < FEWEST_POINTS:
        raise NotObservable(
            f"a frame shows {len(points_m)} points; fewer than {FEWEST_POINTS} do not show "
            "which part of a body they are on"
        )
    if named is not None:
        named = None if (named == 1.0).all() else named.copy()
    return _searched(_Frame(places, points_m.copy(), named))


@dataclass(frozen=True, eq=False)
class _Frame:
    """A frame as a key: who decides about its axes and who infers a set search the same one."""

    places: WornPlaces
    points_m: Array
    named: Array | None

    @cached_property
    def _content(self) -> tuple[bytes, bytes]:
        return self.points_m.tobytes(), b"" if self.named is None else self.named.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Frame) and self.places is other.places and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)


@lru_cache(maxsize=8)
def _searched(frame: _Frame) -> FoundBody:
    """What :func:`find_body` finds; its arrays are not to be changed."""
    places, points_m, named = frame.places, frame.points_m, frame.named
    rough: list[_Candidate] = []
    reference: HumanModel | None = None
    for equipment in EQUIPMENTS:
        worn = ~equipment.bare(places)
        weight = weights(places, equipment, named)[..., worn]
        problem = CloudProblem(places.only(worn), points_m, weight, reference)
        reference = problem.model
        own = [
            _Candidate(problem.posed(start.q, start.size, COARSE_M), problem, equipment)
            for start in starts(problem.model, points_m, equipment)
        ]
        rough += sorted(own, key=lambda one: -one.worth)[:KEPT_EACH]
    if not rough:
        raise NotObservable(
            f"the points reach over {np.ptp(points_m[:, 2]):.2f} m of height; no person stands there "
            "(which axis points up? give --up; which unit? give --unit)"
        )
    rough.sort(key=lambda one: -one.worth)
    fine = [replace(one, body=one.problem.fitted(one.body, FINE_M)) for one in rough[:KEPT]]
    best, *others = sorted(fine, key=lambda one: -one.worth)
    rivals = [one.worth for one in others if _apart(best.problem, best.body.q, one.body.q) > math.pi / 4.0]
    evidence = _evidence(places, points_m, best.body, best.equipment)
    odds = len(points_m) * evidence + best.prior
    body = PosedBody(
        read_only(best.body.q), read_only(best.body.factors), _all_shares(places, best), best.body.worth
    )
    return FoundBody(body, best.equipment, best.worth, max(rivals, default=-math.inf), evidence, odds)


@dataclass(frozen=True)
class _Candidate:
    body: PosedBody
    problem: CloudProblem
    equipment: Equipment

    @cached_property
    def worth(self) -> float:
        """Logarithm of likelihood and priors, those of the equipment among them."""
        return self.body.worth + self._equipped

    @property
    def prior(self) -> float:
        """Logarithm of all priors."""
        return self.problem.priors(self.body.q, self.body.factors) + self._equipped

    @property
    def _equipped(self) -> float:
        count = count_worth(self.problem.places, self.equipment, self.body.shares)
        return math.log(self.equipment.share) + count


def _all_shares(places: WornPlaces, found: _Candidate) -> Array:
    """(N, C) shares of all components, 0 where the equipment leaves a segment bare."""
    shares = np.zeros((len(found.body.shares), len(places.segments)))
    shares[:, ~found.equipment.bare(places)] = found.body.shares
    return read_only(shares)


def _evidence(places: WornPlaces, points_m: Array, body: PosedBody, equipment: Equipment) -> float:
    problem = CloudProblem(places, points_m, equipped_weight(places, equipment))
    _, likelihood = problem.shares(problem.sized(body.factors).positions(body.q), FINE_M[-1])
    box = float(np.prod(np.maximum(np.ptp(points_m, axis=0), THINNEST_M)))
    return likelihood / len(points_m) + math.log(box)


def weights(places: WornPlaces, equipment: Equipment, named: Array | None) -> Array:
    """(C,) or (N, C) share of every component, by the equipment and by the points' names.

    Args:
        places: Where markers are worn.
        equipment: The part of the body that carries them.
        named: (N, C) how much likelier each component is by a point's name than without it; None without names.
    """
    weight = equipped_weight(places, equipment)
    if named is None:
        return weight
    return np.asarray(weight * named)


def _apart(problem: CloudProblem, one: Array, other: Array) -> float:
    """Angle between the ways that two poses face, seen from above, rad."""
    forward = [problem.model.placements(q)[0][problem.model.root.joint_id][:2, 0] for q in (one, other)]
    cross = forward[0][0] * forward[1][1] - forward[0][1] * forward[1][0]
    return abs(math.atan2(cross, float(forward[0] @ forward[1])))
