"""Newton's law at the pelvis, as a block: 0 = [ID(q, v, a) − Σ J_fᵀ w_f]₁…₆ + r, r ~ N(0, diag(σ_F² I₃, σ_M² I₃)).

The six rows of the root are what no joint torque can balance (:mod:`mbkf.model.newton_euler`); for a body whose every
contact is in the state they vanish. They are read as zero. Torques of the joints follow from the state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.model.body import Body
from mbkf.model.layout import SUPPORT, UNSEEN_MOMENT, Layout
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import Block, Notes, OperatingPoint, Rows
from mbkf.sensors.states import LoadedState


@dataclass(frozen=True)
class NewtonEulerSettings:
    """Standard deviations of Newton's law for a body of rigid segments.

    Attributes:
        residual_force_n, residual_moment_nm: Of the residual at the pelvis, per component. The law itself is exact;
            they allow for errors of the segments' masses and inertias.
        imu_residual_scale: Factor on both while inertial sensors read and a limb has neither marker nor sensor: the
            errors of the sensors would throw that limb about.
    """

    residual_force_n: float = 2.0
    residual_moment_nm: float = 1.0
    imu_residual_scale: float = 30.0


class NewtonEulerLaw(Block[LoadedState, Rows, Notes, None]):
    """Newton's law at the root, on a state (q, v, a, wrenches).

    Attributes:
        balance: Newton–Euler equations.
        settings: Standard deviations.
    """

    kind = "law"
    quantities = 2

    def __init__(self, balance: NewtonEuler, settings: NewtonEulerSettings = NewtonEulerSettings()) -> None:
        self.balance, self.settings = balance, settings
        self._support: slice | None = None
        self._unseen: slice | None = None
        self._support_extra, self._unseen_extra = slice(0), slice(0)
        self._sharp = 1.0 / np.repeat([settings.residual_force_n, settings.residual_moment_nm], 3)

    def bind(self, layout: Layout, body: Body) -> None:
        """Keeps the slices of the wrench of other contacts and of the unseen moment, if the state has them."""
        if SUPPORT in layout:
            self._support, self._support_extra = layout[SUPPORT], layout.extra_index(SUPPORT)
        if UNSEEN_MOMENT in layout:
            self._unseen, self._unseen_extra = layout[UNSEEN_MOMENT], layout.extra_index(UNSEEN_MOMENT)

    def prepare(self, state: LoadedState, memory: None) -> Rows:
        """The law's rows at a state; they do not depend on the frame."""
        wrenches, support, unseen = state.w, self._support, self._unseen
        if support is not None:
            # At the root a wrench counts alike wherever it acts: that of other parts adds to the right foot's.
            wrenches = wrenches.copy()
            wrenches[:6] += state.extra[self._support_extra]
        root, sharp = self.balance.root(state.q, state.v, state.a, wrenches), self._sharp[:, None]
        residual = root.residual
        if support is None and unseen is None:
            return Rows(root.by_state * sharp, -residual * self._sharp, readings=6)
        rows = np.zeros((6, max(part.stop for part in (support, unseen) if part is not None)))
        np.multiply(root.by_state, sharp, out=rows[:, : root.by_state.shape[1]])
        if support is not None:
            np.multiply(root.by_state[:, -6:], sharp, out=rows[:, support])
        if unseen is not None:
            residual = residual.copy()
            residual[3:] += state.extra[self._unseen_extra]
            rows[3:, unseen] = np.diag(self._sharp[3:])
        return Rows(rows, -residual * self._sharp, readings=6)

    def linearise(self, at: OperatingPoint[LoadedState, Rows], decision: Notes) -> Rows:
        """The prepared rows, loosened for a limb without marker and sensor while inertial sensors read."""
        rows = at.prepared
        if decision.imus is None or not len(decision.unobserved):
            return rows
        scale = self.settings.imu_residual_scale
        return Rows(rows.jacobian / scale, rows.innovation / scale, readings=6)

    def log_noise(self, decision: Notes) -> float:
        """Log det R of the six equations."""
        return -2.0 * float(np.log(self._sharp).sum())
