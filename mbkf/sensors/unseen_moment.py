"""Unseen moment, as a block: that of arms and head in another posture than assumed, and of wrong masses.

    dm/dt = −m/τ + noise, standing at m ~ N(0, σ² I₃)          a state, about the pelvis's origin and axes
    0 = [ID(q, v, a) − Σ J_fᵀ w_f]₄₋₆ + m + r                   Newton's law (:mod:`mbkf.sensors.newton_euler`)

Arms that hang forward shift a body's balance all the time. As white noise, their moment would be averaged away, and
the filter would bend the trunk and the knees instead. The decay is a reading of zero in every frame, whose spread
σ √(τ / 2Δt) leaves a random walk of 2σ²/τ the variance σ².
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.model.layout import UNSEEN_MOMENT, ExtraState
from mbkf.sensors.block import Block, Notes, OperatingPoint, Rows
from mbkf.sensors.states import LoadedState


@dataclass(frozen=True)
class UnseenMomentSettings:
    """Size and duration of the unseen moment.

    Attributes:
        unseen_moment_nm: σ, per component.
        unseen_memory_s: τ.
    """

    unseen_moment_nm: float = 50.0
    unseen_memory_s: float = 2.0


class UnseenMoment(Block[LoadedState, None, Notes, None]):
    """A state of three, and its decay."""

    prior = True

    def __init__(self, dt_s: float, settings: UnseenMomentSettings = UnseenMomentSettings()) -> None:
        """Args: time between frames; size and duration."""
        self.settings = settings
        s = settings
        self._walk = s.unseen_moment_nm * (2.0 / s.unseen_memory_s) ** 0.5
        self._sd = s.unseen_moment_nm * (0.5 * s.unseen_memory_s / dt_s) ** 0.5

    def states(self) -> list[ExtraState]:
        """The moment, N m, in the pelvis's axes."""
        start_sd = np.full(3, self.settings.unseen_moment_nm)
        return [ExtraState(UNSEEN_MOMENT, np.zeros(3), start_sd, np.full(3, self._walk))]

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: Notes) -> Rows:
        """Three rows on the moment."""
        moment = at.state.extra[self.layout.extra_index(UNSEEN_MOMENT)]
        return Rows(np.eye(3) / self._sd, -moment / self._sd, self.layout[UNSEEN_MOMENT].start)
