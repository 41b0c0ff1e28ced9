"""Orientations as readings: zero innovation at the truth, derivatives by the posture, missing ones left out."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.placement import typical_mounts
from mbkf.sensors.block import Frame, Notes, OperatingPoint
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.worn_orientations import ORIENTATIONS, WornOrientations, WornOrientationSettings
from tests.dynamics import singer
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
MOUNTS = typical_mounts(MODEL, ("pelvis", "right_thigh", "left_foot"), seed=3)
SENSOR = InertialSensor(MODEL, MOUNTS)
Q = moderate_pose(MODEL, np.random.default_rng(7))
NONE = np.zeros((0, 3)), np.zeros((0, 6))


class At:
    def __init__(self, q):
        self.q = q


def block_of(sd=1.0):
    block = WornOrientations(SENSOR, WornOrientationSettings(sd))
    block.bind(singer(MODEL, ()).layout, MODEL)
    return block


def decided(block, turns):
    notes = Notes()
    found = block.decide(OperatingPoint(At(Q), None), Frame(*NONE, None, {ORIENTATIONS: turns}), None, notes)
    return found, notes


def said(block, q, decision):
    return block.linearise(OperatingPoint(At(q), None), decision)


def test_true_orientations_of_either_sign_and_length_innovate_nothing():
    block = block_of()
    true = matrix_quaternion(SENSOR.orientations(Q))
    found, notes = decided(block, true * np.array([[1.0], [-1.0], [1.2]]))
    information = said(block, Q, found)
    np.testing.assert_allclose(information.vector, 0.0, atol=1e-12)
    assert information.readings == 9 and notes.observed


def test_a_turn_of_the_pelvis_is_seen_by_all_in_full():
    """A body turned by θ against its readings: Σ J over the sensors is 3 on the root's turn."""
    block, angle = block_of(0.5), 0.01
    turn = Rotation.from_euler("z", angle)
    true = SENSOR.orientations(Q)
    found, _ = decided(block, matrix_quaternion(turn.as_matrix() @ true))
    information = said(block, Q, found)
    root = MODEL.root.v
    upright = MODEL.placements(Q)[0][MODEL.root.joint_id]
    expected = upright.T @ [0.0, 0.0, 3.0 * np.sin(angle) / 0.5**2]
    np.testing.assert_allclose(information.vector[root][3:], expected, rtol=1e-6)
    np.testing.assert_allclose(information.matrix[root, root][3:, 3:], 3.0 / 0.5**2 * np.eye(3), atol=1e-9)


def test_missing_and_impossible_ones_are_left_out():
    block = block_of()
    turns = matrix_quaternion(SENSOR.orientations(Q))
    turns[1], turns[2] = np.nan, 0.1 * turns[2]
    found, _ = decided(block, turns)
    assert np.isnan(found[1:]).all() and said(block, Q, found).readings == 3
    nothing, notes = decided(block, np.full((3, 4), np.nan))
    assert nothing is None and not notes.observed and said(block, Q, None) is None


def test_a_frame_without_orientations():
    block = block_of()
    at, notes = OperatingPoint(At(Q), None), Notes()
    assert block.decide(at, Frame(*NONE), None, notes) is None


@pytest.mark.parametrize("column", [0, 3, 10])
def test_information_is_the_gradient_of_the_squared_differences(column):
    block, h = block_of(0.3), 1e-6
    wrong = Rotation.from_rotvec([[0.1, 0.2, -0.1], [0.0, -0.3, 0.1], [0.2, 0.0, 0.0]]).as_matrix()
    found, _ = decided(block, matrix_quaternion(wrong @ SENSOR.orientations(Q)))
    step = np.zeros(MODEL.nv)
    step[column] = h
    ahead, back = (said(block, MODEL.integrate(Q, sign * step), found).innovation for sign in (1.0, -1.0))
    assert said(block, Q, found).vector[column] == pytest.approx(
        -(ahead - back) / (4 * h), rel=1e-5, abs=1e-6
    )
