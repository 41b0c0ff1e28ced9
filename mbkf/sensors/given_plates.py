"""Force plates as known inputs of a forced body, as a block: they decide contact, read nothing, and give the loads.

Of the two ways of thesis 3.2.3 this is the other one: a plate's wrench is taken as correct and enters the equations of
motion, M z̈ = Q_g + B_dᵀ T_d + B_pᵀ p; the state is x = [z, ż, T_d]. p is the wrench of each foot about the world's
origin, and that of a frame acts until the next one:

    measured      that of its plate
    air           0
    shared        its share of the plate's wrench, by where the feet stand
    unmeasured    not known; counts as 0, so that the missing load stands in the pelvis residual
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.model.layout import FEET
from mbkf.sensors.block import OperatingPoint
from mbkf.sensors.foot_plates import FootPlates, FootReading, PlateDecision
from mbkf.sensors.states import ForceState


class GivenPlates(FootPlates):
    """Plates whose wrenches are known, on a body with given loads."""

    def linearise(self, at: OperatingPoint[ForceState, None], decision: PlateDecision) -> None:
        """No information: the wrenches are in the equations of motion."""

    def log_noise(self, decision: PlateDecision) -> float:
        """0, without readings."""
        return 0.0

    def sd(self, feet: FootReading) -> Array:
        """(12,) standard deviations: 0, known or taken as 0."""
        return np.zeros(FEET)

    def loads(self, feet: FootReading) -> Array:
        """(12,) wrenches of right and left foot about the world's origin, NaN for a foot of unknown wrench."""
        return np.where(feet.known[:, None], feet.wrench, np.nan).reshape(FEET)
