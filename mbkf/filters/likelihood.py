"""How probable a trial is under a filter's settings: the log-likelihood of its innovations, frame by frame.

So that settings are compared on the same readings, a marker that the gate refuses is not left out but counts as an
outlier that may lie anywhere in a cubic metre.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.filters.dynamic import DynamicFilter
from mbkf.filters.dynamic_follower import DynamicFollower
from mbkf.filters.dynamic_records import DynamicStep
from mbkf.filters.estimate import Estimate, Follower, Recording
from mbkf.filters.following import followed
from mbkf.filters.kinematic_follower import KinematicFollower
from mbkf.numerics.likelihood import LogLikelihood, log_likelihood

OUTLIER = 0.0
"""Log density of an outlier's coordinate, uniform over a metre."""


@dataclass(frozen=True)
class TrialLikelihood:
    """Log-likelihood of a trial's innovations, nats.

    Attributes:
        markers: (T,) of all markers seen; what is refused, or seen before the filter runs, counts as outliers.
        loads: (T,) of plates and Newton's law given the markers.
        marker_readings, load_readings: (T,) numbers read; of loads, those the filter made use of.
        first: Frame in which the filter started, T where it never did.
    """

    markers: Array
    loads: Array
    marker_readings: Array
    load_readings: Array
    first: int


def trial_likelihood(
    follower: Follower, recording: Recording, progress: Callable[[int, int], None] | None = None
) -> TrialLikelihood:
    """Runs a filter over a trial for its likelihood.

    Args:
        follower: A kinematic or dynamic filter.
        recording: What the instruments read.
        progress: Called with frames done and frames in all.

    Raises:
        InvalidInput: It is another filter.
        LinAlgError: It diverged so far that its covariance is none.
    """
    seen: BoolArray = np.asarray(~np.isnan(recording.markers_m).any(axis=2))
    frames = len(seen)
    markers, loads = OUTLIER * 3.0 * seen.sum(axis=1), np.zeros(frames)
    load_readings = np.zeros(frames, dtype=int)
    first = frames
    for t, estimate, _ in followed(follower, recording):
        first = min(first, t)
        if not estimate.started:
            found, load_readings[t] = frame_likelihood(follower, estimate, seen[t])
            outliers = 3.0 * np.count_nonzero(estimate.refused)
            markers[t], loads[t] = found.readings + OUTLIER * outliers, found.rows
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    return TrialLikelihood(markers, loads, 3 * seen.sum(axis=1), load_readings, first)


def frame_likelihood(follower: Follower, estimate: Estimate, seen: BoolArray) -> tuple[LogLikelihood, int]:
    """Of one frame's believed markers, and of its loads and how many numbers those are.

    Args:
        follower: A kinematic or dynamic filter.
        estimate: Its posterior of the frame, not a start.
        seen: (M,) markers seen.

    Raises:
        InvalidInput: It is another filter.
        LinAlgError: The prior covariance is none.
    """
    trusted = seen & ~estimate.refused
    if isinstance(follower, DynamicFollower):
        step: DynamicStep = estimate.inner
        return dynamic_likelihood(follower.kalman, step), step.frame.readings
    if isinstance(follower, KinematicFollower):
        known = estimate.inner.result.evidence
        noise = _log_det(follower.kalman.noise_m[trusted], 3)
        return log_likelihood(known.predicted.P, known.markers, noise), 0
    raise InvalidInput("the likelihood is known of the kinematic and the dynamic filter only")


def dynamic_likelihood(kalman: DynamicFilter, step: DynamicStep) -> LogLikelihood:
    """Of markers, plates and Newton's law in one step; pulls and limits are no readings."""
    decision, frame, s = step.decision, step.frame, kalman.settings
    noise = _log_det(kalman.noise_m[decision.trusted] * decision.noise_scale**0.5, 3)
    law = _log_det(np.array([s.residual_force_n, s.residual_moment_nm]), 3)
    plate = _log_det(np.array([s.plate_force_n, s.plate_moment_nm]), 3)
    count = frame.readings
    rows, values = frame.rows[:count], frame.values[:count]
    return log_likelihood(
        step.predicted.P, frame.markers, noise, rows, values, law + (count - 6) // 6 * plate
    )


def _log_det(sd: Array, times: int) -> float:
    """Log det of a diagonal R in which each standard deviation stands so many times."""
    return 2.0 * times * float(np.log(sd).sum())
