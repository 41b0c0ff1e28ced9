"""Newton's law for the whole body over windows of time, from the stated positions and the stated contacts alone.

Over a window of duration W the mean force that acts besides weight and contacts is

    f = m (ċ(t + W/2) − ċ(t − W/2)) / W − mean(Σ F + m g),

c the centre of mass, F the forces of the contacts. ċ is the slope of the parabola that fits c less the double integral
of (Σ F / m + g) best over :data:`SLOPE_S` (Savitzky and Golay 1964), so that motion and contacts are smoothed alike. f
is linear in positions and forces: one row of weights for each, that a trial is correlated with and a stream multiplied
by. Velocities and accelerations of a filter do not enter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.model.body import Body
from mbkf.numerics.runs import runs
from mbkf.numerics.windows import bridged

GRAVITY = np.array([0.0, 0.0, -GRAVITY_M_S2])
"""Acceleration of a free fall, m/s²."""

SLOPE_S = 0.1
"""Duration over which a velocity is taken from positions."""


BRIDGE_S = 0.1
"""Shorter gaps between judged frames are judged, too: a foot that lands or leaves seems to stand beside its plate."""


@dataclass(frozen=True)
class Window:
    """Weights of the frames of a window.

    Attributes:
        by_position: (L,) of positions: their sum with weights is the mean acceleration, in units of the positions / s².
        by_force: (L,) of forces at the same frames: their sum with weights is the mean force that belongs to it.
    """

    by_position: Array
    by_force: Array

    @classmethod
    def of(cls, duration_s: float, rate_hz: float) -> Window:
        """The weights.

        Args:
            duration_s: Duration W between the two velocities.
            rate_hz: Frame rate.
        """
        apart, half = max(round(duration_s * rate_hz), 1), max(round(0.5 * SLOPE_S * rate_hz), 1)
        steps = np.arange(-half, half + 1)
        slope = steps / (steps @ steps) * rate_hz
        by_position = np.zeros(apart + len(slope))
        by_position[apart:] += slope
        by_position[: len(slope)] -= slope
        by_position *= rate_hz / apart
        # A sum of second differences of positions by the same weights: sum twice from the end.
        twice = np.cumsum(np.cumsum(by_position[::-1]))[::-1]
        return cls(by_position, np.append(twice[1:], 0.0) / rate_hz**2)

    def __len__(self) -> int:
        """Number of frames L."""
        return len(self.by_position)


@dataclass(frozen=True)
class Means:
    """Both sides of Newton's law over every window of one duration; n windows, the k-th begins at frame k.

    Attributes:
        frames: Frames of a window.
        required: (n, 3) acceleration that the positions show, less that of gravity, m/s².
        feet: (n, 2, 3) mean force on right and left foot, N.
        others: (n, 3) mean force on other parts, N.
        judged: (n,) windows in which every contact is known.
    """

    frames: int
    required: Array
    feet: Array
    others: Array
    judged: BoolArray

    def missing(self, mass_kg: float) -> Array:
        """(n, 3) mean force that acts besides weight and contacts, N; NaN in windows that are not judged."""
        lacking = mass_kg * self.required - self.feet.sum(axis=1) - self.others
        return np.where(self.judged[:, None], lacking, np.nan)


@dataclass(frozen=True)
class LoadBalance:
    """Positions and contacts of a trial.

    Attributes:
        rate_hz: Frame rate.
        mass_kg: Mass that the body was given.
        centre_m: (T, 3) centre of mass; any number where it is not judged.
        feet_n: (T, 2, 3) force on right and left foot.
        others_n: (T, 3) force on other parts.
        judged: (T,) frames in which positions and every contact are known from readings.
    """

    rate_hz: float
    mass_kg: float
    centre_m: Array
    feet_n: Array
    others_n: Array
    judged: BoolArray

    @classmethod
    def of(
        cls, model: Body, q: Array, rate_hz: float, feet_n: Array, others_n: Array, judged: BoolArray
    ) -> LoadBalance:
        """Of a motion.

        Args:
            model: The body.
            q: (T, nq) configurations, NaN where untracked.
            rate_hz: Frame rate.
            feet_n: (T, 2, 3) forces on the feet, NaN where not known.
            others_n: (T, 3) sum of the forces on other parts.
            judged: (T,) frames in which every contact is known from readings.
        """
        tracked = ~np.isnan(q).any(axis=1) & ~np.isnan(feet_n).any(axis=(1, 2))
        known = np.asarray(bridged(judged & tracked, round(0.5 * BRIDGE_S * rate_hz)) & tracked)
        return cls(
            rate_hz,
            model.mass_kg,
            centres_of_mass(model, q, known),
            np.where(known[:, None, None], feet_n, 0.0),
            np.where(known[:, None], others_n, 0.0),
            known,
        )

    @property
    def weight_n(self) -> float:
        """Weight of the body."""
        return self.mass_kg * GRAVITY_M_S2

    @cached_property
    def stretches(self) -> Sequence[tuple[int, int]]:
        """First judged frame of each stretch, and the frame after its last."""
        return runs(self.judged)

    def means(self, duration_s: float) -> Means:
        """Both sides over every window of a duration."""
        window = Window.of(duration_s, self.rate_hz)
        length, frames = len(window), len(self.judged)
        count = max(frames - length + 1, 0)
        judged = np.zeros(count, dtype=bool)
        for first, after in self.stretches:
            judged[first : max(after - length + 1, first)] = True
        if not judged.any():
            none = np.zeros((count, 3))
            return Means(length, none, np.zeros((count, 2, 3)), none, judged)
        feet = self.feet_n.reshape(frames, 6)
        return Means(
            length,
            _along(self.centre_m, window.by_position) - GRAVITY,
            _along(feet, window.by_force).reshape(count, 2, 3),
            _along(self.others_n, window.by_force),
            judged,
        )

    def course(self, means: Means, values: Array) -> Array:
        """(T, 3) values of windows (n, 3) at their middle frames; the first and last of a stretch reach to its ends.

        NaN in frames that are not judged and in stretches shorter than a window.
        """
        found = np.full((len(self.judged), 3), np.nan)
        for first, after in self.stretches:
            if after - first >= means.frames:
                middle = np.arange(first, after) - means.frames // 2
                found[first:after] = values[np.clip(middle, first, after - means.frames)]
        return found

    def covered(self, windows: BoolArray, frames: int) -> BoolArray:
        """(T,) frames that lie in any of the windows (n,) of so many frames."""
        found = np.zeros(len(self.judged), dtype=bool)
        for first, after in runs(windows):
            found[first : after + frames - 1] = True
        return found


def centres_of_mass(model: Body, q: Array, known: BoolArray) -> Array:
    """(T, 3) centres of mass.

    Args:
        model: The body.
        q: (T, nq) configurations.
        known: (T,) frames that are asked for; others are 0.
    """
    centre, found = CentreOfMass(model), np.zeros((len(q), 3))
    for t in np.flatnonzero(known):
        found[t] = centre.at(q[t])
    return found


class CentreOfMass:
    """The centre of mass of a body, one configuration after another; making it costs as much as sixty of them."""

    def __init__(self, model: Body) -> None:
        """Args: the body."""
        self._model, self._tree = model.pin_model, model.tree

    @cached_property
    def _data(self) -> pin.Data:
        """Pinocchio's working memory, made where no compiled kernel does the work."""
        return pin.Data(self._model)

    def at(self, q: Array) -> Array:
        """(3,) centre of mass at a configuration q (nq,), m."""
        if self._tree is not None:
            return self._tree.centre_of_mass(q)
        return np.array(pin.centerOfMass(self._model, self._data, q))


def _along(series: Array, weights: Array) -> Array:
    """(n, C) sums of the frames of each window of series (T, C), with weights."""
    return np.array([np.correlate(column, weights, "valid") for column in series.T]).T
