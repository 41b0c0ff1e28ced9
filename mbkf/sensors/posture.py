"""Posture prior, as a block: 0 = θ(q) + r, r ~ N(0, diag(k σ_j)²), θ each joint's rotation vector from neutral.

σ_j is the spread of the joint's angle among people and k a factor. A dof without markers stays near the posture of
people; an observed one moves by less than its own noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import Block, Notes, OperatingPoint, State
from mbkf.sensors.posture_sensor import PostureSensor


def posture_information(deviation: Array, jacobian: Array, weights: Array) -> Information:
    """Information of a zero deviation on the configuration (nv), without readings of an instrument.

    Args:
        deviation: (nv,) of every dof, rad (:meth:`PostureSensor.deviation`).
        jacobian: (nv, nv) its derivative.
        weights: (nv,) 1/sd of each dof's reading (:meth:`PostureSensor.weights`).
    """
    scaled = jacobian * weights[:, None]
    return Information(scaled.T @ scaled, -(deviation * weights) @ scaled, 0.0, 0)


def prior_information(
    sensor: PostureSensor, deviation: Array, jacobian: Array, weights: Array
) -> Information:
    """:func:`posture_information` by compiled code, where the sensor's body has some; equal up to rounding.

    Args:
        sensor: Deviation of every joint from neutral.
        deviation: (nv,) its deviation, rad.
        jacobian: (nv, nv) its derivative.
        weights: (nv,) 1/sd of each dof's reading.
    """
    if sensor.tree is None:
        return posture_information(deviation, jacobian, weights)
    return Information(*sensor.tree.posture_information(deviation, jacobian, weights), 0.0, 0)


@dataclass(frozen=True)
class PostureSettings:
    """Weight of the posture prior.

    Attributes:
        posture_scale: Factor k on the body's table of spreads, per frame; 0.35 in its place for joints beside a segment
            without markers (:mod:`mbkf.sensors.holes`).
        unseen_posture: Factor on the prior's weight for unobserved joints: repeated in every frame, the full weight
            would soon outweigh earlier readings.
    """

    posture_scale: float = 1.0
    unseen_posture: float = 1.0


class PreparedPosture(NamedTuple):
    """Deviation (nv,) from neutral, its Jacobian (nv, nv), and the information while every segment is observed."""

    deviation: Array
    jacobian: Array
    information: Information


class PosturePrior(Block[State, PreparedPosture, Notes, None]):
    """The posture prior.

    Attributes:
        sensor: Deviation of every joint from neutral.
        settings: Its weight.
        weights: (nv,) 1/sd of each dof's deviation, 1/rad.
    """

    prior = True

    def __init__(
        self,
        sensor: PostureSensor,
        unobservable: BoolArray,
        settings: PostureSettings,
        dilution: Array | None = None,
    ) -> None:
        """Args: the attributes; unobservable: (nv,) dofs without a prior; dilution: (nv,) factor on their spreads."""
        self.sensor, self.settings = sensor, settings
        self.weights = sensor.weights(settings.posture_scale, unobservable)
        if dilution is not None:
            self.weights = self.weights / dilution

    def prepare(self, state: State, memory: None) -> PreparedPosture:
        """The prior's information while every segment is observed."""
        deviation, jacobian = self.sensor.deviation(state.q)
        return PreparedPosture(
            deviation, jacobian, prior_information(self.sensor, deviation, jacobian, self.weights)
        )

    def linearise(self, at: OperatingPoint[State, PreparedPosture], decision: Notes) -> Information:
        """Information on the configuration, of less weight for unobserved joints."""
        unobserved, prepared = decision.unobserved, at.prepared
        if not len(unobserved) or self.settings.unseen_posture == 1.0:
            return prepared.information
        weights = self.weights.copy()
        weights[unobserved] *= self.settings.unseen_posture
        return prior_information(self.sensor, prepared.deviation, prepared.jacobian, weights)
