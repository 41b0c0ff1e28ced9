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
        frames: (n, 5) of each, the latest last: horizontal velocity x and y of the lowest sole point while it was near
            the floor, NaN else; and the pelvis, x, y, z. Never written into.
        slow: In how many of them the lowest sole point was slower than any belt.
        airborne: For how many frames both feet have been held to be in the air.
    """

    frames: Array = np.zeros((0, 5))
    slow: int = 0
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
        kept = min(len(self.frames), _frames(BELT_WINDOW_S, dt_s) - 1)
        frames = np.empty((kept + 1, 5))
        frames[:kept] = self.frames[len(self.frames) - kept :]
        frames[kept] = *low_m_s, *pelvis_m
        slow = self.slow + _is_slow(*low_m_s)
        for x, y in self.frames[: len(self.frames) - kept, :2].tolist():
            slow -= _is_slow(x, y)
        return Movement(frames, slow, self.airborne)

    def floor_m_s(self, dt_s: float) -> tuple[float, float]:
        """Horizontal velocity of the floor; zero unless a belt is evident.

        Args:
            dt_s: Time between frames.
        """
        still, low = _frames(STILL_FLOOR_S, dt_s), self.frames[:, :2]
        # Where most are slow, the medians are, whatever their exact values.
        if 2 * (self.slow + still) > len(low) + still:
            return 0.0, 0.0
        moving = np.concatenate([low[~np.isnan(low[:, 0])], np.zeros((still, 2))])
        x, y = np.median(moving, axis=0).tolist()
        speed = hypot(x, y)
        if speed < BELT_FROM_M_S:
            return 0.0, 0.0
        (x0, y0), (x1, y1) = self.frames[[0, -1], 2:4].tolist()
        lasted_s = len(self.frames) * dt_s
        goes_along = hypot((x1 - x0) / lasted_s - x, (y1 - y0) / lasted_s - y) < 0.5 * speed
        return (0.0, 0.0) if goes_along else (x, y)

    def held_up(self, dt_s: float) -> bool:
        """Whether a body whose feet are both held to be in the air was seen not to fall.

        Its pelvis's height, over a window that lies within that time, does not curve down.

        Args:
            dt_s: Time between frames.
        """
        frames = max(4, _frames(FALL_WINDOW_S, dt_s) + 1)
        if self.airborne < frames:
            return False
        heights = self.frames[-frames:, 4]
        return float(_curvature(frames) @ heights) / dt_s**2 > FALL_M_S2


def _is_slow(x_m_s: float, y_m_s: float) -> bool:
    """Whether a sole point is too slow for a belt in either direction; one that is not near the floor is not."""
    return abs(x_m_s) < _SLOW_M_S and abs(y_m_s) < _SLOW_M_S


_SLOW_M_S = BELT_FROM_M_S * 0.5**0.5
"""Less than this along both axes is less than a belt's least speed."""

NO_MOVEMENT = Movement()
"""Before the first frame."""


def _frames(duration_s: float, dt_s: float) -> int:
    return max(1, round(duration_s / dt_s))


@lru_cache(maxsize=8)
def _curvature(frames: int) -> Array:
    """(n,) weights that give the second derivative of a fitted parabola, per squared frame."""
    steps = np.arange(frames) - 0.5 * (frames - 1)
    return np.asarray(2.0 * np.linalg.pinv(np.vander(steps, 3))[0])
