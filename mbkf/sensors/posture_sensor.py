"""Rotation of every joint from the neutral posture, with its Jacobian: θ(q), one rotation vector per joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body


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
        tree: The body's compiled equations; None without a kernel, or if neutral is not Pinocchio's.
    """

    def __init__(self, model: Body) -> None:
        self.model = model
        self.dofs = np.flatnonzero(model.posture_sd > 0)
        self.sd = model.posture_sd[self.dofs]
        self._neutral = model.neutral()
        root = next(joint for joint in model.joints.values() if joint.kind == "free")
        self._root, self._root_dofs = root.q, root.v
        usual = np.array_equal(self._neutral, pin.neutral(model.pin_model))
        self.tree = model.tree if usual else None
        self._last: tuple[Array, tuple[Array, Array]] | None = None

    def reading(self, q: Array) -> PostureReading:
        """Deviation and Jacobian at q (nq,)."""
        deviation, jacobian = self.deviation(q)
        return PostureReading(deviation[self.dofs], jacobian[self.dofs])

    def weights(self, scale: float, unobservable: BoolArray) -> Array:
        """(nv,) 1/sd of each dof's reading, 0 without one, for :func:`mbkf.sensors.posture.posture_information`."""
        weights = np.zeros(self.model.nv)
        weights[self.dofs] = 1.0 / (scale * self.sd)
        weights[unobservable] = 0.0
        return weights

    def deviation(self, q: Array) -> tuple[Array, Array]:
        """Deviation (nv,) of every dof, rad, and its Jacobian (nv, nv).

        The root is left out, for its turn may be far from neutral. Several blocks need the same configuration, so the
        last result is kept.
        """
        if self._last is not None and self._last[0] is q:
            return self._last[1]
        found = self._from(self._neutral, q) if self.tree is None else self.tree.deviation(q)
        self._last = (q, found)
        return found

    def from_posture(self, start: Array, q: Array) -> tuple[Array, Array]:
        """Rotation (nv,) of all dofs but the root's from ``start`` to q, rad, and its Jacobian (nv, nv) by q."""
        tree = self.model.tree
        return self._from(start, q) if tree is None else tree.deviation(q, start)

    def _from(self, start: Array, q: Array) -> tuple[Array, Array]:
        posture = q.copy()
        posture[self._root] = start[self._root]
        jacobian = self.model.difference_derivative(start, posture)
        jacobian[self._root_dofs, self._root_dofs] = 0.0
        return self.model.difference(start, posture), jacobian
