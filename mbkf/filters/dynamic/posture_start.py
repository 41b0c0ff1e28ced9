"""Start of a filter on inertial sensors alone: from a given posture, since no camera shows one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.report import FirstMotion


class PostureStart:
    """Starts at rest from a posture (:class:`mbkf.filters.tracking_filter.Start`).

    Attributes:
        restart_after_s: Time without enough readings after which the filter starts anew.
        placed: False, since no instrument shows at once where the body is.
        limbs: None, since there are no markers.
    """

    placed, limbs = False, None

    def __init__(self, first: KinematicState, unobservable: BoolArray, restart_after_s: float) -> None:
        """Makes the start.

        Args:
            first: The posture with its velocity and covariance.
            unobservable: (nv,) dofs that no sensor shows; they rest.
            restart_after_s: Time without enough readings after which the filter starts anew.
        """
        self._state = replace(first, v=np.where(unobservable, 0.0, first.v))
        self.restart_after_s = restart_after_s

    def __call__(self, recording: Recording, t: int, guess: Array | None) -> FirstMotion:
        """The posture, or a guess (nq,) in its place after a loss.

        Args:
            recording: The readings, which are not used.
            t: The frame.
            guess: (nq,) configuration near which the body may be.
        """
        state = self._state if guess is None else replace(self._state, q=guess)
        return FirstMotion(state, np.zeros((1, len(state.v))))
