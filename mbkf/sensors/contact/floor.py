"""Velocity of the floor, and evidence of a fall, from the last second of movement.

On a belt a loaded sole moves at the speed of the belt, and the pelvis does not go along. The floor's velocity is the
median velocity of the lowest point of heels and balls while that is near the floor. A floor at rest is the default
until there is enough evidence, and for a body that glides: its pelvis goes along with its soles.

A filter that takes both feet to be in the air makes the body fall by Newton's law. That acceleration is no evidence of
a fall: the height of the pelvis, which markers show, has to curve down as well.
"""

from __future__ import annotations

from functools import lru_cache
from math import hypot
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.running_median import RunningMedian
from mbkf.sensors.contact.rules import (
    BELT_FROM_M_S,
    BELT_WINDOW_S,
    FALL_M_S2,
    FALL_WINDOW_S,
    STILL_FLOOR_S,
)


class Movement(NamedTuple):
    """The last frames of a body's movement.

    Attributes:
        low_m_s: Horizontal velocity, x and y, of the lowest sole point while it was near the floor; NaN else.
        pelvis_m: The pelvis, x, y, z.
        airborne: Number of frames since which both feet are taken to be in the air.
    """

    low_m_s: tuple[RunningMedian, RunningMedian] = (RunningMedian(), RunningMedian())
    pelvis_m: tuple[tuple[float, float, float], ...] = ()
    airborne: int = 0

    def with_frame(
        self, low_m_s: tuple[float, float], pelvis_m: tuple[float, float, float], dt_s: float
    ) -> Movement:
        """The movement with one more frame, without the oldest one beyond the window.

        Args:
            low_m_s: Horizontal velocity of the lowest sole point; NaN where it is not near the floor.
            pelvis_m: The pelvis.
            dt_s: Time between frames.
        """
        most = frames_of(BELT_WINDOW_S, dt_s)
        low_x, low_y = self.low_m_s
        return Movement(
            (low_x.followed(low_m_s[0], most), low_y.followed(low_m_s[1], most)),
            (*self.pelvis_m[max(0, len(self.pelvis_m) + 1 - most) :], pelvis_m),
            self.airborne,
        )

    def floor_m_s(self, dt_s: float) -> tuple[float, float]:
        """Horizontal velocity of the floor; zero unless a belt is evident. ``dt_s`` is the time between frames."""
        still = frames_of(STILL_FLOOR_S, dt_s)
        x, y = (low.median(still) for low in self.low_m_s)
        speed = hypot(x, y)
        if speed < BELT_FROM_M_S:
            return 0.0, 0.0
        (x0, y0, _), (x1, y1, _), lasted_s = self.pelvis_m[0], self.pelvis_m[-1], len(self.pelvis_m) * dt_s
        goes_along = hypot((x1 - x0) / lasted_s - x, (y1 - y0) / lasted_s - y) < 0.5 * speed
        return (0.0, 0.0) if goes_along else (x, y)

    def held_up(self, dt_s: float) -> bool:
        """True for a body taken to be in the air for a whole window whose pelvis does not curve down in it.

        ``dt_s`` is the time between frames.
        """
        frames = fall_frames(dt_s)
        if self.airborne < frames:
            return False
        heights = np.array(self.pelvis_m[-frames:])[:, 2]
        return float(_curvature(frames) @ heights) / dt_s**2 > FALL_M_S2


NO_MOVEMENT = Movement()
"""Before the first frame."""


def frames_of(duration_s: float, dt_s: float) -> int:
    """Number of frames nearest to a duration; at least 1."""
    return max(1, round(duration_s / dt_s))


def fall_frames(dt_s: float) -> int:
    """Number of frames over which the curvature of the pelvis's height is fitted."""
    return max(4, frames_of(FALL_WINDOW_S, dt_s) + 1)


@lru_cache(maxsize=8)
def _curvature(frames: int) -> Array:
    """(n,) weights that give the second derivative of a fitted parabola, per squared frame."""
    steps = np.arange(frames) - 0.5 * (frames - 1)
    return np.asarray(2.0 * np.linalg.pinv(np.vander(steps, 3))[0])
