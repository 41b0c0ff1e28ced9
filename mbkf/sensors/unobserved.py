"""Unobserved joints, as a block: 0 = v + r_v and 0 = a + r_a, for the dofs of segments out of sight.

Without it their velocity would last for ever. The spreads are wide, so that it fades within a few frames:
σ_v is the joint's movement acceleration over a time, σ_a a multiple of that acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, read_only
from mbkf.sensors.block import Block, Notes, OperatingPoint, Rows, State
from mbkf.sensors.states import AcceleratedState


@dataclass(frozen=True)
class UnobservedSettings:
    """Damping of unobserved joints.

    Attributes:
        unseen_velocity_s, unseen_velocity_range: σ_v is the movement acceleration over that time, s, within the range,
            rad/s.
        unseen_acceleration_share: σ_a as a share of the movement acceleration.
    """

    unseen_velocity_s: float = 0.075
    unseen_velocity_range: tuple[float, float] = (10.0, 30.0)
    unseen_acceleration_share: float = 10.0


class UnobservedJoints(Block[State, None, Notes, None]):
    """Damping of velocity, and of acceleration where the state holds one, per reading."""

    prior = True

    def __init__(self, velocity_sd: Array, acceleration_sd: Array | None = None) -> None:
        """Args: standard deviations (nv,) of velocities and accelerations about zero; None for no acceleration."""
        self._rest = 1.0 / velocity_sd
        self._calm = None if acceleration_sd is None else 1.0 / np.maximum(acceleration_sd, 1e-300)
        self._kept: tuple[bytes, Array, Array] | None = None

    @classmethod
    def of(cls, movement_sd: Array, settings: UnobservedSettings) -> UnobservedJoints:
        """The block for a body's movement accelerations (nv,); 0 for dofs that move no marker of the capture."""
        s = settings
        velocity = np.clip(s.unseen_velocity_s * movement_sd, *s.unseen_velocity_range)
        return cls(velocity, s.unseen_acceleration_share * movement_sd)

    def linearise(self, at: OperatingPoint[State, None], decision: Notes) -> Rows | None:
        """A row on the velocity, and one on the acceleration, of each unobserved dof."""
        dofs, state = decision.unobserved, at.state
        if not len(dofs):
            return None
        rows, rest = self._weights(dofs, len(state.v))
        speed = -rest * state.v[dofs]
        if self._calm is not None:
            slowing = -self._calm[dofs] * cast(AcceleratedState, state).a[dofs]
            return Rows(rows, np.concatenate([speed, slowing]), self.layout.v.start)
        vector = np.zeros(len(state.v))
        vector[dofs] = rest * speed
        return Rows(rows, speed, self.layout.v.start, vector=vector)

    def _weights(self, dofs: NDArray[np.intp], nv: int) -> tuple[Array, Array]:
        """Rows on velocities and accelerations of dofs (n,) of nv, and weights of the first; kept for the next call."""
        asked = dofs.tobytes()
        if self._kept is None or self._kept[0] != asked:
            k, rest = np.arange(len(dofs)), self._rest[dofs]
            kinds = 1 if self._calm is None else 2
            rows = np.zeros((kinds * len(dofs), kinds * nv))
            rows[k, dofs] = rest
            if self._calm is not None:
                rows[len(dofs) + k, nv + dofs] = self._calm[dofs]
            self._kept = asked, read_only(rows), rest
        return self._kept[1:]
