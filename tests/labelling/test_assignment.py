"""Assignment of points to predicted markers: cheapest, gated, one label per point, in any order of the points."""

from functools import partial
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.labelling.assignment import (
    HIDDEN,
    AssignmentSettings,
    assign,
    cheapest_pairs,
    pair_costs,
    squared_distances,
)

SETTINGS = AssignmentSettings()
seeds = st.integers(0, 10_000)


def scene(seed, markers=12, ghosts=4, noise_m=0.006, spread_m=0.25):
    """Predicted markers, their covariances, and shuffled points with the true point of each marker."""
    rng = np.random.default_rng(seed)
    predicted = rng.uniform(-spread_m, spread_m, (markers, 3)) + np.array([1.0, -2.0, 1.0])
    factors = rng.normal(0.0, 0.004, (markers, 3, 3))
    covariance = factors @ factors.transpose(0, 2, 1) + noise_m**2 * np.eye(3)
    points = np.concatenate(
        [
            predicted + rng.normal(0.0, noise_m, predicted.shape),
            predicted[:ghosts] + np.array([0.0, 0.0, 3.0]),
        ]
    )
    order = rng.permutation(len(points))
    return predicted, covariance, points[order], np.argsort(order)[:markers]


@given(seeds)
def test_no_point_has_two_labels(seed):
    predicted, covariance, points, _ = scene(seed, spread_m=0.03)
    found = assign(predicted, points, lambda chosen: covariance[chosen], SETTINGS)
    used = found[found != HIDDEN]
    assert len(used) == len(set(used.tolist()))


@given(seeds)
def test_order_of_points_does_not_matter(seed):
    predicted, covariance, points, _ = scene(seed, spread_m=0.05)
    order = np.random.default_rng(seed + 1).permutation(len(points))
    one = assign(predicted, points, lambda chosen: covariance[chosen], SETTINGS)
    two = assign(predicted, points[order], lambda chosen: covariance[chosen], SETTINGS)
    assert np.array_equal(two == HIDDEN, one == HIDDEN)
    seen = one != HIDDEN
    assert np.allclose(points[order][two[seen]], points[one[seen]])


@given(seeds)
def test_ghosts_far_away_change_nothing(seed):
    predicted, covariance, points, _ = scene(seed, ghosts=0)
    far = points + np.array([0.0, 0.0, 5.0])
    alone = assign(predicted, points, lambda chosen: covariance[chosen], SETTINGS)
    joined = assign(predicted, np.concatenate([points, far]), lambda chosen: covariance[chosen], SETTINGS)
    assert np.array_equal(alone, joined)


@given(seeds)
def test_shortcut_finds_what_the_whole_problem_finds(seed):
    """Undisputed markers are taken without covariances; the answer is that without this shortcut."""
    predicted, covariance, points, truth = scene(seed)
    apart = squared_distances(predicted, predicted)[~np.eye(len(predicted), dtype=bool)].min() > 0.05**2
    short = assign(predicted, points, lambda chosen: covariance[chosen], SETTINGS)
    whole = assign(predicted, points, lambda chosen: covariance[chosen], AssignmentSettings(near_m=0.0))
    if apart:
        assert np.array_equal(short, whole)
        assert (short[short != HIDDEN] == truth[short != HIDDEN]).all()


@given(seeds)
def test_cheapest_pairs_are_cheapest(seed):
    rng = np.random.default_rng(seed)
    cost = rng.normal(0.0, 5.0, (4, 5))
    cost[rng.random((4, 5)) < 0.2] = np.inf
    found = cheapest_pairs(cost)
    total = sum(cost[row, column] for row, column in enumerate(found) if column != HIDDEN)
    least = min(
        sum(min(cost[row, column], 0.0) for row, column in enumerate(columns))
        for columns in permutations(range(5), 4)
    )
    assert total == pytest.approx(least)


def test_more_markers_than_points():
    predicted, covariance, points, truth = scene(3, ghosts=0)
    kept = np.arange(len(points)) % 2 == 0
    found = assign(predicted, points[kept], lambda chosen: covariance[chosen], SETTINGS)
    assert (found != HIDDEN).sum() <= kept.sum()
    assert np.array_equal(found[~kept[truth]], np.full((~kept[truth]).sum(), HIDDEN))


