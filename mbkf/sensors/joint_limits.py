"""How far joints turn: beyond a limit it is read softly as passed by nothing (an inequality, one block a frame)."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.human import HumanModel
from mbkf.numerics.kalman import Information


class JointLimits:
    """Least and greatest rotation of every joint about its axes, from the neutral posture.

    Attributes:
        lower, upper: (nv,) limits, rad; ±inf where there is none.
        sd_rad: Softness.
    """

    def __init__(self, model: HumanModel, held: BoolArray, sd_rad: float) -> None:
        self.lower = np.where(held, -np.inf, model.limits[:, 0])
        self.upper = np.where(held, np.inf, model.limits[:, 1])
        self.sd_rad = sd_rad
        self._turning = [joint.v for joint in model.joints.values() if joint.kind == "spherical"]

    def information(self, deviation: Array, jacobian: Array) -> Information | None:
        """What the passed limits say about the configuration (nv), or None where none is passed; no readings.

        Args:
            deviation: (nv,) rotation of every joint from neutral, rad (``PostureSensor.deviation``).
            jacobian: (nv, nv) its derivative.
        """
        beyond = deviation - np.minimum(np.maximum(deviation, self.lower), self.upper)
        if not np.count_nonzero(beyond):
            return None
        for dofs in self._turning:
            if beyond[dofs].any() and self._is_within(_other_way_round(deviation[dofs]), dofs):
                beyond[dofs] = 0.0
        passed = np.flatnonzero(beyond)
        if not len(passed):
            return None
        rows = jacobian[passed] / self.sd_rad
        return Information(rows.T @ rows, -(beyond[passed] / self.sd_rad) @ rows, 0.0, 0)

    def _is_within(self, rotation: Array, dofs: slice) -> bool:
        return bool(((rotation >= self.lower[dofs]) & (rotation <= self.upper[dofs])).all())


def _other_way_round(rotation: Array) -> Array:
    """(3,) the same turn as a rotation vector beyond π: an arm raised past the vertical is not one swung far back."""
    return rotation * (1.0 - 2.0 * np.pi / float(np.linalg.norm(rotation)))
