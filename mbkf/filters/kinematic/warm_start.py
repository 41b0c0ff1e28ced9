"""Start of every filter that sees markers: the kinematic filter first runs the next frames backwards."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.report import FirstMotion
from mbkf.sensors.block import Frame
from mbkf.sensors.limb_fit import LimbFits

WARM_UP_S = 0.25
"""Stretch of a trial that is first run through backwards to start with a velocity."""

SETTLING_S = 0.05
"""While a started filter settles, accelerations are those of the backward run."""


def warm_up_frames(dt_s: float) -> int:
    """Number of frames after its own that a warm start uses."""
    return round(WARM_UP_S / dt_s)


class WarmStart:
    """A state that already knows its velocity, from markers (:class:`mbkf.filters.tracking_filter.Start`).

    Attributes:
        kalman: The kinematic filter that runs backwards.
        restart_after_s: Time without enough markers after which a filter starts anew.
        placed: Markers show at once where the body is.
        limbs: Judges and fits limbs by their markers; None: limbs are not watched.
    """

    placed = True

    def __init__(self, kalman: KinematicFilter, limbs: LimbFits | None = None) -> None:
        self.kalman, self.restart_after_s = kalman, kalman.settings.restart_after_s
        self.limbs = limbs

    def __call__(self, recording: Recording, t: int, guess: Array | None) -> FirstMotion | None:
        """The motion at frame t; None where its markers do not fit the body.

        Args:
            recording: The readings.
            t: The frame.
            guess: (nq,) configuration to start the pose fit from besides the segment-by-segment one.
        """
        kalman, markers, dt = self.kalman, recording.markers_m, recording.dt_s
        last = min(t + warm_up_frames(dt), len(markers) - 1)
        here = kalman.start(markers[t], guess)
        if here is None:
            return None
        state = kalman.start(markers[last], here.q)
        if state is None or last == t:
            return FirstMotion(here, np.zeros((1, len(here.v))))
        backwards, memory, no_plates = [state.v], kalman.begin(), np.zeros((0, 6))
        for seen in markers[t:last][::-1]:
            state = kalman.step(state, memory, Frame(seen, no_plates)).state
            backwards.append(state.v)
        accelerations = -np.diff(np.array(backwards)[::-1], axis=0) / dt
        return FirstMotion(state.reversed_in_time(), accelerations[: max(1, round(SETTLING_S / dt))])
