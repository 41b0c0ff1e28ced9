"""The poses of all segments over a motion, for drawing and for other programs."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.motion_frames import motion_frames


def segment_poses(model: Body, q: Array) -> Array:
    """(T, S, 7) world position m and quaternion (x, y, z, w) of every segment; NaN where q (T, nq) is NaN.

    Successive quaternions of a segment lie in one hemisphere, so that they can be interpolated and compressed.
    """
    ids = [joint.joint_id for joint in model.joints.values()]
    poses = np.full((len(q), len(ids), 7), np.nan)
    known = np.flatnonzero(~np.isnan(q).any(axis=1))
    if not len(known):
        return poses
    frames = motion_frames(model, q[known])[0][:, ids]
    rotations, poses[known, :, :3] = frames[:, :, :3].swapaxes(2, 3), frames[:, :, 3]
    quaternions = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat().reshape(len(known), len(ids), 4)
    turned = (quaternions[1:] * quaternions[:-1]).sum(axis=2) < 0
    quaternions[1:][np.cumsum(turned, axis=0) % 2 == 1] *= -1.0
    poses[known, :, 3:] = quaternions
    return poses
