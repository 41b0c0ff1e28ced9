"""Shoulders on the trunk: markers that move with them, elevation of the arms, prior of the displacements."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.model.joint_centres import centre_names
from mbkf.model.protocol import load_protocol
from mbkf.sensors.shoulder_girdle import HORIZONTAL, SETTING, ShoulderGirdle, girdle_prior, shoulder_names
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
BODY = MODEL.description
RIGHT, LEFT = BODY.girdle


def girdle_of(*landmarks):
    found = [BODY.landmark(name) for name in landmarks]
    return ShoulderGirdle(MODEL, [one.segment for one in found], np.array([one.position_m for one in found]))


def test_arm_and_acromion_move_with_their_shoulder_and_breastbone_and_spine_do_not():
    girdle = girdle_of("right_acromion", "left_acromion", "sternum", "c7", "right_asis")
    np.testing.assert_array_equal(girdle.carried, [[1, 0], [0, 1], [0, 0], [0, 0], [0, 0]])
    np.testing.assert_array_equal(girdle.carried, girdle.on_trunk)
    markers = load_protocol("reference36").markers
    every = ShoulderGirdle(MODEL, [m.segment for m in markers], np.array([m.position_m for m in markers]))
    arm = np.array([m.segment in ("left_upper_arm", "left_forearm", "left_hand") for m in markers])
    assert arm.any()
    np.testing.assert_array_equal(every.carried[arm], np.tile([0.0, 1.0], (arm.sum(), 1)))
    np.testing.assert_array_equal(every.on_trunk[arm], 0.0)


def test_the_clavicle_between_goes_a_part_of_the_way():
    share = girdle_of("right_clavicle").carried[0]
    assert 0.1 < share[0] < 0.9
    assert share[1] == 0.0


@pytest.mark.parametrize("degrees", [0.0, 30.0, 84.0, 90.0, 170.0])
@pytest.mark.parametrize("plane_deg", [0.0, 50.0, 90.0])
def test_the_share_is_that_of_the_elevation_in_any_plane_and_turn(degrees, plane_deg):
    axis = np.deg2rad(degrees) * np.array([np.cos(np.deg2rad(plane_deg)), np.sin(np.deg2rad(plane_deg)), 0.0])
    turned = Rotation.from_rotvec(axis) * Rotation.from_rotvec([0.0, 0.0, 0.7])
    q = moderate_pose(MODEL, np.random.default_rng(0))
    q[MODEL.joint("right_upper_arm").q] = turned.as_quat()
    s = np.sin(np.deg2rad(degrees) / 2)
    expected = (np.hypot(s, SETTING) - SETTING) / HORIZONTAL
    assert girdle_of("c7").raised(np.array([q]))[0, 0] == pytest.approx(expected, abs=1e-12)
    if degrees == 90.0:
        assert expected == pytest.approx(1.0)


def test_the_prior_is_that_of_the_body_file_and_trials_share_the_person():
    raised = np.array([[1.0, 0.8], [0.1, 0.0]])
    mean, covariance = girdle_prior(BODY, raised)
    expected = raised[:, :, None] * [RIGHT.mean_m, LEFT.mean_m]
    np.testing.assert_allclose(mean.reshape(2, 2, 3), expected, rtol=1e-12)
    P = covariance.reshape(2, 2, 3, 2, 2, 3)
    np.testing.assert_allclose(np.diag(P[0, 0, :, 0, 0, :]), RIGHT.sd_m**2 + RIGHT.held_m**2, rtol=1e-12)
    np.testing.assert_allclose(np.diag(P[1, 1, :, 1, 1, :]), LEFT.held_m**2, rtol=1e-12)
    np.testing.assert_allclose(np.diag(P[0, 0, :, 1, 0, :]), 0.1 * RIGHT.sd_m**2, rtol=1e-12)
    assert P[0, 0, 1, 0, 1, 1] < 0.0 < P[0, 0, 2, 0, 1, 2]
    assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_the_left_shoulder_mirrors_the_right_one_and_both_have_centres():
    np.testing.assert_array_equal(LEFT.mean_m, RIGHT.mean_m * [1.0, -1.0, 1.0])
    assert RIGHT.mean_m[1] > 0.0 < RIGHT.mean_m[2]
    assert set(shoulder_names(BODY)) <= set(centre_names(BODY))
