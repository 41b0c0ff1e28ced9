"""Point masses on a body: their mass matrix is the information of that many readings of points."""

import numpy as np
import pytest

from mbkf.model.point_masses import PointMasses
from tests.motions import assert_near, moderate_pose, protocol_sensor, random_model


@pytest.fixture
def case():
    rng = np.random.default_rng(1)
    model = random_model(rng)
    sensor, _ = protocol_sensor(model)
    masses = rng.uniform(0.1, 5.0, len(sensor.segments))
    points = PointMasses(model, sensor.joint_ids, sensor.local_m, masses)
    return rng, model, sensor, masses, points


def expected(sensor, masses, q, counted):
    H = sensor.reading(q).jacobian[counted]
    return np.einsum("mij,mik,m->jk", H, H, masses[counted])


def test_the_mass_matrix_is_the_weighted_sum_over_the_points(case):
    """Any subset of points, one after the other, on the same object."""
    rng, model, sensor, masses, points = case
    for share in (1.0, 0.5, 0.0, 0.9, 1.0):
        counted = rng.random(len(masses)) < share
        q = moderate_pose(model, rng)
        found = points.mass_matrix(q, counted)
        assert_near(found, expected(sensor, masses, q, counted), 1e-13 * masses.sum())
        np.testing.assert_array_equal(found, found.T)


def test_the_choice_of_points_is_copied(case):
    rng, model, sensor, masses, points = case
    counted, q = np.ones(len(masses), bool), moderate_pose(model, rng)
    points.mass_matrix(q, counted)
    counted[:5] = False
    assert_near(points.mass_matrix(q, counted), expected(sensor, masses, q, counted), 1e-12)


def test_results_are_new_arrays_and_the_body_keeps_its_masses(case):
    rng, model, _, masses, points = case
    q, everything = moderate_pose(model, rng), np.ones(len(masses), bool)
    before, first = model.mass_matrix(q), points.mass_matrix(q, everything)
    kept = first.copy()
    points.mass_matrix(moderate_pose(model, rng), everything)
    np.testing.assert_array_equal(first, kept)
    np.testing.assert_array_equal(model.mass_matrix(q), before)
