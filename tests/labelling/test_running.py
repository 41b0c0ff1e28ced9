"""Labels from frame to frame on points that drift, hide, come back, and are confused."""

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.running import RunningLabeller, RunningSettings
from mbkf.sensors.marker_sensor import MarkerPrediction
from tests.labelling.bodies import posture, reference_sensor

SENSOR = reference_sensor()
COUNT = len(SENSOR.segments)
Q = posture(SENSOR.model, np.random.default_rng(0), 0.1)
ON_BODY = SENSOR.positions(Q)
EXPECTED = MarkerPrediction(SENSOR.reading(Q), 1e-6 * np.eye(SENSOR.model.nv))


def labeller(placement_m=0.01, **changes):
    return RunningLabeller(
        np.full(COUNT, 0.005), np.full(COUNT, placement_m), 0.01, RunningSettings(**changes)
    )


def step(one, points, follows=None):
    labels = one.label(EXPECTED, points, follows)
    one.remember(labels, points, ON_BODY)
    return labels


def test_points_on_the_body_get_their_own_labels():
    order = np.random.default_rng(1).permutation(COUNT)
    assert np.array_equal(step(labeller(), ON_BODY[order]), np.argsort(order))


def test_an_offset_is_remembered_through_a_short_gap():
    """Two markers 20 mm off come back after five frames; a fresh labeller would have to guess."""
    offset = np.zeros((COUNT, 3))
    offset[4] = [0.0, 0.0, 0.02]
    one = labeller()
    for _ in range(10):
        step(one, ON_BODY + offset)
    hidden = np.delete(ON_BODY + offset, 4, axis=0)
    for _ in range(5):
        assert step(one, hidden)[4] == HIDDEN
    assert step(one, ON_BODY + offset)[4] == 4


@pytest.mark.parametrize("tracked", [False, True])
def test_exchanged_labels_are_taken_back(tracked):
    """The labeller is made to believe in an exchange of two labels; geometry wins within twenty frames."""
    one = labeller()
    pair = list(nearest_pair())
    wrong = np.arange(COUNT)
    wrong[pair] = wrong[pair[::-1]]
    for _ in range(30):
        one.remember(wrong, ON_BODY, ON_BODY)
    follows = (lambda: np.arange(COUNT)) if tracked else None
    found = [step(one, ON_BODY, follows) for _ in range(20)]
    assert np.array_equal(found[-1], np.arange(COUNT))


def nearest_pair():
    apart = np.linalg.norm(ON_BODY[:, None] - ON_BODY, axis=2) + np.eye(COUNT)
    return np.unravel_index(apart.argmin(), apart.shape)


def test_a_ghost_beside_a_marker_contradicts_the_pose():
    one = labeller()
    for _ in range(5):
        step(one, ON_BODY)
    points = ON_BODY.copy()
    points[7] += [0.03, 0.0, 0.0]
    labels = np.arange(COUNT)
    assert np.flatnonzero(one.contradicted(labels, points, ON_BODY)).tolist() == [7]


def test_many_far_points_contradict_nothing():
    one = labeller()
    for _ in range(5):
        step(one, ON_BODY)
    labels = np.arange(COUNT)
    assert not one.contradicted(labels, ON_BODY + np.array([0.05, 0.0, 0.0]), ON_BODY).any()
    assert not one.contradicted(np.full(COUNT, HIDDEN), np.zeros((0, 3)), ON_BODY).any()


def test_empty_frames_hide_all_and_restart_forgets():
    one = labeller()
    step(one, ON_BODY + np.array([0.0, 0.0, 0.005]))
    assert (step(one, np.zeros((0, 3))) == HIDDEN).all()
    one.restart()
    fresh = labeller()
    points = ON_BODY + np.array([0.0, 0.01, 0.0])
    assert np.array_equal(step(one, points), step(fresh, points))
