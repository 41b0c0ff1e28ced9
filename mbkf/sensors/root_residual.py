"""Root residual, as a block: the load that rigid segments and known contacts leave unexplained.

    dr/dt = −r/τ + noise, standing at r ~ N(0, diag(σ_F² I₃, σ_M² I₃))      a state, in the root's axes
    0 = [ID(q, v, a) − Σ J_fᵀ w_f]₁…₆ + r + ε                               :mod:`mbkf.sensors.newton_euler`

Soft tissue that bounces, wrong segment masses and drifting plates act for tenths of a second. As white noise alone,
they would be averaged away, and the accelerations would leave the positions instead. The decay is a reading of zero in
every frame, whose spread σ √(τ / 2Δt) leaves a random walk of 2σ²/τ the variance σ² in the filter. Later frames read
zero, too: over a whole trial the process has the variance σ²/2 and the correlation e^(−2|t|/τ).
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.model.body import Body
from mbkf.model.layout import ROOT_RESIDUAL, ExtraState, Layout
from mbkf.sensors.block import Block, Notes, OperatingPoint, Rows
from mbkf.sensors.contact.records import unread
from mbkf.sensors.states import LoadedState


@dataclass(frozen=True)
class RootResidualSettings:
    """Size and duration of the root residual.

    Attributes:
        residual_share: σ_F of each component, as a share of body weight; 0 leaves the residual out of the state.
        residual_lever_m: σ_M of each component, as a lever of body weight.
        residual_memory_s: τ.
        unread_residual_scale: Factor by which the decay's readings of the force are sharper while feet stand and no
            plate reads: the feet's forces take up every load, and the mean force has to change the momentum.
    """

    residual_share: float = field(default=0.05, metadata={"zero": True})
    residual_lever_m: float = 0.03
    residual_memory_s: float = 0.2
    unread_residual_scale: float = 3.0


class DecayingLoad(Block[LoadedState, None, Notes, None]):
    """A load at the root as a state, a random walk that is read as zero in every frame.

    Attributes:
        name: Its slice in the layout.
        sd: (k,) standard deviation that the filter's variance stands at without other readings, N or N m.
    """

    prior = True

    @abstractmethod
    def __init__(self, name: str, sd: Array, memory_s: float, dt_s: float) -> None:
        """Makes the block.

        Args:
            name: Its slice in the layout, one of :data:`mbkf.sensors.newton_euler.LOADS_AT_ROOT`.
            sd: (k,) standard deviation, N or N m.
            memory_s: Time τ of the decay.
            dt_s: Time between frames.
        """
        self.name, self.sd = name, sd
        self._walk = sd * (2.0 / memory_s) ** 0.5
        self._sharp = 1.0 / (sd * (0.5 * memory_s / dt_s) ** 0.5)
        self._rows = read_only(np.diag(self._sharp))

    def bind(self, layout: Layout, body: Body) -> None:
        """Keeps where the load lies in the state."""
        super().bind(layout, body)
        self._own, self._first = layout.extra_index(self.name), layout[self.name].start

    def states(self) -> list[ExtraState]:
        """The load, in the root's axes."""
        return [ExtraState(self.name, np.zeros(len(self.sd)), self.sd, self._walk)]

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: Notes) -> Rows:
        """Rows on the load, one a component."""
        return Rows(self._rows, -at.state.extra[self._own] * self._sharp, self._first)


class RootResidual(DecayingLoad):
    """A state of six, force N and moment N m about the root's origin, and its decay."""

    def __init__(
        self, weight_n: float, dt_s: float, settings: RootResidualSettings = RootResidualSettings()
    ) -> None:
        """Makes the block.

        Args:
            weight_n: Body weight.
            dt_s: Time between frames.
            settings: Size and duration.
        """
        s = settings
        sd = weight_n * np.repeat([s.residual_share, s.residual_lever_m], 3)
        super().__init__(ROOT_RESIDUAL, sd, s.residual_memory_s, dt_s)
        self._unread = np.repeat([s.unread_residual_scale, 1.0], 3)

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: Notes) -> Rows:
        """Rows on the load, one a component; sharper while feet stand and no plate reads."""
        rows = super().linearise(at, decision)
        if decision.contact is None or not unread(decision.contact.contacts):
            return rows
        return Rows(rows.jacobian * self._unread[:, None], rows.innovation * self._unread, rows.first)
