"""The dynamic filter on inertial sensors alone: it starts from a posture that is told, since no camera shows one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.tracking import DynamicTracking
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.kinematic.filter import KinematicFilter


@dataclass(frozen=True)
class FirstPosture:
    """What is known of the body in the first frame.

    Attributes:
        q: (nq,) configuration.
        v: (nv,) velocity.
        covariance: (2 nv, 2 nv) of (q, v).
    """

    q: Array
    v: Array
    covariance: Array


class WornTracking(DynamicTracking):
    """Drives a :class:`DynamicFilter` from a first posture on."""

    def __init__(self, kalman: DynamicFilter, starter: KinematicFilter, first: FirstPosture) -> None:
        """Makes it.

        Args:
            kalman: The filter.
            starter: A kinematic one, whose settings say when to restart.
            first: The first posture.
        """
        super().__init__(kalman, starter)
        self._first = first

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """The first posture; dofs that no sensor tells of rest."""
        at = self._first
        q = at.q if guess is None else guess
        v = np.where(self.kalman.unobservable, 0.0, at.v)
        found = self.kalman.first(q, v, np.zeros_like(v), at.covariance, recording.frame(t))
        return self._estimate(found)._replace(tracked=True, started=True, lag=None, lost=False)

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """One frame on; where the body is, no instrument shows at once."""
        return super().step(before, recording, t, prediction)._replace(placed=False)
