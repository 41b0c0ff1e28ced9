"""Mounts of segments' own frames: as the system's calibration has them, or by a measured posture."""

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.oriented_mounts import facing_of, joint_place, oriented_mounts
from mbkf.imu.worn_mounts import MountSettings
from mbkf.numerics.cardan import quaternion_matrices
from tests.motions import moderate_pose, reference_model

MODEL = reference_model()
SEGMENTS = ("pelvis", "torso", "right_shank", "left_hand")
S = MountSettings()


def test_without_a_posture_the_frames_are_the_segments_own():
    found = oriented_mounts(MODEL, ["a", "b", "c", "d"], SEGMENTS, np.eye(4), None, S)
    for name, segment, mount in zip("abcd", SEGMENTS, found.mounts, strict=True):
        assert (mount.name, mount.segment) == (name, segment)
        np.testing.assert_array_equal(mount.rotation, [0.0, 0.0, 0.0, 1.0])
    np.testing.assert_allclose(found.turn_sd_rad, np.hypot(S.tilt_sd_rad, S.posture_sd_rad))
    assert not found.bias_rad_s.any() and (found.bias_sd_rad_s == S.derived_bias_sd_rad_s).all()


def test_a_measured_posture_gives_the_turn_of_every_frame():
    q = moderate_pose(MODEL, np.random.default_rng(5))
    rotations = MODEL.placements(q)[0][[MODEL.joint(name).joint_id for name in SEGMENTS]]
    off = Rotation.from_rotvec([[0.0, 0.0, 0.0], [0.1, 0.2, 0.3], [0.5, -0.2, 0.0], [0.0, 1.0, 0.4]])
    own = rotations @ off.as_matrix()
    heading = facing_of(matrix_quaternion(own[0]))
    seen = matrix_quaternion(Rotation.from_euler("z", -heading).as_matrix() @ own)
    found = oriented_mounts(MODEL, SEGMENTS, SEGMENTS, seen, q, S)
    turns = quaternion_matrices(np.array([mount.rotation for mount in found.mounts]))
    np.testing.assert_allclose(turns, off.as_matrix(), atol=1e-9)
    np.testing.assert_allclose(found.turn_sd_rad, S.tilt_sd_rad)


def test_the_way_a_frame_faces():
    found = facing_of(Rotation.from_euler("ZYX", [0.7, 0.4, 0.2]).as_quat())
    np.testing.assert_allclose(found, 0.7, rtol=1e-12)


def test_joints_above_segments():
    hips = joint_place(MODEL, "pelvis")
    rotations, places = MODEL.placements(MODEL.neutral())
    left, right = (places[MODEL.joint(name).joint_id] for name in ("left_thigh", "right_thigh"))
    root = MODEL.root.joint_id
    np.testing.assert_allclose(places[root] + rotations[root] @ hips, 0.5 * (left + right), atol=1e-12)
    assert not joint_place(MODEL, "left_shank").any()
    assert joint_place(MODEL, "torso")[2] > 0.1 and not joint_place(MODEL, "torso")[:2].any()
