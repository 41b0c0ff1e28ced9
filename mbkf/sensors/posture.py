"""A weak pull towards the standing posture, for what no instrument sees (DESIGN §4, fact 7).

Each joint's rotation vector from the neutral posture is "read" as zero with the joint's own spread, so that a dof
without markers stays near where people keep it, while a seen one is moved by less than its own noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.human import HumanModel
from mbkf.numerics.rotations import log_and_inverse_jacobian


@dataclass(frozen=True)
class PostureReading:
    """Deviation from neutral (n,) in rad and its Jacobian (n, nv)."""

    deviation: Array
    jacobian: Array


class PostureSensor:
    """The deviation of every joint from the neutral posture.

    Attributes:
        dofs: (n,) tangent indices with a prior.
        sd: (n,) spread of each, rad.
    """

    def __init__(self, model: HumanModel) -> None:
        self.model = model
        self.dofs = np.flatnonzero(model.posture_sd > 0)
        self.sd = model.posture_sd[self.dofs]
        spherical = [joint for joint in model.joints.values() if joint.kind == "spherical"]
        self._q3 = np.array([np.arange(j.q.start, j.q.stop) for j in spherical])
        self._v3 = np.array([np.arange(j.v.start, j.v.stop) for j in spherical])
        hinges = [j for j in model.joints.values() if j.kind in ("hinge", "universal")]
        self._q1 = np.concatenate([np.arange(j.q.start, j.q.stop) for j in hinges])
        self._v1 = np.concatenate([np.arange(j.v.start, j.v.stop) for j in hinges])

    def reading(self, q: Array) -> PostureReading:
        """Deviation and Jacobian at q (nq,)."""
        nv = self.model.nv
        deviation, jacobian = np.zeros(nv), np.zeros((nv, nv))
        vectors, derivatives = log_and_inverse_jacobian(q[self._q3])
        deviation[self._v3] = vectors
        jacobian[self._v3[:, :, None], self._v3[:, None, :]] = derivatives
        deviation[self._v1] = q[self._q1]
        jacobian[self._v1, self._v1] = 1.0
        return PostureReading(deviation[self.dofs], jacobian[self.dofs])
