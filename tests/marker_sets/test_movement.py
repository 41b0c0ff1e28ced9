"""Which segment a marker moves with: scatter in the frames of segments over a walk."""

import numpy as np
import pytest
from scipy.stats import t as student

from mbkf.marker_sets.frames import spread_frames
from mbkf.marker_sets.movement import (
    FREEDOM,
    OBSERVATIONS,
    Movement,
    movement,
    movement_cost,
    segment_scatter_m,
)
from mbkf.synthesis.person import body_of, synthesise_subject
from tests.marker_sets.worn import box_at, walking

SUBJECT = synthesise_subject(1, "plug_in_gait")
MODEL = body_of(SUBJECT)
SEGMENTS = [segment.name for segment in MODEL.description.segments]
MOVING = ("pelvis", "thigh", "shank", "foot", "forearm")
"""Segments that a walk moves well against their neighbours."""


@pytest.fixture(scope="module")
def worn():
    return walking("plug_in_gait", 1, 0.0)[1].beside(box_at(0.5, 1.0, 0.0))


@pytest.fixture(scope="module")
def seen(worn):
    names = worn.markers.names
    local = {marker.name: marker.position_m for marker in SUBJECT.markers}
    on_body = np.array([bool(worn.segments[name]) for name in names])
    return movement(
        MODEL,
        spread_frames([worn.markers], names),
        [worn.segments[name] or "pelvis" for name in names],
        np.array([local.get(name, np.zeros(3)) for name in names]),
        on_body,
    )


def spread_of(seen):
    return np.sqrt(seen.squared_m2 / (3.0 * OBSERVATIONS))


def test_a_marker_scatters_least_on_its_own_segment(worn, seen):
    """Toes that carry no marker are posed straight: they go with the foot."""
    names = worn.markers.names
    judged = [k for k, name in enumerate(names) if worn.segments[name].endswith(MOVING)]
    assert len(judged) > 15
    for k in judged:
        own = worn.segments[names[k]]
        least = SEGMENTS[int(spread_of(seen)[k].argmin())]
        assert least in (own, own.replace("foot", "toes")), names[k]


def test_there_it_rests_at_its_place(worn, seen):
    local = {marker.name: marker.position_m for marker in SUBJECT.markers}
    for k, name in enumerate(worn.markers.names):
        if worn.segments[name]:
            s = SEGMENTS.index(worn.segments[name])
            np.testing.assert_allclose(seen.mean_m[k, s], local[name], atol=0.01)
            assert spread_of(seen)[k, s] < 0.005
    assert seen.rms_m < 0.005


def test_a_box_moves_with_no_segment(worn, seen):
    box = [k for k, name in enumerate(worn.markers.names) if not worn.segments[name]]
    assert spread_of(seen)[box].min() > 0.05


def test_a_marker_that_is_never_seen_has_no_place(worn):
    positions = spread_frames([worn.markers], worn.markers.names).copy()
    positions[:, 3] = np.nan
    local = {marker.name: marker.position_m for marker in SUBJECT.markers}
    names = worn.markers.names
    sure = np.array([bool(worn.segments[name]) for name in names])
    found = movement(
        MODEL,
        positions,
        [worn.segments[name] or "pelvis" for name in names],
        np.array([local.get(name, np.zeros(3)) for name in names]),
        sure,
    )
    assert np.isnan(found.mean_m[3]).all()
    assert (found.squared_m2[3] == 0.0).all()
    assert np.isfinite(np.delete(found.mean_m, 3, axis=0)).all()


def test_unrest_is_the_median_of_a_segments_own_markers():
    spread = np.array([[0.01, 9.0], [0.03, 9.0], [0.02, 9.0], [9.0, 0.05]])
    seen = Movement(np.zeros((4, 2, 3)), 3.0 * OBSERVATIONS * spread**2, 0.0)
    np.testing.assert_allclose(segment_scatter_m(seen, np.array([0, 0, 0, 1]), 2), [0.02, 0.05])
    # a segment without markers is as restless as all are in the median
    np.testing.assert_allclose(segment_scatter_m(seen, np.array([0, 0, 0, 1]), 3)[2], 0.025)


def test_the_cost_is_that_of_a_student_distribution():
    """In one dimension it is scipy's; OBSERVATIONS of three coordinates are so many dimensions more."""
    spread, x = 0.01, np.array([0.0, 0.005, 0.02, 0.1])
    exact = -student.logpdf(x / spread, FREEDOM)
    of_one = 0.5 * (FREEDOM + 1.0) * np.log1p(x**2 / (spread**2 * FREEDOM))
    np.testing.assert_allclose(of_one, exact - exact[0])
    ratio = (FREEDOM + 3.0 * OBSERVATIONS) / (FREEDOM + 1.0)
    np.testing.assert_allclose(movement_cost(x**2, np.array(spread)), ratio * of_one)


def test_more_scatter_costs_more_and_less_where_more_is_expected():
    squared = np.array([0.0, 1e-4, 1e-3, 1e-2])
    cost = movement_cost(squared, np.array(0.01))
    assert cost[0] == 0.0
    assert (np.diff(cost) > 0.0).all()
    assert (movement_cost(squared[1:], np.array(0.03)) < cost[1:]).all()
