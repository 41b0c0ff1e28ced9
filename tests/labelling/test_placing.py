"""Points near the places of a segment's markers: their densities against that of ghosts."""

import numpy as np
from scipy.stats import multivariate_normal

from mbkf.labelling.assignment import AssignmentSettings
from mbkf.labelling.placing import FramePlacings, log_likelihood_ratio, placings
from mbkf.labelling.skeleton import clusters
from tests.labelling.bodies import posture, reference_sensor, unlabelled


def test_the_ratio_of_a_point_is_twice_the_log_of_its_marker_s_density_over_that_of_ghosts():
    away, sd = np.array([[0.01, 0.0, 0.02], [0.0, 0.0, 0.0]]), np.array([0.01, 0.03])
    densities = [multivariate_normal(np.zeros(3), s**2).pdf(r) for r, s in zip(away, sd, strict=True)]
    found = log_likelihood_ratio((away**2).sum(axis=1), sd)
    np.testing.assert_allclose(
        found, 2.0 * np.log(np.array(densities) / AssignmentSettings.ghosts_per_m3), rtol=1e-12
    )


def test_the_placings_of_a_frame_are_those_of_all_its_points_and_found_once():
    """Points out of a segment's reach change nothing."""
    rng, sensor = np.random.default_rng(3), reference_sensor()
    q = posture(sensor.model, rng)
    points = unlabelled(sensor.positions(q), rng, 2, 5).points
    rotations, origins = sensor.model.placements(q)
    found, free = FramePlacings(points), np.delete(np.arange(len(points)), [1, 7])
    for cluster in clusters(sensor, np.full(len(sensor.segments), 0.006)):
        joint = sensor.model.joint(cluster.segment).joint_id
        ways = found(cluster, origins[joint], rotations[joint], free)
        assert found(cluster, origins[joint].copy(), rotations[joint].copy(), free.copy()) is ways
        expected = placings(points, cluster, origins[joint], rotations[joint], free)
        assert len(ways) == len(expected) > bool(len(cluster.markers))
        for way, one in zip(ways, expected, strict=True):
            np.testing.assert_array_equal(way.labels, one.labels)
            np.testing.assert_array_equal(way.rotation, one.rotation)
            assert way.score == one.score
    fewer = found(cluster, origins[joint], rotations[joint], free[:0])
    assert [(way.labels >= 0).any() for way in fewer] == [False]
