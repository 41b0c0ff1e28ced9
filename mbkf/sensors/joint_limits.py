"""Joint limits, as a block: 0 = θ(q) − θ_max + r, r ~ N(0, σ²), for a joint beyond its limit θ_max.

An inequality: a joint inside its limits is not read.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.kalman import Information
from mbkf.sensors.block import Block, Notes, OperatingPoint, State
from mbkf.sensors.posture_sensor import PostureSensor


@dataclass(frozen=True)
class JointLimitSettings:
    """Softness of the limits.

    Attributes:
        limit_sd_rad: Standard deviation σ of a reading at a limit.
    """

    limit_sd_rad: float = 0.03


class JointLimits(Block[State, Information | None, Notes, None]):
    """Least and greatest rotation of every joint about its axes, from the neutral posture.

    Attributes:
        lower, upper: (nv,) limits, rad; ±inf without one.
        sd_rad: Softness.
    """

    prior = True

    def __init__(
        self,
        sensor: PostureSensor,
        unobservable: BoolArray,
        settings: JointLimitSettings = JointLimitSettings(),
    ) -> None:
        """Args: sensor: deviation from neutral; unobservable: (nv,) dofs without a limit; settings: softness."""
        model = sensor.model
        self._sensor, self.sd_rad = sensor, settings.limit_sd_rad
        self.lower = np.where(unobservable, -np.inf, model.limits[:, 0])
        self.upper = np.where(unobservable, np.inf, model.limits[:, 1])
        self._turning = [joint.v for joint in model.joints.values() if joint.kind == "spherical"]

    def prepare(self, state: State, memory: None) -> Information | None:
        """Information of the passed limits, which does not depend on the frame."""
        return self.information(*self._sensor.deviation(state.q))

    def linearise(self, at: OperatingPoint[State, Information | None], decision: Notes) -> Information | None:
        """Information on the configuration, None without a passed limit."""
        return at.prepared

    def information(self, deviation: Array, jacobian: Array) -> Information | None:
        """Information of the passed limits on the configuration (nv), without readings; None if no limit is passed.

        The deviation (nv,) and its Jacobian (nv, nv) are those of :meth:`PostureSensor.deviation`.
        """
        beyond = self.beyond(deviation)
        if beyond is None:
            return None
        tree = self._sensor.tree
        if tree is not None:
            weights = (beyond != 0.0) / self.sd_rad
            return Information(*tree.posture_information(beyond, jacobian, weights), 0.0, 0)
        passed = np.flatnonzero(beyond)
        rows = jacobian[passed] / self.sd_rad
        return Information(rows.T @ rows, -(beyond[passed] / self.sd_rad) @ rows, 0.0, 0)

    def beyond(self, deviation: Array) -> Array | None:
        """(nv,) distance of each rotation (nv,) from its range, rad; None where all lie within."""
        if self._sensor.tree is not None:
            return self._sensor.tree.limit_excess(deviation, self.lower, self.upper)
        beyond = deviation - np.minimum(np.maximum(deviation, self.lower), self.upper)
        if not np.count_nonzero(beyond):
            return None
        for dofs in self._turning:
            if beyond[dofs].any() and self._is_within(_other_way_round(deviation[dofs]), dofs):
                beyond[dofs] = 0.0
        return beyond if beyond.any() else None

    def _is_within(self, rotation: Array, dofs: slice) -> bool:
        return bool(((rotation >= self.lower[dofs]) & (rotation <= self.upper[dofs])).all())


def _other_way_round(rotation: Array) -> Array:
    """(3,) the same turn as a rotation vector beyond π: an arm raised past the vertical is not one swung far back."""
    return rotation * (1.0 - 2.0 * np.pi / float(np.linalg.norm(rotation)))
