"""What mounts that are turned put wrong: against a body whose sensors are turned, and the share of each sensor."""

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.filters.inertia_errors import InertiaErrors
from mbkf.filters.mount_errors import MountErrors
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
SEGMENTS = ("pelvis", "right_thigh", "right_shank", "right_foot")
Q = moderate_pose(MODEL, np.random.default_rng(2))


def test_segments_err_by_the_turn_of_their_own_sensor():
    """Posture put wrong by W θ turns each segment in the world by −R θ of its own sensor."""
    turns = 1e-4 * np.random.default_rng(3).normal(size=(4, 3))
    root = MountErrors(MODEL, SEGMENTS, np.ones((4, 3))).pose_root(Q)
    moved = MODEL.integrate(Q, root @ turns.ravel())
    before, after = MODEL.placements(Q)[0], MODEL.placements(moved)[0]
    for name, turn in zip(SEGMENTS, turns, strict=True):
        joint = MODEL.joint(name).joint_id
        turned = Rotation.from_matrix(after[joint] @ before[joint].T).as_rotvec()
        np.testing.assert_allclose(turned, -before[joint] @ turn, atol=2e-7)


def test_a_joint_without_sensors_does_not_err():
    root = MountErrors(MODEL, SEGMENTS, np.full((4, 3), 0.1)).pose_root(Q)
    np.testing.assert_allclose(root[MODEL.joint("left_shank").v], 0.0, atol=1e-9)
    assert np.abs(root[MODEL.joint("right_shank").v]).max() > 0.05


def test_torques_follow_from_the_motion_and_segment_masses_alone():
    errors = MountErrors(MODEL, SEGMENTS, np.full((4, 3), 0.05))
    rest = np.zeros(MODEL.nv)
    found = errors.at(Q, rest, rest, np.zeros((2, 6)), None)
    assert np.isfinite(found.torque).all() and np.abs(found.torque[6:, :12]).max() > 0.1
    np.testing.assert_array_equal(found.torque[:, 12:], InertiaErrors(MODEL).at(Q, rest, rest))
    np.testing.assert_allclose(found.position_variance, (found.position**2).sum(axis=1))
