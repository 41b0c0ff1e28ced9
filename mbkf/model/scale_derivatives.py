"""How the joints of a scaled body move with its scale factors, along the chain from the root."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body


def origin_derivatives(model: Body, rotations: Array) -> Array:
    """(…, J, 3, K) derivative of every joint's world origin by the scale factors, at fixed configurations.

    Args:
        model: The scaled body.
        rotations: (…, J, 3, 3) world rotations of its joints, of one configuration or many.
    """
    body = model.description
    derivatives = np.zeros((*rotations.shape[:-1], len(body.scale_factors)))
    for segment in body.segments:
        if segment.parent == "world":
            continue
        parent = model.joint(segment.parent).joint_id
        lever = segment.origin_m[:, None] * body.segment(segment.parent).scale_matrix
        joint = model.joint(segment.name).joint_id
        turned = rotations[..., parent, :, :] @ lever
        derivatives[..., joint, :, :] = derivatives[..., parent, :, :] + turned
    return derivatives
