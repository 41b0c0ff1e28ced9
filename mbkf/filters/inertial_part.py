"""What inertial sensors add to the dynamic filter: their rows, which joints they feel, and the usual posture.

A limb that neither markers nor sensors show is held near the posture it had on average when it was last seen: for
longer than a fraction of a second that is a better guess than the standing posture or the last one.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic_records import Decision, Memory
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.filters.singer import DynamicState
from mbkf.sensors.inertial import InertialSensor
from mbkf.sensors.inertial_rows import InertialRows


class InertialPart:
    """Inertial sensors as a part of the dynamic filter.

    Attributes:
        block: Their readings.
    """

    def __init__(self, sensor: InertialSensor, dt_s: float, settings: DynamicSettings) -> None:
        self.block = InertialRows(sensor, settings.imu_rate_sd_rad_s, settings.imu_force_sd_mps2)
        self._model, self._settings = sensor.model, settings
        # Toes bend with every step: their mean says little.
        self._limb = np.zeros(sensor.model.nv, dtype=bool)
        for joint in sensor.model.joints.values():
            self._limb[joint.v] = joint.kind not in ("free", "hinge")
        self._share = 1.0 - np.exp(-dt_s / settings.usual_posture_s)

    def decide(self, decision: Decision, memory: Memory, imus: Array) -> Decision:
        """The decision with a frame's readings (S, 6); as it was where none was read."""
        if not np.isfinite(imus).any():
            return decision
        unseen = decision.unseen
        unfelt = unseen[~self.block.felt[unseen]]
        return decision._replace(imus=imus, unmarked=unseen, unseen=unfelt, usual=memory.usual)

    def remember(self, memory: Memory, before: Memory, q: Array, decision: Decision) -> Memory:
        """The memory with the mean posture of the joints that are seen."""
        if before.usual is None:
            return memory._replace(usual=q)
        step = self._share * self._model.difference(before.usual, q)
        step[decision.unseen] = 0.0
        step[:6] = 0.0
        return memory._replace(usual=self._model.integrate(before.usual, step))

    def parts(
        self, state: DynamicState, decision: Decision, law: Array, law_values: Array
    ) -> list[tuple[int, Array, Array]]:
        """Whitened rows with the component of the state that their first column stands for, and innovations.

        Where a limb is neither seen nor felt, Newton's law at the pelvis is loosened in place: else that limb would be
        thrown about to make up for the sensors' errors.

        Args:
            state: Where to linearise.
            decision: What the frame's readings were taken to be.
            law: (6, N) whitened rows of Newton's law.
            law_values: (6,) their innovations.
        """
        if decision.imus is None:
            return []
        if len(decision.unseen):
            law /= self._settings.imu_residual_scale
            law_values /= self._settings.imu_residual_scale
        found = [(0, *self.block.rows(state.q, state.v, state.a, decision.imus))]
        dofs = decision.unseen[self._limb[decision.unseen]]
        if decision.expected is not None:
            dofs = np.setdiff1d(dofs, decision.expected.dofs)
        if decision.usual is not None and len(dofs):
            sd = self._settings.usual_posture_sd_rad
            jacobian = self._model.difference_derivative(decision.usual, state.q)[dofs] / sd
            found.append((0, jacobian, -self._model.difference(decision.usual, state.q)[dofs] / sd))
        return found
