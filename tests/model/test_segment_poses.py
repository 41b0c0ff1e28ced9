"""The poses of segments: those of the body, without jumps, unknown where the motion is."""

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.model.segment_poses import segment_poses
from tests.motions import assert_near
from tests.recordings import walker


def test_poses_are_those_of_the_body():
    _, model, motion = walker()
    poses = segment_poses(model, motion.q[::25])
    for t, q in enumerate(motion.q[::25]):
        R, origins = model.placements(q)
        for s, joint in enumerate(model.joints.values()):
            assert_near(poses[t, s, :3], origins[joint.joint_id], 1e-12)
            assert_near(Rotation.from_quat(poses[t, s, 3:]).as_matrix(), R[joint.joint_id], 1e-9)


def test_quaternions_do_not_jump():
    _, model, motion = walker()
    quaternions = segment_poses(model, motion.q)[:, :, 3:]
    assert ((quaternions[1:] * quaternions[:-1]).sum(axis=2) > 0.9).all()


def test_unknown_frames_stay_unknown():
    _, model, motion = walker()
    q = motion.q[:4].copy()
    q[1] = np.nan
    poses = segment_poses(model, q)
    assert np.isnan(poses[1]).all() and np.isfinite(poses[[0, 2, 3]]).all()
    assert np.isnan(segment_poses(model, np.full((2, model.nq), np.nan))).all()
