"""Markers of a body of any scale factors against those of a body that was built with these."""

import numpy as np
import pytest

from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.scaled_markers import ScaledMarkers
from tests.motions import moderate_pose

PROTOCOL = load_protocol("reference36")
BODY = PROTOCOL.body
SEGMENTS = [marker.segment for marker in PROTOCOL.markers]
REFERENCE_M = np.array([marker.position_m for marker in PROTOCOL.markers])
SCALE = np.array([BODY.segment(name).scale_matrix for name in SEGMENTS])
RNG = np.random.default_rng(3)
COUNT = len(BODY.scale_factors)


def built(factors, offsets_m):
    model = HumanModel(BODY, factors, 70.0)
    return MarkerSensor(model, SEGMENTS, (SCALE @ factors) * REFERENCE_M + offsets_m)


@pytest.fixture(params=[1.0, 0.8], ids=["reference", "small"])
def scene(request):
    """Scaled markers by a body of some size, three poses, factors of another body, and offsets."""
    model = HumanModel(BODY, np.full(COUNT, request.param), 70.0)
    poses = np.array([moderate_pose(model, RNG) for _ in range(3)])
    factors, offsets = RNG.uniform(0.7, 1.3, COUNT), RNG.normal(0.0, 0.02, REFERENCE_M.shape)
    return ScaledMarkers(model, SEGMENTS, REFERENCE_M), poses, factors, offsets


def test_places_and_jacobian_are_those_of_a_body_of_these_factors(scene):
    markers, poses, factors, offsets = scene
    sensor = built(factors, offsets)
    places, reading = markers.places(poses, factors, offsets), markers.reading(poses, factors, offsets)
    for q, placed, found in zip(poses, places, reading.markers, strict=True):
        expected = sensor.reading(q)
        np.testing.assert_allclose(placed, expected.positions_m, rtol=0, atol=1e-14)
        np.testing.assert_array_equal(found.positions_m, placed)
        np.testing.assert_allclose(found.jacobian, expected.jacobian, rtol=0, atol=1e-14)


def test_places_are_linear_in_factors_and_offsets(scene):
    markers, poses, factors, offsets = scene
    more, beside = RNG.uniform(-0.2, 0.2, COUNT), RNG.normal(0.0, 0.02, REFERENCE_M.shape)
    reading = markers.reading(poses, factors, offsets)
    moved = markers.places(poses, factors + more, offsets + beside) - markers.places(poses, factors, offsets)
    linear = reading.by_factors @ more + (reading.axes @ beside[:, :, None])[..., 0]
    np.testing.assert_allclose(moved, linear, rtol=0, atol=1e-14)


def test_without_offsets_markers_are_at_their_places(scene):
    markers, poses, factors, offsets = scene
    np.testing.assert_array_equal(
        markers.places(poses, factors), markers.places(poses, factors, 0.0 * offsets)
    )


def test_raised_shoulders_are_those_of_a_body_with_displaced_centres(scene):
    """Arms move as on a body whose shoulders lie there, markers around the shoulder with them, others not at all."""
    markers, poses, factors, offsets = scene
    raised = RNG.normal(0.0, 0.04, (2, 3))
    centres = np.zeros((len(BODY.joint_centres), 3))
    for own, moved in zip(BODY.girdle, raised, strict=True):
        centres[[one.segment for one in BODY.joint_centres].index(own.segment)] = moved
    model = HumanModel(BODY, factors, 70.0, centres_m=centres)
    local = (SCALE @ factors) * REFERENCE_M + offsets + markers.girdle.on_trunk @ raised
    sensor = MarkerSensor(model, SEGMENTS, local)
    every = np.tile(raised, (len(poses), 1, 1))
    places = markers.places(poses, factors, offsets, every)
    for q, placed, found in zip(
        poses, places, markers.reading(poses, factors, offsets, every).markers, strict=True
    ):
        expected = sensor.reading(q)
        np.testing.assert_allclose(placed, expected.positions_m, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found.positions_m, placed, rtol=0, atol=0)
        np.testing.assert_allclose(found.jacobian, expected.jacobian, rtol=0, atol=1e-14)
