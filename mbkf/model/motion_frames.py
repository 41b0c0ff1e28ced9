"""Frames and Jacobians of a body in all frames of a motion."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body


def motion_frames(model: Body, q: Array) -> tuple[Array, Array]:
    """Axes and origins of all joints, and spatial Jacobians; NaN where the configuration is.

    Args:
        model: The body.
        q: (T, nq) configurations.

    Returns:
        (T, J, 4, 3) world x, y, z axes and origin of every joint of Pinocchio (0 is the world), and (T, 6, nv) as
        :meth:`mbkf.model.body.Body.spatial_jacobian`.
    """
    known = np.flatnonzero(~np.isnan(q).any(axis=1))
    frames = np.full((len(q), 4 * len(model.supports), 3), np.nan)
    jacobians = np.full((len(q), 6, model.nv), np.nan)
    if model.tree is not None:
        frames[known], jacobians[known] = model.tree.frames_and_jacobians(q[known])
    else:
        for t in known:
            frames[t], jacobians[t] = model.frames_and_jacobian(q[t])
    return frames.reshape(len(q), -1, 4, 3), jacobians
