"""Log-likelihood of a trial's innovations under a filter's settings, frame by frame.

So that settings are compared on the same readings, a marker that the gate refuses is not left out but counts as an
outlier that may lie anywhere in a cubic metre.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Recording
from mbkf.filters.filter import Filter, Step
from mbkf.filters.plant import StateT
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.numerics.likelihood import LogLikelihood, log_likelihood

OUTLIER = 0.0
"""Log density of an outlier's coordinate, uniform over a metre."""


@dataclass(frozen=True)
class TrialLikelihood:
    """Log-likelihood of a trial's innovations, nats.

    Attributes:
        markers: (T,) of all markers seen; those refused, or seen before the filter runs, count as outliers.
        loads: (T,) of plates and Newton's law given the markers.
        marker_readings, load_readings: (T,) numbers read; of loads, those that the filter used.
        followed: (T,) frames of which the filter has an estimate.
    """

    markers: Array
    loads: Array
    marker_readings: Array
    load_readings: Array
    followed: BoolArray

    @property
    def first(self) -> int:
        """Frame in which the filter started, T where it never did."""
        return int(np.argmax(self.followed)) if self.followed.any() else len(self.followed)


def trial_likelihood(
    filter: TrackingFilter, recording: Recording, progress: Callable[[int, int], None] | None = None
) -> TrialLikelihood:
    """Runs a filter over a trial for its likelihood.

    Args:
        filter: The filter.
        recording: Readings of the instruments.
        progress: Called with frames done and frames in all.

    Raises:
        LinAlgError: The filter diverged so far that its covariance is not positive.
    """
    seen: BoolArray = np.asarray(~np.isnan(recording.markers_m).any(axis=2))
    frames = len(seen)
    markers, loads = OUTLIER * 3.0 * seen.sum(axis=1), np.zeros(frames)
    load_readings, known = np.zeros(frames, dtype=int), np.zeros(frames, dtype=bool)
    for t, estimate, _ in followed(TrackingLoop(filter), recording):
        known[t], step = True, estimate.record.step
        if not estimate.started and step is not None:
            found, load_readings[t] = step_likelihood(filter.kalman, step)
            outliers = 3.0 * np.count_nonzero(estimate.refused)
            markers[t], loads[t] = found.readings + OUTLIER * outliers, found.rows
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    return TrialLikelihood(markers, loads, 3 * seen.sum(axis=1), load_readings, known)


def step_likelihood(kalman: Filter[StateT], step: Step[StateT]) -> tuple[LogLikelihood, int]:
    """Of instruments and laws in one step, priors left out, and how many of them are rows.

    Args:
        kalman: The filter.
        step: A step of it.

    Raises:
        LinAlgError: The prior covariance is not finite or not positive.
    """
    compressed, others = 0.0, 0.0
    for block, decision, rows in zip(kalman.blocks, step.decisions.blocks, step.readings.parts, strict=True):
        if any(one.readings for one in rows):
            others += block.log_noise(decision)
        else:
            compressed += block.log_noise(decision)
    (rows_counted, values), known = step.readings.counted, step.readings.instruments
    P = step.prior.state.P
    if not len(values):
        return log_likelihood(P, known, compressed), 0
    return log_likelihood(P, known, compressed, rows_counted, values, others), len(values)
