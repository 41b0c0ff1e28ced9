"""What the page is told once, and the segments' poses."""

import json

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.viz.scene.channels import Layout
from mbkf.viz.scene.description import scene_description, segment_poses
from tests.motions import assert_near
from tests.recordings import PLATE, walk, walker


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


def test_the_description_is_json_and_draws_only_plates_it_knows():
    r, model = walk(), walker()[1]
    layout = Layout(18, len(r.marker_names), len(r.coordinate_names))
    corners = np.array([PLATE, np.full((4, 3), np.nan)])
    scene = scene_description("A", model, r.marker_names, r.coordinate_names, corners, layout, streamed=True)
    assert json.loads(json.dumps(scene, allow_nan=False)) == scene
    assert scene["plates"] == [PLATE.tolist()]
    assert scene["markers"] == list(r.marker_names)
    assert scene["width"] == layout.width
    assert len(scene["segments"]) == 18
