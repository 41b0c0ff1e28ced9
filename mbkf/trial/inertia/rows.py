"""Both sides of Newton's law over a trial, linear in the inertial parameters of the segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.inertial_regressor import PER_OWN, PER_SEGMENT, InertialRegressor
from mbkf.numerics.correlated_regression import Series
from mbkf.numerics.runs import stretches
from mbkf.numerics.windows import slopes
from mbkf.sensors.supports.momentum import LEAST_WINDOW
from mbkf.trial.checks.evidence import WINDOW_S, Evidence
from mbkf.trial.inertia.prior import PLACE
from mbkf.trial.preparation.markers_alone import Motion

STEP_S = 0.5 * WINDOW_S
"""Time between the samples that count: windows that overlap by half."""


@dataclass(frozen=True)
class TrialRows:
    """Samples of a trial: force N and moment N m about the centre of mass by the table, world axes.

    Attributes:
        asked: (N, 6, 10 S) load required by the motion besides weight, by the segments' parameters.
        given: (N, 6) load on the plates.
        follows: (N,) whether a sample is one step after the one before it.
    """

    asked: Array
    given: Array
    follows: BoolArray

    def series(self, regressor: InertialRegressor, about: Array, trial: int) -> Series:
        """The samples by the segments' differences from the table, and by the plates' places (4 S + 2 K).

        Args:
            regressor: The body by the table.
            about: (4 S + 2 K,) where masses times shifts are taken to be linear.
            trial: Which of the K trials this is.
        """
        own = PER_OWN * len(regressor.names)
        parameters, slope = regressor.own(about[:own])
        by_own = self.asked @ slope
        design = np.zeros((*self.given.shape, len(about)))
        design[..., :own] = by_own
        first = own + PLACE * trial
        design[..., first : first + PLACE] = self._place()
        return Series(design, self.given - self.asked @ parameters + by_own @ about[:own], self.follows)

    def _place(self) -> Array:
        """(N, 6, 2) less the moment that plates give more when they lie 1 m further forward or left."""
        force, found = self.given[:, :3], np.zeros((len(self.given), 6, PLACE))
        for k, axis in enumerate(np.eye(3)[:PLACE]):
            found[:, 3:, k] = -np.cross(axis, force)
        return found

    def part(self, frames: slice) -> TrialRows:
        """Some of the samples."""
        follows = self.follows[frames].copy()
        follows[:1] = False
        return TrialRows(self.asked[frames], self.given[frames], follows)


def trial_rows(regressor: InertialRegressor, motion: Motion, evidence: Evidence, use: BoolArray) -> TrialRows:
    """The samples of a trial.

    Momentum, less the impulses of weight and plates, passes the slope of parabolas over a window, as in
    :mod:`mbkf.sensors.supports.momentum`, so that no acceleration is needed and both sides are smoothed alike.

    Args:
        regressor: The body by the table.
        motion: Motion of markers alone.
        evidence: Plates against the motion.
        use: (T,) frames whose windows hold no other load than the plates'.
    """
    rate = evidence.rate_hz
    window = max(2 * round(0.5 * WINDOW_S * rate) + 1, LEAST_WINDOW)
    every = max(1, round(STEP_S * rate))
    asked, given, follows = [], [], []
    known = ~np.isnan(motion.q).any(axis=1) & ~np.isnan(evidence.raw).any(axis=(1, 2))
    for run in stretches(np.asarray(known)):
        if len(run) < window or not use[run].any():
            continue
        momentum = np.array([regressor.momentum(motion.q[t], motion.v[t]) for t in run])
        weight = np.array([regressor.weight(motion.q[t]) for t in run])
        load = evidence.raw[run].sum(axis=1)
        both = np.concatenate([momentum - _impulse(weight, rate), _impulse(load, rate)[..., None]], axis=2)
        slope = slopes(both.reshape(len(run), -1), window, 1.0 / rate).reshape(both.shape)
        slope[:, 3:] -= np.cross(evidence.centre_m[run][:, None], slope[:, :3], axisb=1, axisc=1)
        picked = np.arange(window // 2, len(run) - window // 2, every)
        good = use[run][picked]
        follows.append(np.append(False, good[1:] & good[:-1])[good])
        asked.append(slope[picked[good], :, :-1])
        given.append(slope[picked[good], :, -1])
    if not asked:
        size = len(regressor.names) * PER_SEGMENT
        return TrialRows(np.zeros((0, 6, size)), np.zeros((0, 6)), np.zeros(0, dtype=bool))
    return TrialRows(np.concatenate(asked), np.concatenate(given), np.concatenate(follows))


def _impulse(load: Array, rate_hz: float) -> Array:
    """Integral of a load over time, from the first sample on."""
    return np.asarray((np.cumsum(load, axis=0) - 0.5 * load) / rate_hz)
