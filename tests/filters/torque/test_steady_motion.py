"""Markers where motion goes on steadily, as sure as the kinematic plant is of them."""

from itertools import pairwise

import numpy as np

from mbkf.filters.torque.report import steady_motion
from tests.dynamics import DT
from tests.followed import estimates, inputs, made


def test_markers_are_expected_where_the_body_goes():
    tracking, found = estimates("kinematic")
    sensor = inputs().sensor
    for before, now in pairwise(found[20:]):
        expected = steady_motion(before, tracking.covariance(before), sensor, DT)
        off = expected.markers.positions_m - sensor.positions(now.q)
        assert np.abs(off).max() < 0.02
        np.testing.assert_array_equal(expected.markers.positions_m, sensor.positions(expected.q))


def test_covariance_is_the_kinematic_plants_own():
    """Up to the retraction's curvature, which one step hardly has."""
    tracking, found = estimates("kinematic")
    ours = steady_motion(found[30], tracking.covariance(found[30]), inputs().sensor, DT).markers.covariance
    nv = made().model.nv
    theirs = tracking.kalman.plant.predict(found[30].record.state).P[:nv, :nv]
    assert np.allclose(ours, theirs, atol=2e-2 * np.abs(theirs).max())
    assert np.allclose(ours, ours.T)
    assert np.linalg.eigvalsh(ours).min() > 0.0
