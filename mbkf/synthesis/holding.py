"""Keeps a part of the body on its support: changes of height and lean, found in rounds, that bring it to its place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

from mbkf.conventions import Array
from mbkf.synthesis.bands import BandedCholesky, spline_rows
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import Pose

KNOT_S, DEGREE = 0.06, 5
CALM = 1e-8
"""Weight of the squared third derivative (unit per s³) against squared errors, one per sample."""


@dataclass(frozen=True)
class Hold:
    """A part that stays in place, and the quantities that may change for it.

    Attributes:
        missed: (T,) times in s and the pose to (T, 2): how far ahead of its place and how far too high the part is, m.
        weight: (T,) times in s to 1 where it must be in place, 0 where anything goes; in ``free``, 0 as well.
        free: (T,) times in s to 1 where nothing may change.
        lean: Change of joint angles (x, y, z) per radian of lean, by joint; no lean at all when empty.
        metres_per_rad: How far a radian of lean moves the centre of mass ahead of the part.
    """

    missed: Callable[[Array, Pose], Array]
    weight: Callable[[Array], Array]
    free: Callable[[Array], Array]
    lean: Mapping[str, tuple[float, float, float]]
    metres_per_rad: float = 0.2


class Correction:
    """A smooth change over time, (T, 2): of lean in rad and of height in m."""

    def __init__(self, hold: Hold, times: Array) -> None:
        """No change at first.

        Args:
            hold: The part that stays in place.
            times: (T,) times at which it is looked at, s.
        """
        inner = np.linspace(times[0], times[-1], max(4, round((times[-1] - times[0]) / KNOT_S) + 1))
        self.hold, self.times = hold, times
        self.knots = np.r_[[times[0]] * DEGREE, inner, [times[-1]] * DEGREE]
        self.coefficients = np.zeros((len(self.knots) - DEGREE - 1, 2))
        self._rows = spline_rows(self.knots, DEGREE, times, 0)
        self._weight = hold.weight(times)
        jerk = spline_rows(self.knots, DEGREE, times, 3)
        fixed = sparse.diags_array(self._weight + hold.free(times))
        self._normal = BandedCholesky(
            self._rows.T @ (fixed @ self._rows)
            + CALM * (jerk.T @ jerk)
            + 1e-12 * sparse.eye_array(len(self.coefficients))
        )

    def __call__(self, times: Array) -> Dual:
        """The change (T, 2) with its derivatives."""
        spline = BSpline(self.knots, self.coefficients, DEGREE)
        inside = np.clip(times, self.times[0], self.times[-1])
        return Dual(*(spline(inside, nu=order) for order in range(3)))

    def improve(self, pose: Pose) -> float:
        """Changes lean and height by the miss of the pose; returns the greatest miss in m."""
        missed = self.hold.missed(self.times, pose)
        gain = [0.7 / self.hold.metres_per_rad if self.hold.lean else 0.0, -1.0]
        wanted = self._rows @ self.coefficients + missed * gain
        self.coefficients = self._normal.solve(self._rows.T @ (self._weight[:, None] * wanted))
        return float(np.abs(missed[self._weight > 0.5]).max())
