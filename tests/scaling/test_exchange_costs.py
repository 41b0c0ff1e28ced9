"""Costs of exchanged names in one Gauss–Newton step."""

from itertools import product

import numpy as np
import pytest

from mbkf.model.protocol import load_protocol
from mbkf.scaling.exchange_candidates import exchanged
from mbkf.scaling.exchange_costs import ExchangeCosts
from mbkf.scaling.fit import scaling_problem
from mbkf.scaling.frames import choose_frames
from mbkf.scaling.records import ScalingSettings
from tests.motions import capture_of, marker_positions, moderate_pose, protocol_sensor, random_model

MODEL = random_model(np.random.default_rng(3), spread=0.03)


@pytest.fixture(scope="module")
def problem():
    sensor, names = protocol_sensor(MODEL)
    q = moderate_pose(MODEL, np.random.default_rng(4), spread=0.2)
    protocol = load_protocol("reference36")
    frames = choose_frames([capture_of(names, marker_positions(sensor, [q])).markers], protocol, 1)
    return scaling_problem(frames, 1, protocol, None, ScalingSettings())


@pytest.fixture(scope="module")
def state(problem):
    q = moderate_pose(MODEL, np.random.default_rng(4), spread=0.1)
    return problem.start(q[None])


def least(problem, state):
    """Least value of the quadratic cost at the state, from the equations of these names."""
    found = problem.linearise(state)
    own, shared = found.step(0.0)
    return found.cost + found.frame_gradient[0] @ own[0] + found.corner_gradient @ shared


def orders_of(problem, *pairs):
    names = [marker.name for marker in problem.markers]
    return [exchanged(len(names), [(names.index(a), names.index(b)) for a, b in one]) for one in pairs]


def test_the_change_is_that_of_the_equations_under_the_other_names(problem, state):
    orders = orders_of(problem, [("RKNE", "RANK")], [("RKNE", "LKNE"), ("RHEE", "RMT5")], [])
    found = ExchangeCosts(problem, state).changes(np.array(orders))
    base = least(problem, state)
    for order, change in zip(orders, found, strict=True):
        other = problem.with_measurements(problem.measured_m[:, order])
        assert change == pytest.approx(least(other, state) - base, rel=1e-6, abs=1e-6)
    assert found[2] == pytest.approx(0.0, abs=1e-8)


def test_the_best_set_of_pairs_is_found(problem, state):
    names = [marker.name for marker in problem.markers]
    pairs = [(names.index("R" + one), names.index("L" + one)) for one in ("KNE", "TUB", "ANK", "HEE")]
    crossed = exchanged(len(names), [pairs[0], pairs[1]])
    costs = ExchangeCosts(problem.with_measurements(problem.measured_m[:, crossed]), state)
    subsets = [
        exchanged(len(names), [p for p, on in zip(pairs, chosen, strict=True) if on])
        for chosen in product((0, 1), repeat=4)
    ]
    best = subsets[int(costs.changes(np.array(subsets)).argmin())]
    found = costs.likeliest_sets(pairs, [np.arange(len(names))])
    assert found[0].tolist() == best.tolist() == crossed.tolist()
