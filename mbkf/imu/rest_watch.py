"""Rests of a foot recognised at once: the statistic of :mod:`mbkf.imu.zero_velocity` over the readings until now."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.imu.zero_velocity import StillnessSettings


class RestWatch:
    """Follows one foot's sensor, sample by sample.

    The window ends with the newest sample instead of lying about it, so that a rest is recognised up to a window
    later than in a recording. Its end shows at once: the newest sample alone has to be below the threshold, too.
    """

    def __init__(self, rate_hz: float, settings: StillnessSettings) -> None:
        """Args: the sensor's rate, and when a foot is at rest."""
        size = max(3, round(settings.window_s * rate_hz)) | 1
        self._settings = settings
        self._force: deque[Array] = deque(maxlen=size)
        self._unrest: deque[float] = deque(maxlen=size)

    def push(self, angular_velocity_rad_s: Array, specific_force_mps2: Array) -> bool:
        """Takes the next sample, each (3,) in sensor axes; whether the foot rests. After a missing one it moves."""
        s = self._settings
        if not (np.isfinite(specific_force_mps2).all() and np.isfinite(angular_velocity_rad_s).all()):
            self._force.clear()
            self._unrest.clear()
            return False
        self._force.append(specific_force_mps2)
        mean = np.mean(self._force, axis=0)
        gravity = GRAVITY_M_S2 * mean / max(float(np.linalg.norm(mean)), 1e-9)
        off = float(((specific_force_mps2 - gravity) ** 2).sum()) / s.acceleration_m_s2**2
        turning = float((angular_velocity_rad_s**2).sum()) / s.angular_rate_rad_s**2
        self._unrest.append(off + turning)
        full = len(self._unrest) == self._unrest.maxlen
        mean_unrest = sum(self._unrest) / len(self._unrest)
        return full and max(mean_unrest, self._unrest[-1]) < s.threshold


class FeetAtRest:
    """Which feet rest, by their own sensors, frame by frame."""

    def __init__(
        self,
        feet: Sequence[str],
        segments: Sequence[str],
        rate_hz: float,
        settings: StillnessSettings,
    ) -> None:
        """Prepares it.

        Args:
            feet: Names of the right and the left foot's segment.
            segments: (S,) segments that carry sensors.
            rate_hz: Frame rate.
            settings: When a foot rests.
        """
        self._feet = [
            (foot, segments.index(name), RestWatch(rate_hz, settings))
            for foot, name in enumerate(feet)
            if name in segments
        ]

    def push(self, imus: Array | None) -> Array:
        """(2,) 1 where the right, the left foot rests, in the next frame (S, 6); None: a lost frame."""
        found = np.zeros(2)
        for foot, k, watch in self._feet:
            one = np.full(6, np.nan) if imus is None else imus[k]
            found[foot] = watch.push(one[:3], one[3:])
        return found
