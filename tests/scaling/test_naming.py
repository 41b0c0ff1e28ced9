"""What names cost: nothing is gained by a wrong one, and the shares of the trajectories add up."""

import math
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.model.protocol import load_protocol
from mbkf.scaling.naming import STILL_WORN, NamingProblem
from tests.motions import marker_positions, moderate_pose, protocol_sensor, random_model

PROTOCOL = load_protocol("reference36")
STEPS = 40


def trial(seed=0, keep=None, frames=14, noise_m=0.002, protocol="reference36"):
    """A made-up person's markers, at their places but for the noise."""
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    sensor, names = protocol_sensor(model, protocol, keep)
    positions = marker_positions(sensor, [moderate_pose(model, rng, 0.8) for _ in range(frames)])
    return MarkerTrajectories(names, positions + noise_m * rng.normal(size=positions.shape), 100.0)


@pytest.fixture(scope="module")
def problem():
    return NamingProblem(trial(), PROTOCOL)


@pytest.fixture(scope="module")
def true(problem):
    return problem.fitted(problem.first, None, STEPS)


def exchanged(problem, one, other):
    """The first names with two of them exchanged."""
    names = [marker.name for marker in problem.markers]
    marker = problem.first.copy()
    a, b = names.index(one), names.index(other)
    marker[a], marker[b] = b, a
    return marker


@pytest.mark.parametrize("pair", [("RANK", "RHEE"), ("RKNE", "RTUB"), ("RFHD", "LFHD"), ("RHA2", "LHA2")])
def test_exchanged_names_cost_more(problem, true, pair):
    assert problem.fitted(exchanged(problem, *pair), None, STEPS).cost > true.cost + 10.0


def test_a_person_fits_and_exchanged_legs_do_not(problem, true):
    assert true.misfit < 0.4
    marker = problem.first.copy()
    names = [one.name for one in problem.markers]
    for part in ("THI", "KNE", "TUB", "ANK", "HEE", "MID", "MT1", "MT5", "HAL"):
        right, left = names.index(f"R{part}"), names.index(f"L{part}")
        marker[[right, left]] = left, right
    assert problem.fitted(marker, None, STEPS).misfit > 1.0


def test_shares_tell_what_other_names_cost_with_poses_fixed(problem, true):
    """Σ shares differs by as much as C + Σ 6 ln σ_p, offsets at their best, computed sample by sample."""
    share, offsets = problem.shares(true.state)
    other = exchanged(problem, "RKNE", "RTUB")
    rows = np.arange(len(other))
    expected = []
    for marker in (problem.first, other):
        # The terms of E that names change, written out with the offsets that shares() gives.
        best = np.zeros_like(true.state.offsets_m)
        best[marker] = offsets[rows, marker]
        named = np.full((12, len(problem.markers), 3), np.nan)
        named[:, marker] = problem._shown_m
        with_names = problem._problem.with_measurements(named)
        cost = with_names.cost(replace(true.state, offsets_m=best))
        placement = np.array([one.placement_sd_m for one in problem.markers])[marker]
        expected.append(cost + 6.0 * np.log(placement).sum())
    found = share[rows, other].sum() - share[rows, problem.first].sum()
    assert found == pytest.approx(expected[1] - expected[0], rel=1e-9)


def test_shares_are_least_at_their_offsets(problem, true):
    """No other offset of a marker lowers the cost with poses fixed."""
    _, offsets = problem.shares(true.state)
    rows = np.arange(len(problem.first))
    named = np.full((12, len(problem.markers), 3), np.nan)
    named[:, problem.first] = problem._shown_m
    one = problem._problem.with_measurements(named)
    best = np.zeros_like(true.state.offsets_m)
    best[problem.first] = offsets[rows, problem.first]
    least = one.cost(replace(true.state, offsets_m=best))
    rng = np.random.default_rng(1)
    for _ in range(5):
        moved = best + 0.002 * rng.normal(size=best.shape)
        assert one.cost(replace(true.state, offsets_m=moved)) > least


def test_markers_for_static_trials_cost_their_odds():
    markers = tuple(replace(one, static_only=one.name == "RTUB") for one in PROTOCOL.markers)
    costs = []
    for protocol in (PROTOCOL, replace(PROTOCOL, markers=markers)):
        problem = NamingProblem(trial(), protocol)
        costs.append(problem.fitted(problem.first, None, STEPS).cost)
    assert costs[1] - costs[0] == pytest.approx(-2.0 * math.log(STILL_WORN), abs=1e-6)


def test_markers_that_are_not_shown_take_no_part():
    worn = [marker.name for marker in PROTOCOL.markers if marker.name not in ("RTUB", "LFHD")]
    problem = NamingProblem(trial(keep=worn), PROTOCOL)
    assert [problem.markers[m].name for m in problem.first] == worn
    found = problem.fitted(problem.first, None, STEPS)
    unseen = np.setdiff1d(np.arange(len(problem.markers)), problem.first)
    np.testing.assert_allclose(found.state.offsets_m[unseen], 0.0, atol=1e-9)
    assert problem.offsets_m(found).shape == problem.first.shape


def test_too_few_markers_are_refused():
    with pytest.raises(NotObservable):
        NamingProblem(trial(keep=("RASI", "LASI", "SACR")), PROTOCOL)
