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

from mbkf.model.layout import UNSEEN_MOMENT
from mbkf.sensors.root_residual import DecayingLoad


@dataclass(frozen=True)
class UnseenMomentSettings:
    """Size and duration of the unseen moment.

    Attributes:
        unseen_moment_nm: σ, per component.
        unseen_memory_s: τ.
    """

    unseen_moment_nm: float = 50.0
    unseen_memory_s: float = 2.0


class UnseenMoment(DecayingLoad):
    """A state of three, moment N m about the pelvis's origin in its axes, and its decay."""

    def __init__(self, dt_s: float, settings: UnseenMomentSettings = UnseenMomentSettings()) -> None:
        """Args: time between frames; size and duration."""
        super().__init__(UNSEEN_MOMENT, np.full(3, settings.unseen_moment_nm), settings.unseen_memory_s, dt_s)
