"""Derivatives of a scaled body's joint origins by its scale factors, along the chain from the root."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.joint_centres import centre_levers


class OriginLevers:
    """The constant part of these derivatives: a joint's origin is the sum of levers of all joints before it.

    Attributes:
        parents: (S,) joint in whose segment each of S joints lies.
        levers: (S, 3, K) derivative of its place in that segment by the scale factors.
        centre_levers: (S, 3, E) the same by displacements of joint centres (:mod:`mbkf.model.joint_centres`).
    """

    def __init__(self, model: Body) -> None:
        body = model.description
        segments = [segment for segment in body.segments if segment.parent != "world"]
        own = [model.joint(segment.name).joint_id for segment in segments]
        self.parents: NDArray[np.intp] = np.array(
            [model.joint(segment.parent).joint_id for segment in segments], dtype=int
        )
        self.levers = np.zeros((len(segments), 3, len(body.scale_factors)))
        self.centre_levers = centre_levers(model, [segment.name for segment in segments])
        self._before = np.zeros((len(model.supports), len(segments)))
        for k, segment in enumerate(segments):
            parent = body.segment(str(segment.parent))
            self.levers[k] = segment.origin_m[:, None] * parent.scale_matrix
            self._before[own[k]] = self._before[self.parents[k]]
            self._before[own[k], k] = 1.0

    def summed(
        self, rotations: Array, levers: Array, joints: NDArray[np.intp] | slice = slice(None)
    ) -> Array:
        """(…, J, 3, r) derivatives of joints' world origins.

        Args:
            rotations: (…, J, 3, 3) world rotations of all joints, of one configuration or many.
            levers: (S, 3, r) :attr:`levers`, or these times directions (K, r) of the scale factors.
            joints: The joints whose derivatives are wanted.
        """
        turned = rotations[..., self.parents, :, :] @ levers
        found: Array = self._before[joints] @ turned.reshape(*turned.shape[:-2], -1)
        return found.reshape(*found.shape[:-1], *turned.shape[-2:])
