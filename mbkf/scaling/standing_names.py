"""Names of a standing trial that are exchanged, found by the cost of scaling under other names.

A static trial has one posture: a body fits wrong names about as closely as right ones, with its joints bent or turned
over. The cost of scaling (thesis eq. 4.1) shows it, since people stand near the neutral posture, have usual
proportions, wear anatomical markers on their landmarks, and keep their joints within their ranges:

    E = C(pose, factors, offsets) + Σ (excess of a joint over its range / σ)²

One frame is fitted. Exchanges are ranked by one Gauss–Newton step (:mod:`mbkf.scaling.exchange_costs`) at three states:
the fitted one, the neutral posture, and the fitted one with no joint turned about its segment's long axis, since a fit
to wrong names may be far from the right one. The best are fitted, and with them all pairs of an arm's segment, since
people turn arms as far as wrong names do. The best of these is kept where E falls clearly, until no exchange lowers it.

Limits were set on eight captures (``CHOSEN`` of ``benchmarks/statics``) and on the clean form of eleven others: of
these 19 the cheapest exchange raises E by 2 or more. A crossed pair costs 8 to 43,000, but for a single wrist of
gait2354, whose arms are raised: 2, too little to be found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.model.protocol import Protocol
from mbkf.numerics.elimination import Indices
from mbkf.numerics.levenberg_marquardt import minimise
from mbkf.numerics.rotations import nearest_rotations, quaternion_of
from mbkf.scaling.exchange_candidates import Candidates
from mbkf.scaling.exchange_costs import ExchangeCosts
from mbkf.scaling.fit import scaling_problem
from mbkf.scaling.frames import choose_frames
from mbkf.scaling.problem import ScalingProblem
from mbkf.scaling.records import ScalingSettings, ScalingState
from mbkf.scaling.search import first_poses

RANGE_SD_RAD = np.deg2rad(6.0)
"""Spread σ of a joint's excess over its range."""

LEAST_GAIN = 6.0
"""Least fall of E for which names are exchanged."""

LOOK_GAIN = 2.0
"""Least predicted fall for which an exchange is fitted."""

TRIED, SETS = 6, 3
"""Exchanges, and sets of both sides' pairs, that are fitted of those predicted at one state."""

ODD_FIT = 3.4
"""E per marker above which exchanged limbs are fitted without a prediction. Clean statics have 0.5 to 3.1."""

AGAIN = 3
"""Exchanges, the best from the neutral posture, that are fitted from the markers' own pose as well."""

MOST_LEFT = 4.0
"""E per marker above which no exchange counts: markers are misplaced in another way, as a ghost is."""

ROUNDS = 6
"""Greatest number of exchanges, one after the other."""

TOLERANCE, FIRST_STEPS, STEPS = 1e-3, 40, 25
"""End of a fit: relative decrease of the cost, and iterations from the markers' own pose and from the neutral one."""


@dataclass(frozen=True)
class StandingNames:
    """Likeliest names of a standing trial.

    Attributes:
        exchanges: Pairs of the protocol's names that are exchanged, one after the other.
        gain: Fall of E by these exchanges.
        misfit: E per marker that is left.
        before: E per marker under the names given.
        worst: The two markers that cost most.
        stray: True where the body fits well without the first of them: a ghost, which scaling leaves out.
    """

    exchanges: tuple[tuple[str, str], ...]
    gain: float
    misfit: float
    before: float
    worst: tuple[str, ...]
    stray: bool


@dataclass(frozen=True)
class _Fit:
    """A body fitted to the names in an order.

    Attributes:
        order: (M,) number of the trajectory of each marker.
        problem: The problem under these names.
        state: The fitted state.
        cost: E.
        neutral: State of the reference body in the neutral posture at the person's place.
    """

    order: Indices
    problem: ScalingProblem
    state: ScalingState
    cost: float
    neutral: ScalingState


def likeliest_names(
    static: MarkerTrajectories, protocol: Protocol, settings: ScalingSettings | None = None
) -> StandingNames:
    """The likeliest names of a standing trial that exchanges of those given lead to.

    Args:
        static: The standing trial, in the protocol's axes.
        protocol: The marker protocol.
        settings: Weights of the priors.

    Raises:
        NotObservable: Too few markers of the protocol.
    """
    frames = choose_frames([static], protocol, 1)
    problem = scaling_problem(frames, 1, protocol, None, settings or ScalingSettings())
    candidates = Candidates(problem.body, problem.markers, problem.seen[0])
    every = np.arange(len(problem.markers))
    best = first = _from_markers(_from_neutral(problem, every))
    for _ in range(ROUNDS):
        tried = [_from_neutral(problem, best.order[order]) for order in _likely(best, candidates, every)]
        tried.sort(key=lambda one: one.cost)
        better = min((_from_markers(one) for one in tried[:AGAIN]), key=lambda one: one.cost, default=best)
        if better.cost > best.cost - LEAST_GAIN:
            break
        best = better
    if best.cost > MOST_LEFT * problem.seen[0].sum():
        best = first
    names, seen = [marker.name for marker in problem.markers], max(1, int(problem.seen[0].sum()))
    pairs = tuple((names[a], names[b]) for a, b in _as_exchanges(best.order))
    stray = best.cost > MOST_LEFT * seen and _is_stray(best)
    worst = tuple(names[m] for m in np.argsort(-_shares(best))[:2])
    return StandingNames(pairs, first.cost - best.cost, best.cost / seen, first.cost / seen, worst, stray)


