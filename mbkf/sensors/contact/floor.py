"""The floor's own motion, and whether the body falls: what the last second of movement tells of both, causally.

On a belt a loaded sole moves, at the speed of the belt, and the pelvis does not go along. The floor's velocity is the
median velocity of the lowest point of heels and balls while that is near the floor; a floor that stands still, as on
the ground, is the default until there is enough evidence. What goes along with the pelvis glides or is carried, and
its floor stands still.

A filter that takes both feet to be in the air makes the body fall by Newton's law, and must not take that acceleration
for proof: the height of the pelvis, which markers show, then has to fall, too.
"""

from __future__ import annotations

from functools import lru_cache
from math import hypot
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.running_median import RunningMedian
from mbkf.sensors.contact.thresholds import (
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
        airborne: For how many frames both feet have been held to be in the air.
    """

    low_m_s: tuple[RunningMedian, RunningMedian] = (RunningMedian(), RunningMedian())
    pelvis_m: tuple[tuple[float, float, float], ...] = ()
    airborne: int = 0

    def with_frame(
        self, low_m_s: tuple[float, float], pelvis_m: tuple[float, float, float], dt_s: float
    ) -> Movement:
        """One frame more, and the oldest one forgotten.

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
        """Horizontal velocity of the floor; zero unless a belt is evident.

        Args:
            dt_s: Time between frames.
        """
        still = frames_of(STILL_FLOOR_S, dt_s)
        x, y = (low.median(still) for low in self.low_m_s)
        speed = hypot(x, y)
        if speed < BELT_FROM_M_S:
            return 0.0, 0.0
        (x0, y0, _), (x1, y1, _), lasted_s = self.pelvis_m[0], self.pelvis_m[-1], len(self.pelvis_m) * dt_s
        goes_along = hypot((x1 - x0) / lasted_s - x, (y1 - y0) / lasted_s - y) < 0.5 * speed
        return (0.0, 0.0) if goes_along else (x, y)

    def held_up(self, dt_s: float) -> bool:
        """Whether a body whose feet are both held to be in the air was seen not to fall.

        Its pelvis's height, over a window that lies within that time, does not curve down.

        Args:
            dt_s: Time between frames.
        """
        frames = fall_frames(dt_s)
        if self.airborne < frames:
            return False
        heights = np.array(self.pelvis_m[-frames:])[:, 2]
        return float(_curvature(frames) @ heights) / dt_s**2 > FALL_M_S2


NO_MOVEMENT = Movement()
"""Before the first frame."""


def frames_of(duration_s: float, dt_s: float) -> int:
    """How many frames, one at least, are nearest to a duration."""
    return max(1, round(duration_s / dt_s))


def fall_frames(dt_s: float) -> int:
    """Over how many frames a fall shows in the pelvis's height."""
    return max(4, frames_of(FALL_WINDOW_S, dt_s) + 1)


@lru_cache(maxsize=8)
def _curvature(frames: int) -> Array:
    """(n,) weights that give the second derivative of a fitted parabola, per squared frame."""
    steps = np.arange(frames) - 0.5 * (frames - 1)
    return np.asarray(2.0 * np.linalg.pinv(np.vander(steps, 3))[0])
