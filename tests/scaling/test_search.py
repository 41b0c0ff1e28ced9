"""The search starts near the minimum where some frames stand, and joints are not wound up on the way."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.scaling.fit import scaling_problem
from mbkf.scaling.frames import choose_frames
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.search import first_poses, first_state, minimum
from tests.scaling.test_fit import PROTOCOL, Person


@pytest.fixture(scope="module")
def problem():
    person = Person(4)
    trials = [person.standing(6, 1e-3), person.moving(10, 1e-3)]
    return scaling_problem(choose_frames(trials, PROTOCOL, 40), 1, PROTOCOL, None, ScalingSettings())


def test_the_first_state_is_nearer_to_the_minimum_than_the_expected_body(problem):
    start = first_state(problem)
    plain = problem.start(first_poses(problem))
    assert problem.cost(start) < 0.2 * problem.cost(plain)
    one, other = minimum(problem, start), minimum(problem, plain)
    assert one.iterations < other.iterations
    assert one.equations.cost == pytest.approx(other.equations.cost, rel=1e-3)


def test_without_moving_frames_the_search_starts_at_the_expected_body(problem):
    standing = problem.of_frames(np.arange(6))
    np.testing.assert_array_equal(first_state(standing).factors, standing.prior.factors)


def test_a_search_with_greater_tolerance_ends_earlier(problem):
    start = problem.start(first_poses(problem))
    assert (
        minimum(problem, start, tolerance=0.5).iterations < minimum(problem, start, tolerance=1e-9).iterations
    )


def test_progress_counts_iterations(problem):
    done = []
    found = minimum(problem, first_state(problem), lambda *one: done.append(one))
    assert [one for one, _ in done] == list(range(1, found.iterations + 1))


def test_joints_turn_by_a_radian_at_most_in_a_step(problem):
    state = problem.start(first_poses(problem))
    model = HumanModel.scaled(body=problem.body)
    own = np.zeros((len(state.poses), model.nv))
    own[0, model.root.v.stop + 2], own[1, model.root.v.stop + 2] = 5.0, 0.5
    count = len(state.factors) + state.offsets_m.size
    moved = problem.move(state, own, np.zeros(count))
    turned = [np.abs(model.difference(a, b)).max() for a, b in zip(state.poses, moved.poses, strict=True)]
    np.testing.assert_allclose(turned[:3], [1.0, 0.5, 0.0], atol=1e-9)
