"""Markers on the body: where they are, and which dofs move them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import ShapeError, UnknownName
from mbkf.model.human import HumanModel
from mbkf.numerics.kalman import information
from mbkf.sensors.marker_sensor import MarkerInformation, MarkerPrediction, MarkerSensor
from tests.motions import assert_near, moderate_pose, protocol_sensor, random_model, reference_model


@pytest.fixture
def rng():
    return np.random.default_rng(1)


def test_standing_markers_lie_at_segment_origin_plus_place():
    """In the neutral posture all segments are parallel to the world."""
    model = reference_model()
    sensor, _ = protocol_sensor(model)
    _, origins = model.placements(model.neutral())
    assert_near(sensor.positions(model.neutral()), origins[sensor.joint_ids] + sensor.local_m, 1e-15)


def test_positions_and_reading_agree(rng):
    model = random_model(rng)
    sensor, _ = protocol_sensor(model)
    q = moderate_pose(model, rng)
    np.testing.assert_array_equal(sensor.reading(q).positions_m, sensor.positions(q))


def test_moving_the_body_as_a_whole_moves_all_markers_alike(rng):
    model = random_model(rng)
    sensor, _ = protocol_sensor(model)
    q = moderate_pose(model, rng)
    turn, shift = Rotation.from_rotvec(rng.normal(size=3)), rng.normal(size=3)
    moved = q.copy()
    moved[:3] = turn.apply(q[:3]) + shift
    moved[3:7] = (turn * Rotation.from_quat(q[3:7])).as_quat()
    assert_near(sensor.positions(moved), turn.apply(sensor.positions(q)) + shift, 2e-15)


def test_markers_of_one_segment_keep_their_distances(rng):
    model = random_model(rng)
    local = rng.uniform(-0.1, 0.1, (4, 3))
    sensor = MarkerSensor(model, ["left_hand"] * 4, local)
    placed = sensor.positions(moderate_pose(model, rng))
    for i in range(4):
        assert_near(
            np.linalg.norm(placed - placed[i], axis=1), np.linalg.norm(local - local[i], axis=1), 2e-15
        )


def test_a_marker_moves_only_with_the_dofs_below_it(rng):
    model = reference_model()
    sensor = MarkerSensor(model, ["head", "right_shank"], np.array([[0.1, 0.02, 0.1], [0.05, 0.03, -0.2]]))
    jacobian = sensor.reading(moderate_pose(model, rng)).jacobian
    for row, chain in (
        (0, ["pelvis", "torso", "neck", "head"]),
        (1, ["pelvis", "right_thigh", "right_shank"]),
    ):
        moving = np.concatenate([np.arange(model.nv)[model.joint(name).v] for name in chain])
        assert set(np.flatnonzero(np.abs(jacobian[row]).sum(axis=0))) == set(moving)


@pytest.mark.parametrize("lost", [0, 5, 36])
def test_information_without_jacobian_is_that_of_the_stacked_readings(rng, lost):
    model = random_model(rng)
    sensor, _ = protocol_sensor(model)
    noise, q = rng.uniform(0.002, 0.01, 36), moderate_pose(model, rng)
    reading, y, trusted = sensor.reading(q), 0.01 * rng.normal(size=(36, 3)), np.arange(36) >= lost
    y[~trusted] = np.nan
    found = MarkerInformation(sensor, noise).at(reading, y, trusted)
    sd = np.repeat(noise[trusted], 3)
    stacked = information(y[trusted].ravel(), reading.jacobian[trusted].reshape(-1, model.nv), sd)
    assert_near(found.matrix, stacked.matrix, 1e-8)  # entries up to 1e7
    assert_near(found.vector, stacked.vector, 1e-9)
    assert found.innovation == pytest.approx(stacked.innovation, rel=1e-12)
    assert found.readings == stacked.readings == 3 * (36 - lost)


def test_a_reading_keeps_its_numbers_when_the_next_is_made(rng):
    """The Jacobian is built when asked for, and is still that of its own configuration."""
    model = random_model(rng)
    sensor, _ = protocol_sensor(model)
    q, elsewhere = moderate_pose(model, rng), moderate_pose(model, rng)
    reading, expected = sensor.reading(q), sensor.reading(q).jacobian
    sensor.reading(elsewhere)
    np.testing.assert_array_equal(reading.jacobian, expected)
    np.testing.assert_array_equal(reading.positions_m, sensor.positions(q))


def test_no_markers_are_no_markers():
    model = reference_model()
    reading = MarkerSensor(model, [], np.zeros((0, 3))).reading(model.neutral())
    assert reading.positions_m.shape == (0, 3)
    assert reading.jacobian.shape == (0, 3, model.nv)


def test_wrong_shapes_and_segments_are_refused():
    with pytest.raises(ShapeError, match=r"local_m must have shape \(2, 3\), got \(1, 3\)"):
        MarkerSensor(reference_model(), ["head", "head"], np.zeros((1, 3)))
    with pytest.raises(UnknownName, match="did you mean right_hand"):
        MarkerSensor(reference_model(), ["right_hnd"], np.zeros((1, 3)))


def test_places_cannot_be_changed():
    sensor, _ = protocol_sensor(reference_model())
    assert not sensor.local_m.flags.writeable


def test_spread_is_the_covariance_carried_to_the_markers():
    model = HumanModel.scaled()
    sensor = MarkerSensor(model, ["pelvis", "right_foot"], np.array([[0.1, 0.0, 0.0], [0.0, 0.05, 0.0]]))
    root = np.random.default_rng(0).normal(size=(model.nv, model.nv))
    reading = sensor.reading(model.neutral())
    expected = MarkerPrediction(reading, root @ root.T)
    assert np.array_equal(expected.positions_m, sensor.positions(model.neutral()))
    for chosen in ([True, False], [False, True], [True, True]):
        mask = np.array(chosen)
        H = reading.jacobian[mask]
        assert np.allclose(expected.spread(mask), H @ root @ root.T @ H.transpose(0, 2, 1))