def _is_stray(fit: _Fit) -> bool:
    """True where the body fits well without the marker that costs most."""
    kept = fit.problem.measured_m.copy()
    kept[0, int(_shares(fit).argmax())] = np.nan
    other = _from_markers(_from_neutral(fit.problem.with_measurements(kept), np.arange(kept.shape[1])))
    return other.cost <= MOST_LEFT * other.problem.seen[0].sum()


def _shares(fit: _Fit) -> Array:
    """(M,) share of each marker in E: its error and its distance from its place in the protocol."""
    errors = (fit.problem.shown(fit.state).errors[0] ** 2).sum(axis=1)
    placement_m = np.array([marker.placement_sd_m for marker in fit.problem.markers])
    return np.asarray(errors + ((fit.state.offsets_m / placement_m[:, None]) ** 2).sum(axis=1))


def _likely(fit: _Fit, candidates: Candidates, every: Indices) -> list[Indices]:
    """Orders (M,) that may fit better, from those of a fit."""
    found = {order.tobytes(): order for order in candidates.arms}
    orders = np.concatenate([candidates.pairs, np.reshape(candidates.limbs, (-1, len(every)))]).astype(
        np.intp
    )
    for state in (fit.state, fit.neutral, _untwisted(fit.problem, fit.state)):
        costs = ExchangeCosts(fit.problem, state)
        changes = costs.changes(orders)
        likely = [orders[k] for k in np.argsort(changes)[:TRIED] if changes[k] < -LOOK_GAIN]
        sets = np.array(
            costs.likeliest_sets(candidates.sides, [every, *candidates.limbs])[:SETS], dtype=np.intp
        )
        likely += [order for order, one in zip(sets, costs.changes(sets), strict=True) if one < -LOOK_GAIN]
        found.update((order.tobytes(), order) for order in likely)
    if fit.cost > ODD_FIT * fit.problem.seen[0].sum():
        found.update((order.tobytes(), order) for order in candidates.limbs)
    return list(found.values())


def _from_neutral(problem: ScalingProblem, order: Indices) -> _Fit:
    """The body fitted to names in an order, from the neutral posture."""
    named = problem.with_measurements(problem.measured_m[:, order])
    neutral = _neutral(named)
    return _Fit(order, named, *_minimum(named, neutral, STEPS), neutral)


def _from_markers(fit: _Fit) -> _Fit:
    """The body fitted from the markers' own pose, where that is better."""
    start = fit.problem.start(first_poses(fit.problem))
    state, cost = _minimum(fit.problem, start, FIRST_STEPS)
    return fit if fit.cost < cost else replace(fit, state=state, cost=cost)


def _minimum(problem: ScalingProblem, start: ScalingState, steps: int) -> tuple[ScalingState, float]:
    """The minimum near a state, and E there."""
    found = minimise(
        start, problem.linearise, problem.cost, problem.move, tolerance=TOLERANCE, max_iterations=steps
    )
    beyond = _excess_rad(problem, found.state.poses[0]) / RANGE_SD_RAD
    return found.state, found.equations.cost + float(beyond @ beyond)


def _excess_rad(problem: ScalingProblem, q: Array) -> Array:
    """(nv,) rotations beyond the joints' ranges."""
    turned, limits = problem.posture.deviation(q)[0], problem.posture.model.limits
    return np.asarray(
        np.nan_to_num(np.maximum(np.maximum(turned - limits[:, 1], limits[:, 0] - turned), 0.0))
    )


def _neutral(problem: ScalingProblem) -> ScalingState:
    """The reference body in its neutral posture, where all markers fit it best (Wahba's problem)."""
    q, seen = problem.posture.model.neutral().copy(), problem.seen[0]
    sensor = problem.sensor(problem.start(q[None]))
    places, measured = sensor.positions(q)[seen], problem.measured_m[0, seen]
    middle = measured.mean(axis=0)
    q[3:7] = quaternion_of(nearest_rotations((measured - middle).T @ (places - places.mean(axis=0))))
    q[:3] += middle - sensor.positions(q)[seen].mean(axis=0)
    return problem.start(q[None])


def _untwisted(problem: ScalingProblem, state: ScalingState) -> ScalingState:
    """The reference body in a state's posture without its joints' turns about their segments' long axes."""
    q = state.poses[0].copy()
    for joint in problem.posture.model.joints.values():
        if joint.kind == "spherical":
            x, y, z, w = q[joint.q]
            if np.hypot(z, w) > 1e-6:  # swing = q t⁻¹ of the twist t = (0, 0, z, w) / |(z, w)|
                swing = np.array([x * w - y * z, y * w + x * z, 0.0, w * w + z * z])
                q[joint.q] = swing / np.hypot(z, w)
    return problem.start(q[None])


def _as_exchanges(order: Indices) -> list[tuple[int, int]]:
    """Exchanges that lead, one after the other, from the names given to an order."""
    found, now = [], np.arange(len(order))
    for m, one in enumerate(order):
        if now[m] != one:
            other = int(np.flatnonzero(now == one)[0])
            found.append((m, other))
            now[[m, other]] = now[[other, m]]
    return found
