"""The wrench that a body's motion requires and its plates lack: ṗ − m g − Σ f, and L̇ − Σ n.

Moments are about the centre of mass; p and L are linear and angular momentum (the centroidal momentum: D. E. Orin,
A. Goswami, IROS 2008). The motion is that of markers alone, independent of the plates. Momentum less the plates'
impulse is differentiated, by parabolas over a window (Savitzky and Golay 1964), so that both sides are smoothed alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.numerics.windows import slopes

LEAST_WINDOW = 5
"""Least number of frames in a window."""


@dataclass(frozen=True)
class WholeBody:
    """Momentum of a body in motion; NaN where untracked.

    Attributes:
        centre_m: (T, 3) centre of mass.
        momentum: (T, 6) linear N s and angular N m s about it, world axes.
        weight: (6,) force N of its weight; moment 0.
    """

    centre_m: Array
    momentum: Array
    weight: Array

    @classmethod
    def of(cls, model: Body, q: Array, v: Array) -> WholeBody:
        """Of a motion.

        Args:
            model: The body.
            q: (T, nq) configurations, NaN where untracked.
            v: (T, nv) velocities.
        """
        data = pin.Data(model.pin_model)
        centre, momentum = np.full((len(q), 3), np.nan), np.full((len(q), 6), np.nan)
        for t in np.flatnonzero(~np.isnan(q).any(axis=1)):
            pin.computeCentroidalMomentum(model.pin_model, data, q[t], v[t])
            momentum[t], centre[t] = data.hg.vector, data.com[0]
        gravity = model.mass_kg * np.array(model.pin_model.gravity.linear)
        return cls(centre, momentum, np.concatenate([gravity, np.zeros(3)]))

    def missing_wrench(self, given: Array, rate_hz: float, window_s: float) -> Array:
        """(T, 6) force N and moment N m about the centre of mass that act besides the weight and a given wrench.

        Args:
            given: (T, 6) wrench about the world's origin.
            rate_hz: Frame rate.
            window_s: Duration over which rates are taken.
        """
        found = np.full(self.momentum.shape, np.nan)
        about = given.copy()
        about[:, 3:] -= np.cross(self.centre_m, given[:, :3])
        window = max(2 * round(0.5 * window_s * rate_hz) + 1, LEAST_WINDOW)
        known = np.flatnonzero(~np.isnan(self.momentum).any(axis=1))
        for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1):
            if len(run) >= window:
                force = about[run] + self.weight
                impulse = (np.cumsum(force, axis=0) - 0.5 * force) / rate_hz
                found[run] = slopes(self.momentum[run] - impulse, window, 1.0 / rate_hz)
        return found
