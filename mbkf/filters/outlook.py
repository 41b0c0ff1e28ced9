"""What a state says of a frame before anything of it is read: where markers are, what Newton asks, how the body leans.

None of it depends on the frame, so a live stream has it worked out before the frame arrives.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.filters.singer import DynamicState
from mbkf.filters.synergy import Synergy
from mbkf.model.newton_euler import NewtonEuler
from mbkf.numerics.kalman import Information
from mbkf.sensors.joint_limits import JointLimits
from mbkf.sensors.markers import MarkerReading, MarkerSensor
from mbkf.sensors.posture import PostureSensor, pull


@dataclass(frozen=True)
class Outlook:
    """What can be said at a state.

    Attributes:
        state: The state.
        reading: Its markers.
        law: (6, N) whitened rows of Newton's law at the pelvis.
        law_values: (6,) their innovations.
        deviation: (nv,) of every dof from the neutral posture, rad.
        by_q: (nv, nv) its derivative.
        limit: What the passed joint limits say about the configuration, None where none is passed.
        lean: What posture and limits say about it while every segment is in sight.
    """

    state: DynamicState
    reading: MarkerReading
    law: Array
    law_values: Array
    deviation: Array
    by_q: Array
    limit: Information | None
    lean: Information


class Prediction(NamedTuple):
    """What is known of the next frame before it comes.

    Attributes:
        outlook: From the predicted state.
        acceleration_sd: (nv,) σ_a with which that was predicted.
        synergies: How joints that were out of sight before go with the others.
    """

    outlook: Outlook
    acceleration_sd: Array
    synergies: Mapping[int, Synergy]


class Outlooks:
    """Looks at states.

    Attributes:
        balance: Newton–Euler equations.
        posture: The pull towards the neutral posture.
        limits: How far joints turn.
    """

    def __init__(self, sensor: MarkerSensor, held: BoolArray, settings: DynamicSettings) -> None:
        """Args: the markers on the body, dofs that no marker moves with (nv,), and what is believed."""
        model, s = sensor.model, settings
        self._sensor = sensor
        self.balance = NewtonEuler(model)
        self.posture = PostureSensor(model)
        self.limits = JointLimits(model, held, s.limit_sd_rad)
        self._weights = self.posture.weights(s.posture_scale, held)
        self._unseen = s.unseen_posture
        self._law = 1.0 / np.repeat([s.residual_force_n, s.residual_moment_nm], 3)

    def at(self, state: DynamicState) -> Outlook:
        """The outlook of a state."""
        law, law_values = self._newton_euler(state)
        deviation, by_q = self.posture.deviation(state.q)
        limit = self.limits.information(deviation, by_q)
        lean = self._leaning(deviation, by_q, limit, self._weights)
        reading = self._sensor.reading(state.q)
        return Outlook(state, reading, law, law_values, deviation, by_q, limit, lean)

    def lean(self, outlook: Outlook, unseen: NDArray[np.intp]) -> Information:
        """What posture and limits say about the configuration where some dofs are out of sight."""
        if not len(unseen):
            return outlook.lean
        weights = self._weights.copy()
        weights[unseen] *= self._unseen
        return self._leaning(outlook.deviation, outlook.by_q, outlook.limit, weights)

    def _newton_euler(self, state: DynamicState) -> tuple[Array, Array]:
        nv = len(state.v)
        root, sharp = self.balance.root(state.q, state.v, state.a, state.w), self._law[:, None]
        rows = np.empty((6, 3 * nv + 12))
        np.multiply(root.by_q, sharp, out=rows[:, :nv])
        np.multiply(root.by_v, sharp, out=rows[:, nv : 2 * nv])
        np.multiply(root.by_a, sharp, out=rows[:, 2 * nv : 3 * nv])
        rows[:, 3 * nv : 3 * nv + 6] = rows[:, 3 * nv + 6 :] = root.by_wrench * sharp
        return rows, -root.residual * self._law

    def _leaning(
        self, deviation: Array, by_q: Array, limit: Information | None, weights: Array
    ) -> Information:
        held = pull(deviation, by_q, weights)
        return held if limit is None else held + limit
