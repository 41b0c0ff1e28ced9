"""Newton's law at the pelvis, as a block: 0 = [ID(q, v, a) − Σ J_fᵀ w_f]₁…₆ + r, r ~ N(0, diag(σ_F² I₃, σ_M² I₃)).

The six rows of the root are what no joint torque can balance (:mod:`mbkf.model.newton_euler`); for a body whose every
contact is in the state they vanish. They are read as zero. Torques of the joints follow from the state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import BoolArray
from mbkf.model.body import Body
from mbkf.model.layout import ROOT_RESIDUAL, SUPPORT, UNSEEN_MOMENT, Layout
from mbkf.model.newton_euler import ROOT, NewtonEuler
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
        stray_residual_scale: Factor on both while a loaded plate belongs to no foot and no marker of the capture shows
            a foot: the load, up to a body's weight, acts on no segment, and the law would bend the motion for it.
    """

    residual_force_n: float = 2.0
    residual_moment_nm: float = 1.0
    imu_residual_scale: float = 30.0
    stray_residual_scale: float = 300.0


LOADS_AT_ROOT = {UNSEEN_MOMENT: slice(3, 6), ROOT_RESIDUAL: slice(0, 6)}
"""Added states that act at the root itself, and the rows of the law that they add to."""


class NewtonEulerLaw(Block[LoadedState, Rows, Notes, None]):
    """Newton's law at the root, on a state (q, v, a, wrenches).

    Attributes:
        balance: Newton–Euler equations.
        settings: Standard deviations.
    """

    kind = "law"
    quantities = 2

    def __init__(
        self,
        balance: NewtonEuler,
        settings: NewtonEulerSettings = NewtonEulerSettings(),
        unobservable: BoolArray | None = None,
    ) -> None:
        """Makes the block.

        Args:
            balance: Newton–Euler equations.
            settings: Standard deviations.
            unobservable: (nv,) dofs that no marker of the capture moves with; None where all dofs are shown.
        """
        self.balance, self.settings = balance, settings
        self._support: slice | None = None
        self._support_extra = slice(0)
        self._left_foot = slice(0)
        self._by_extra = np.zeros((ROOT, 0))
        model = balance.model
        feet = [model.joint(segment).v.start for segment in model.roles.feet]
        self._unseen_foot = unobservable is not None and bool(unobservable[feet].any())
        self._sharp = 1.0 / np.repeat([settings.residual_force_n, settings.residual_moment_nm], 3)

    def bind(self, layout: Layout, body: Body) -> None:
        """Keeps the slices of the wrench of other contacts and of loads at the root, if the state has them."""
        if SUPPORT in layout:
            self._support, self._support_extra = layout[SUPPORT], layout.extra_index(SUPPORT)
        self._left_foot = layout.feet[1]
        by_extra = np.zeros((ROOT, layout.size - layout.extra.start))
        used = self._support_extra.stop
        for name, components in LOADS_AT_ROOT.items():
            if name in layout:
                own = layout.extra_index(name)
                by_extra[components, own] = np.diag(self._sharp[components])
                used = max(used, own.stop)
        self._by_extra = by_extra[:, :used].copy()

    def prepare(self, state: LoadedState, memory: None) -> Rows:
        """The law's rows at a state; they do not depend on the frame."""
        wrenches, support = state.w, self._support
        if support is not None:
            # At the root a wrench counts alike wherever it acts: that of other parts adds to the right foot's.
            wrenches = wrenches.copy()
            wrenches[:6] += state.extra[self._support_extra]
        extra = state.extra[: self._by_extra.shape[1]]
        rows, innovation = self.balance.law(
            state.q, state.v, state.a, wrenches, extra, self._by_extra, self._sharp
        )
        if support is not None:
            rows[:, support] = rows[:, self._left_foot]
        return Rows(rows, innovation, readings=6)

    def linearise(self, at: OperatingPoint[LoadedState, Rows], decision: Notes) -> Rows:
        """The prepared rows, loosened for limbs that only inertial sensors lead, and for loads on feet never seen."""
        rows, scale = at.prepared, 1.0
        if decision.imus is not None and len(decision.unobserved):
            scale = self.settings.imu_residual_scale
        if decision.contact is not None and decision.contact.stray and self._unseen_foot:
            scale = max(scale, self.settings.stray_residual_scale)
        return rows if scale == 1.0 else Rows(rows.jacobian / scale, rows.innovation / scale, readings=6)

    def log_noise(self, decision: Notes) -> float:
        """Log det R of the six equations."""
        return -2.0 * float(np.log(self._sharp).sum())
