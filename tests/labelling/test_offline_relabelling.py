"""A tracklet's label is decided by all of its frames."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.offline_relabelling import (
    RelabellingSettings,
    SmoothedCapture,
    SmoothedMarkers,
    majority_labels,
    worn_markers,
)
from mbkf.labelling.tracklets import link_points

SETTINGS = RelabellingSettings()
RATE_HZ = 100.0
NOISE_M = np.full(3, 0.005)


@pytest.fixture
def scene():
    """Three markers on a segment that turns and moves, in a hundred frames; positions (T, 3, 3) and the body."""
    rng = np.random.default_rng(4)
    t = np.arange(100) / RATE_HZ
    c, s = np.cos(t), np.sin(t)
    turn = np.zeros((100, 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = c, -s, s, c, 1.0
    local = np.array([[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.15]])
    on_body = np.einsum("tij,mj->tmi", turn, local) + np.array([1.0, 0.0, 0.0]) * t[:, None, None]
    course = SmoothedMarkers(on_body, np.repeat(turn[:, None], 3, axis=1), np.full((100, 3), 1e-6))
    return on_body + rng.normal(0.0, 0.001, on_body.shape), course


def beside(positions, tracklets, course, settings=SETTINGS):
    return SmoothedCapture(positions, tracklets, course, NOISE_M, 1.0 / RATE_HZ, settings)


def labels_of(positions, course, so_far):
    tracklets = link_points(positions)
    return tracklets.points(beside(positions, tracklets, course).relabelled(so_far))


def test_unnamed_points_get_the_names_of_their_places(scene):
    positions, course = scene
    nothing = np.full(positions.shape[:2], HIDDEN)
    assert (labels_of(positions, course, nothing) == [0, 1, 2]).all()


def test_a_ghost_that_wanders_past_a_hidden_marker_gets_no_name(scene):
    positions, course = scene
    drift = np.linspace(-0.04, 0.04, 60)[:, None] * np.array([0.0, 0.0, 1.0])
    positions[20:80, 1] = course.on_body_m[20:80, 1] + drift
    so_far = np.tile([0, 1, 2], (100, 1))
    found = labels_of(positions, course, so_far)
    assert (found[20:80, 1] == HIDDEN).all()
    assert (found[:, [0, 2]] == [0, 2]).all()
    assert (found[:15, 1] == 1).all()


def test_wrong_names_are_put_right_by_the_place(scene):
    positions, course = scene
    assert (labels_of(positions, course, np.tile([1, 0, 2], (100, 1))) == [0, 1, 2]).all()


def test_frames_without_a_body_say_nothing(scene):
    positions, course = scene
    lost = SmoothedMarkers(course.on_body_m.copy(), course.rotations, course.variance_m2.copy())
    for array in (lost.on_body_m, lost.variance_m2):
        array[:] = np.nan
    nothing = np.full(positions.shape[:2], HIDDEN)
    assert (labels_of(positions, lost, nothing) == HIDDEN).all()


def test_the_majority_of_frames_names_a_tracklet(scene):
    positions, _ = scene
    tracklets = link_points(positions)
    votes = np.tile([0, 1, 2], (100, 1))
    votes[10:30, 0], votes[10:30, 1] = 1, 0
    votes[5:50, 2] = HIDDEN
    assert (tracklets.points(majority_labels(votes, 3, tracklets, SETTINGS)) == [0, 1, 2]).all()
    seldom = np.full((100, 3), HIDDEN)
    seldom[:8, 0] = 0
    assert (majority_labels(seldom, 3, tracklets, SETTINGS) == HIDDEN).all()


def test_a_label_that_two_tracklets_carried_goes_to_the_one_without_another(scene):
    """A marker hidden at first, whose neighbour was taken for it: the neighbour has its own name for the rest."""
    positions, _ = scene
    positions[20:40, 0] = np.nan
    tracklets = link_points(positions)
    carried = np.tile([HIDDEN, 0, 2], (100, 1))
    carried[60:, 0], carried[60:, 1] = 0, 1
    found = tracklets.points(majority_labels(carried, 3, tracklets, SETTINGS))
    assert (found[40:] == [0, 1, 2]).all() and (found[:40, 1:] == [1, 2]).all()


def test_no_label_twice_in_a_frame(scene):
    positions, _ = scene
    tracklets = link_points(positions)
    same = np.zeros((100, 3), dtype=int)
    same[40:, 1] = HIDDEN
    labels = majority_labels(same, 3, tracklets, SETTINGS)
    for one, other in pairwise(np.flatnonzero(labels == 0)):
        assert tracklets.spans[one, 1] <= tracklets.spans[other, 0]
    assert (labels == 0).sum() == 1


def test_a_marker_made_up_of_ghosts_was_not_worn(scene):
    positions, course = scene
    rng = np.random.default_rng(0)
    segments = ["shank"] * 3
    assert worn_markers(course, positions, NOISE_M, segments, SETTINGS).all()
    rare = positions.copy()
    rare[10:, 2] = np.nan
    assert worn_markers(course, rare, NOISE_M, segments, SETTINGS).tolist() == [True, True, False]
    scattered = positions.copy()
    scattered[30:, 2] = np.nan
    assert worn_markers(course, scattered, NOISE_M, segments, SETTINGS).all()
    scattered[:30, 2] += rng.normal(0.0, 0.02, (30, 3))
    assert worn_markers(course, scattered, NOISE_M, segments, SETTINGS).tolist() == [True, True, False]
    assert not worn_markers(course, np.full_like(positions, np.nan), NOISE_M, segments, SETTINGS).any()


def test_a_tracklet_far_from_its_marker_is_in_doubt(scene):
    positions, course = scene
    so_far = np.tile([0, 1, 2], (100, 1))
    moved = positions + np.array([[0.0], [0.03], [0.0]])
    tracklets = link_points(moved)
    far = beside(moved, tracklets, course).doubtful(so_far)
    assert far.tolist() == [False, True, False]
    so_far[:, 1] = HIDDEN
    assert not beside(moved, tracklets, course).doubtful(so_far).any()


def test_a_brief_tracklet_is_in_doubt(scene):
    positions, course = scene
    positions[20:90, 0] = np.nan
    tracklets = link_points(positions)
    far = beside(positions, tracklets, course).doubtful(np.tile([0, 1, 2], (100, 1)))
    assert np.array_equal(far, np.diff(tracklets.spans, axis=1)[:, 0] < 25)
    assert far.sum() == 2


def test_where_all_is_in_doubt_nothing_is(scene):
    positions, course = scene
    positions[10:15] = np.nan
    tracklets = link_points(positions)
    so_far = np.tile([0, 1, 2], (100, 1))
    assert not beside(positions, tracklets, course).doubtful(so_far).any()


@pytest.mark.parametrize(("ghosts", "named"), [(0.9, True), (1.1, False)])
def test_a_single_look_names_a_point_where_its_marker_is_denser_there_than_ghosts(scene, ghosts, named):
    """2 ln N(r; 0, S I) against 2 ln λ, both per m³."""
    _, course = scene
    off, place = 0.01, SETTINGS.placement_sd_m**2 + NOISE_M[0] ** 2 + course.variance_m2[0, 0]
    one = course.on_body_m[:1, :1] + np.array([off, 0.0, 0.0])
    density = multivariate_normal(np.zeros(3), place).pdf([off, 0.0, 0.0])
    first = SmoothedMarkers(*(part[:1] for part in (course.on_body_m, course.rotations, course.variance_m2)))
    settings = replace(SETTINGS, ghosts_per_m3=ghosts * density)
    tracklets = link_points(one)
    label = beside(one, tracklets, first, settings).relabelled(np.full((1, 1), HIDDEN))
    assert (label == 0).all() == named
