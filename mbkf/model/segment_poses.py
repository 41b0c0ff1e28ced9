"""The poses of all segments over a motion, for drawing and for other programs."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.model.body import Body


def segment_poses(model: Body, q: Array) -> Array:
    """(T, S, 7) world position m and quaternion (x, y, z, w) of every segment; NaN where q (T, nq) is NaN.

    Successive quaternions of a segment lie in one hemisphere, so that they can be interpolated and compressed.
    """
    ids = [joint.joint_id for joint in model.joints.values()]
    poses = np.full((len(q), len(ids), 7), np.nan)
    known = np.flatnonzero(~np.isnan(q).any(axis=1))
    if not len(known):
        return poses
    rotations = np.empty((len(known), len(ids), 3, 3))
    for row, t in enumerate(known):
        R, origins = model.placements(q[t])
        rotations[row], poses[t, :, :3] = R[ids], origins[ids]
    quaternions = Rotation.from_matrix(rotations.reshape(-1, 3, 3)).as_quat().reshape(len(known), len(ids), 4)
    turned = (quaternions[1:] * quaternions[:-1]).sum(axis=2) < 0
    quaternions[1:][np.cumsum(turned, axis=0) % 2 == 1] *= -1.0
    poses[known, :, 3:] = quaternions
    return poses
