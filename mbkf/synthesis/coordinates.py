"""Poses in the model's own coordinates: configuration, velocity and acceleration as Pinocchio has them."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.inverse_kinematics import Pose


def coordinates(model: Body, pose: Pose, every: int = 1) -> tuple[Array, Array, Array]:
    """Arrays q (T, nq), v (T, nv), a (T, nv) of every n-th frame, in Pinocchio's coordinates; quaternions do not jump.

    Args:
        model: The body.
        pose: Its pose.
        every: The n.

    Raises:
        InvalidInput: The pose is not finite.
    """
    frames = len(pose.knee[::every])
    q = np.zeros((frames, model.nq))
    v, a = np.zeros((frames, model.nv)), np.zeros((frames, model.nv))
    for name, joint in model.joints.items():
        if joint.kind in ("hinge", "universal"):
            for k, angle in enumerate(pose.angles[name]):
                at_q, at_v = joint.q.start + k, joint.v.start + k
                q[:, at_q], v[:, at_v], a[:, at_v] = angle[::every].orders
            continue
        rotation, first_q, first_v = pose.rotations[name][::every], joint.q.start, joint.v.start
        if joint.kind == "free":
            to_body, origin = rotation.transposed(), pose.origins[name][::every]
            q[:, first_q : first_q + 3] = origin.value
            v[:, first_v : first_v + 3] = _apply(to_body.value, origin.first)
            a[:, first_v : first_v + 3] = _apply(to_body.value, origin.second) + _apply(
                to_body.first, origin.first
            )
            first_q, first_v = first_q + 3, first_v + 3
        else:
            parent = pose.rotations[model.description.segment(name).parent][::every]
            rotation = parent.transposed() @ rotation
        q[:, first_q : first_q + 4] = _quaternions(rotation.value)
        v[:, first_v : first_v + 3], a[:, first_v : first_v + 3] = dual_numbers.local_rates(rotation)
    if not (np.isfinite(q).all() and np.isfinite(a).all()):
        raise InvalidInput("the motion cannot be performed by this body")
    return q, v, a


def _apply(matrices: Array, vectors: Array) -> Array:
    return np.asarray(np.einsum("tij,tj->ti", matrices, vectors))


def _quaternions(rotations: Array) -> Array:
    quaternions = Rotation.from_matrix(rotations).as_quat()
    turned = np.sign(np.einsum("ti,ti->t", quaternions[1:], quaternions[:-1]))
    turned[turned == 0] = 1.0
    quaternions[1:] *= np.cumprod(turned)[:, None]
    return quaternions
