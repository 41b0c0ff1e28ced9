"""A weak pull towards the standing posture, for what no instrument sees (DESIGN §4, fact 7).

Each joint's rotation vector from the neutral posture is "read" as zero with the joint's own spread, so that a dof
without markers stays near where people keep it, while a seen one is moved by less than its own noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.human import HumanModel
from mbkf.numerics.kalman import Information


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
        self._neutral = model.neutral()
        root = next(joint for joint in model.joints.values() if joint.kind == "free")
        self._root, self._root_dofs = root.q, root.v

    def reading(self, q: Array) -> PostureReading:
        """Deviation and Jacobian at q (nq,)."""
        deviation, jacobian = self.deviation(q)
        return PostureReading(deviation[self.dofs], jacobian[self.dofs])

    def weights(self, scale: float, held: BoolArray) -> Array:
        """(nv,) 1/sd of each dof's reading, 0 where there is none: for :func:`pull`."""
        weights = np.zeros(self.model.nv)
        weights[self.dofs] = 1.0 / (scale * self.sd)
        weights[held] = 0.0
        return weights

    def deviation(self, q: Array) -> tuple[Array, Array]:
        """Deviation (nv,) of every dof, rad, and its Jacobian (nv, nv).

        The root is set aside, for its turn may be far from neutral.
        """
        posture = q.copy()
        posture[self._root] = self._neutral[self._root]
        jacobian = self.model.difference_derivative(self._neutral, posture)
        jacobian[self._root_dofs, self._root_dofs] = 0.0
        return self.model.difference(self._neutral, posture), jacobian


def pull(deviation: Array, jacobian: Array, weights: Array) -> Information:
    """What reading zero deviation says about the configuration (nv); no readings of an instrument.

    Args:
        deviation: (nv,) of every dof, rad (:meth:`PostureSensor.deviation`).
        jacobian: (nv, nv) its derivative.
        weights: (nv,) 1/sd of each dof's reading (:meth:`PostureSensor.weights`).
    """
    scaled = jacobian * weights[:, None]
    return Information(scaled.T @ scaled, -(deviation * weights) @ scaled, 0.0, 0)
