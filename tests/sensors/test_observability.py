"""Ranks against finite differences and against bodies whose blind spots are known."""

import numpy as np
import pytest

from mbkf.errors import ShapeError
from mbkf.model.human import HumanModel
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.observability import (
    analyse,
    generic_postures,
    kinematic_plant,
    null_space,
    numerical_rank,
    observability_matrix,
)

PELVIS = [("pelvis", (0.06, -0.12, -0.2)), ("pelvis", (0.06, 0.12, -0.2)), ("pelvis", (-0.1, 0.0, -0.2))]
THIGH = [("right_thigh", (0.01, -0.08, -0.2)), ("right_thigh", (0.0, -0.05, -0.43))]
SHANK_CENTRE = [("right_shank", (0.0, 0.0, 0.0))]


@pytest.fixture(scope="module")
def model():
    return HumanModel.scaled()


def observed(model, markers, noise_m=0.005):
    segments, places = zip(*markers, strict=True)
    return analyse(model, segments, np.array(places), np.full(len(markers), noise_m))


def finite_difference_jacobian(model, sensor, q, step=1e-6):
    def moved(by):
        return sensor.positions(model.integrate(q, by)).ravel()

    steps = step * np.eye(model.nv)
    return np.stack([(moved(by) - moved(-by)) / (2 * step) for by in steps], axis=1)


def test_ranks_equal_those_of_the_finite_difference_jacobian(model):
    markers = PELVIS + THIGH + [("right_foot", (0.1, 0.02, -0.04)), ("head", (0.1, 0.0, 0.05))]
    segments, places = zip(*markers, strict=True)
    sensor = MarkerSensor(model, segments, np.array(places))
    found = observed(model, markers)
    for q, rank, share in zip(generic_postures(model), found.ranks, found.unobserved_share, strict=True):
        _, singular, directions = np.linalg.svd(finite_difference_jacobian(model, sensor, q))
        assert rank == np.sum(singular > 1e-6 * singular[0])
        np.testing.assert_allclose(share, np.sum(directions[rank:] ** 2, axis=0), atol=1e-5)


def test_three_markers_on_the_pelvis_determine_it_alone(model):
    found = observed(model, PELVIS)
    assert (found.ranks == 6).all()
    assert (found.state_ranks == 12).all()
    assert found.unobserved == found.dofs[6:]
    assert found.sometimes_unobserved == ()
    assert not found.complete
    np.testing.assert_allclose(found.unobserved_share[:, 6:], 1.0, atol=1e-9)


def test_two_markers_in_line_with_the_hip_leave_the_turn_about_that_line(model):
    on_axis = [("right_thigh", (0.0, 0.0, -0.2)), ("right_thigh", (0.0, 0.0, -0.4))]
    found = observed(model, PELVIS + on_axis)
    assert (found.ranks == 8).all()
    assert "right_thigh_z" in found.unobserved
    assert "right_thigh_x" not in found.unobserved
    assert "right_thigh_y" not in found.unobserved


def test_a_bent_knee_shows_what_a_straight_one_hides(model):
    """With markers on the thigh's axis and the ankle, the thigh's turn shows only when the knee is bent."""
    markers = [*PELVIS, ("right_thigh", (0.0, 0.0, -0.3)), ("right_foot", (0.0, 0.0, 0.0))]
    found = observed(model, markers)
    i = found.dofs.index("right_thigh_z")
    assert found.unobserved_share[0, i] == pytest.approx(1.0)
    assert (found.unobserved_share[1:, i] < 0.9).all()
    assert np.isinf(found.sd[0, i])


def test_one_frame_deviation_grows_with_noise_and_shrinks_with_the_lever(model):
    near = observed(model, PELVIS + THIGH)
    noisy = observed(model, PELVIS + THIGH, noise_m=0.010)
    i = near.dofs.index("right_thigh_y")
    np.testing.assert_allclose(noisy.sd[:, i], 2 * near.sd[:, i])
    far = observed(model, PELVIS + THIGH + SHANK_CENTRE)
    assert (far.sd[:, i] < near.sd[:, i]).all()
    assert far.typical_sd.shape == (model.nv,)


def test_observability_matrix_of_a_chain_and_of_the_kinematic_plant():
    chain = np.diag([1.0, 1.0], k=1)
    seen_first = observability_matrix(np.array([[1.0, 0.0, 0.0]]), chain)
    assert numerical_rank(seen_first) == 3
    seen_last = observability_matrix(np.array([[0.0, 0.0, 1.0]]), chain)
    assert numerical_rank(seen_last) == 1
    H = np.array([[1.0, 2.0, 0.0, 0.0]])
    stacked = observability_matrix(H, kinematic_plant(2))
    np.testing.assert_array_equal(stacked, [[1, 2, 0, 0], [0, 0, 1, 2]])


def test_null_space_is_what_the_matrix_does_not_see():
    matrix = np.random.default_rng(1).normal(size=(4, 3)) @ np.random.default_rng(2).normal(size=(3, 6))
    unobserved = null_space(matrix)
    assert unobserved.shape == (6, 3)
    np.testing.assert_allclose(matrix @ unobserved, 0.0, atol=1e-12)
    np.testing.assert_allclose(unobserved.T @ unobserved, np.eye(3), atol=1e-12)
    assert numerical_rank(np.zeros((2, 2))) == 0


def test_postures_are_the_same_every_time_and_begin_straight(model):
    postures = generic_postures(model)
    np.testing.assert_array_equal(postures, generic_postures(model))
    np.testing.assert_array_equal(postures[0], model.neutral())
    bends = np.array([model.difference(postures[0], q) for q in postures[1:]])
    assert (np.abs(bends[:, 6:]) > 0.1).all()


def test_wrong_shapes_are_refused(model):
    with pytest.raises(ShapeError, match="noise_m"):
        analyse(model, ["pelvis"], np.zeros((1, 3)), np.zeros(2))
    with pytest.raises(ShapeError, match="plant"):
        observability_matrix(np.zeros((1, 3)), np.eye(2))