def test_no_points_hide_every_marker():
    predicted, covariance, _, _ = scene(0)
    found = assign(predicted, np.zeros((0, 3)), lambda chosen: covariance[chosen], SETTINGS)
    assert (found == HIDDEN).all()


@pytest.mark.parametrize(("away", "accepted"), [(0.9, True), (1.1, False)])
def test_gate_is_a_mahalanobis_distance(away, accepted):
    """A long thin covariance lets a point be far along its axis and not across it."""
    sd = np.array([0.02, 0.004, 0.004])
    settings = AssignmentSettings(gate=9.0, ghosts_per_m3=1e-6, radius_m=1.0)
    for axis in range(3):
        point = np.zeros((1, 3))
        point[0, axis] = away * 3.0 * sd[axis]
        cost = pair_costs(point[None], np.diag(sd**2)[None], settings)
        assert np.isfinite(cost[0, 0]) == accepted


def test_radius_is_hard():
    settings = AssignmentSettings(radius_m=0.05, ghosts_per_m3=1e-9, near_m=0.0)
    wide = np.eye(3)[None]
    for distance, expected in ((0.049, 0), (0.051, HIDDEN)):
        found = assign(np.zeros((1, 3)), np.array([[distance, 0.0, 0.0]]), lambda _: wide, settings)
        assert found[0] == expected


def test_sure_marker_beats_a_vague_one_for_the_same_point():
    """Mahalanobis distance alone would give every point to the marker that knows least."""
    predicted = np.array([[0.0, 0.0, 0.0], [0.012, 0.0, 0.0]])
    covariance = np.array([0.006**2 * np.eye(3), 0.1**2 * np.eye(3)])
    point = np.array([[0.010, 0.0, 0.0]])
    assert assign(predicted, point, lambda chosen: covariance[chosen], SETTINGS).tolist() == [0, HIDDEN]


def test_own_track_decides_between_equals():
    predicted = np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]])
    points = np.array([[0.004, 0.0, 0.0], [0.006, 0.0, 0.0]])
    covariance = np.repeat(0.006**2 * np.eye(3)[None], 2, axis=0)
    for known in ([0, 1], [1, 0]):
        found = assign(
            predicted, points, lambda chosen: covariance[chosen], SETTINGS, partial(np.array, known)
        )
        assert found.tolist() == np.argsort(known).tolist()


def test_geometry_overrules_a_track():
    predicted = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]])
    covariance = np.repeat(0.006**2 * np.eye(3)[None], 2, axis=0)
    found = assign(predicted, predicted, lambda chosen: covariance[chosen], SETTINGS, np.array([1, 0]))
    assert found.tolist() == [0, 1]


def test_in_a_clear_frame_no_covariance_is_asked_for():
    """Each marker has one point near and none else about, one is hidden: neither covariances nor tracks are needed."""
    predicted = np.arange(12.0)[:, None] * np.array([0.2, 0.0, 0.0])
    order = np.random.default_rng(0).permutation(11)
    points = (predicted[:11] + np.array([0.0, 0.004, 0.0]))[order]

    def asked(*_):
        raise AssertionError("asked in vain")

    found = assign(predicted, points, asked, SETTINGS, asked)
    assert found.tolist() == [*np.argsort(order), HIDDEN]


@pytest.mark.parametrize("away_m", [0.05, 0.12])
def test_a_free_point_about_a_hidden_marker_is_looked_at(away_m):
    """Also where that point is nearer to the hidden marker than any taken one, and where a taken one is nearer."""
    predicted = np.array([[0.0, 0.0, 0.0], [0.04, 0.0, 0.0], [1.0, 0.0, 0.0]])
    points = np.array([[0.0, 0.001, 0.0], [0.04, away_m, 0.0], [1.0, 0.001, 0.0]])
    covariance = np.repeat(0.05**2 * np.eye(3)[None], 3, axis=0)
    found = assign(predicted, points, lambda chosen: covariance[chosen], SETTINGS)
    assert found.tolist() == [0, 1, 2]
