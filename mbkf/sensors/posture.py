"""Posture prior, as a block: 0 = θ(q) + r, r ~ N(0, diag(k σ_j)²), θ each joint's rotation vector from neutral.

σ_j is the spread of the joint's angle among people and k a factor. A dof without markers so stays near where people
keep it, while an observed one is moved by less than its own noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.human import HumanModel
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint


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
        self._last: tuple[Array, tuple[Array, Array]] | None = None

    def reading(self, q: Array) -> PostureReading:
        """Deviation and Jacobian at q (nq,)."""
        deviation, jacobian = self.deviation(q)
        return PostureReading(deviation[self.dofs], jacobian[self.dofs])

    def weights(self, scale: float, unobservable: BoolArray) -> Array:
        """(nv,) 1/sd of each dof's reading, 0 where there is none: for :func:`posture_information`."""
        weights = np.zeros(self.model.nv)
        weights[self.dofs] = 1.0 / (scale * self.sd)
        weights[unobservable] = 0.0
        return weights

    def deviation(self, q: Array) -> tuple[Array, Array]:
        """Deviation (nv,) of every dof, rad, and its Jacobian (nv, nv).

        The root is set aside, for its turn may be far from neutral. Several blocks ask at the same configuration, so
        the last answer is kept.
        """
        if self._last is not None and self._last[0] is q:
            return self._last[1]
        posture = q.copy()
        posture[self._root] = self._neutral[self._root]
        jacobian = self.model.difference_derivative(self._neutral, posture)
        jacobian[self._root_dofs, self._root_dofs] = 0.0
        found = self.model.difference(self._neutral, posture), jacobian
        self._last = (q, found)
        return found


def posture_information(deviation: Array, jacobian: Array, weights: Array) -> Information:
    """What reading zero deviation says about the configuration (nv); no readings of an instrument.

    Args:
        deviation: (nv,) of every dof, rad (:meth:`PostureSensor.deviation`).
        jacobian: (nv, nv) its derivative.
        weights: (nv,) 1/sd of each dof's reading (:meth:`PostureSensor.weights`).
    """
    scaled = jacobian * weights[:, None]
    return Information(scaled.T @ scaled, -(deviation * weights) @ scaled, 0.0, 0)


@dataclass(frozen=True)
class PostureSettings:
    """Weight of the posture prior.

    Attributes:
        posture_scale: Factor k on the body's table of spreads, per frame.
        unseen_posture: Factor on the prior's weight for joints that nothing observes: repeated in every frame, it would
            soon outweigh what was known before. 1 leaves it.
    """

    posture_scale: float = 1.0
    unseen_posture: float = 1.0


class PreparedPosture(NamedTuple):
    """Deviation (nv,) from neutral, its Jacobian (nv, nv), and the information while every segment is observed."""

    deviation: Array
    jacobian: Array
    information: Information


class PosturePrior(Block[Any, PreparedPosture, Notes, None]):
    """The posture prior.

    Attributes:
        sensor: Deviation of every joint from neutral.
        settings: Its weight.
    """

    prior = True

    def __init__(self, sensor: PostureSensor, unobservable: BoolArray, settings: PostureSettings) -> None:
        """Makes the block.

        Args:
            sensor: Deviation of every joint from neutral.
            unobservable: (nv,) dofs that no marker of the capture moves with; they have no prior.
            settings: Its weight.
        """
        self.sensor, self.settings = sensor, settings
        self._weights = sensor.weights(settings.posture_scale, unobservable)

    def prepare(self, state: Any, memory: None) -> PreparedPosture:
        """What the prior says while every segment is observed."""
        del memory
        deviation, jacobian = self.sensor.deviation(state.q)
        return PreparedPosture(deviation, jacobian, posture_information(deviation, jacobian, self._weights))

    def decide(
        self, at: OperatingPoint[Any, PreparedPosture], frame: Frame, memory: None, notes: Notes
    ) -> Notes:
        """Depends on which joints are observed."""
        del at, frame, memory
        return notes

    def linearise(self, at: OperatingPoint[Any, PreparedPosture], decision: Notes) -> Information:
        """Information on the configuration, of less weight for joints that nothing observes."""
        unobserved, prepared = decision.unobserved, at.prepared
        if not len(unobserved) or self.settings.unseen_posture == 1.0:
            return prepared.information
        weights = self._weights.copy()
        weights[unobserved] *= self.settings.unseen_posture
        return posture_information(prepared.deviation, prepared.jacobian, weights)
