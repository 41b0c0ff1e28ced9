"""Loads on other parts than the feet: where on a part's surface a known wrench acts."""

import numpy as np
import pytest

from mbkf.io.contacts import ContactInterval
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.trial.results.supports import LEAST_N, pressed_points, supports_of, supports_remarks
from tests.motions import assert_near, moderate_pose, random_model, track_of


@pytest.fixture
def rng():
    return np.random.default_rng(3)


@pytest.fixture
def model(rng):
    return random_model(rng)


def parts(model):
    return list(model.description.bearings.values())


def acting(points_m, force, couple=0.0):
    """(B, 6) wrenches of forces that act at points, with a couple along each force."""
    size = np.linalg.norm(force, axis=1, keepdims=True)
    return np.hstack([force, np.cross(points_m, force) + couple * force / size])


def middles_of(model, q):
    return BearingParts(model).at(q, np.zeros(model.nv)).points_m


def test_a_force_towards_the_middle_acts_on_the_surface_before_it(model, rng):
    q, points = moderate_pose(model, rng), BearingParts(model)
    force = 200.0 * rng.normal(size=(len(parts(model)), 3))
    middles = middles_of(model, q)
    found = pressed_points(points, q, acting(middles, force))
    away = middles - found
    assert_near(np.cross(away, force), 0.0, 1e-9)
    assert ((away * force).sum(axis=1) > 0.0).all(), "the force points from the surface into the part"
    for part, distance in zip(parts(model), np.linalg.norm(away, axis=1), strict=True):
        assert 0.7 * part.radius_m < distance < 1.4 * part.radius_m


def test_a_point_lies_on_the_axis_of_its_wrench_as_near_to_the_middle_as_that_gets(model, rng):
    """About the point, what is left of the moment is the couple along the force; off the force it is nearest."""
    q, points = moderate_pose(model, rng), BearingParts(model)
    middles = middles_of(model, q)
    force = 200.0 * rng.normal(size=middles.shape)
    wrench = acting(middles + 0.05 * rng.normal(size=middles.shape), force, couple=7.0)
    found = pressed_points(points, q, wrench)
    direction = force / np.linalg.norm(force, axis=1, keepdims=True)
    assert_near(wrench[:, 3:] - np.cross(found, force), 7.0 * direction, 1e-9)
    along = ((found - middles) * direction).sum(axis=1, keepdims=True)
    surface = np.linalg.norm(pressed_points(points, q, acting(middles, force)) - middles, axis=1)
    assert_near(-along[:, 0], surface, 1e-12)


def test_a_part_that_bears_next_to_nothing_has_no_point(model, rng):
    q = moderate_pose(model, rng)
    force = np.zeros((len(parts(model)), 3))
    force[0, 2], force[1, 2] = 0.99 * LEAST_N, 1.01 * LEAST_N
    found = pressed_points(BearingParts(model), q, np.hstack([force, 0.0 * force]))
    assert np.isfinite(found).all(axis=1).tolist() == [k == 1 for k in range(len(force))]


def test_a_trial_has_names_and_points_of_every_frame(model, rng):
    q = np.array([moderate_pose(model, rng) for _ in range(4)])
    names, zero = tuple(model.description.bearings), np.zeros((4, model.nv))
    support = np.zeros((4, len(names), 6))
    support[2, 3, :3] = [0.0, 0.0, 300.0]
    support[1], support[3], q[3] = np.nan, np.nan, np.nan
    found = supports_of(model, track_of(q, zero, zero, support=support, support_sd=0.1 * support))
    support[1] = 0.0  # followed before the first contact opened
    assert found.support_names == names
    np.testing.assert_array_equal(found.support_wrench, support)
    np.testing.assert_array_equal(found.support_wrench_sd, 0.1 * support)
    assert np.argwhere(np.isfinite(found.support_point_m).all(axis=2)).tolist() == [[2, 3]]
    assert_near(found.support_point_m[2, 3], pressed_points(BearingParts(model), q[2], support[2])[3], 0.0)


def test_a_filter_that_does_not_ask_has_no_parts(model, rng):
    q, zero = moderate_pose(model, rng)[None], np.zeros((1, model.nv))
    unasked = np.full((1, len(parts(model)), 6), np.nan)
    found = supports_of(model, track_of(q, zero, zero, support=unasked, support_sd=unasked))
    assert found.support_names == ()
    assert found.support_wrench.shape == (1, 0, 6) and found.support_point_m.shape == (1, 0, 3)


def test_loads_on_other_parts_are_told_with_their_times():
    feet = [ContactInterval("left_foot", 0.0, 2.0, 800.0, 5.0, "measured")]
    assert supports_remarks(feet) == ()
    (told,) = supports_remarks([*feet, ContactInterval("right_hand", 0.5, 1.25, 92.4, 8.0, "estimated")])
    assert told.endswith("right hand 0.50…1.25 s (up to 92 N)")
    many = [ContactInterval("pelvis", float(k), k + 0.5, 500.0, 9.0, "estimated") for k in range(9)]
    assert supports_remarks(many)[0].endswith(" and 3 more")
