"""A whole trial through a filter: start, steps, restart after a loss, smoothing on request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotObservable
from mbkf.filters.estimate import Estimate, Follower, Recording
from mbkf.filters.following import followed
from mbkf.filters.stretches import SmoothingSettings, StretchSmoother


@dataclass(frozen=True)
class Track:
    """A followed trial; frames before the first fitted pose are NaN.

    Attributes:
        q: (T, nq) configurations.
        v, a: (T, nv) velocities and accelerations.
        wrench: (T, 2, 6) estimated wrenches on right and left foot about the world's origin; NaN where the filter
            estimates none.
        wrench_sd: (T, 2, 6) their standard deviations.
        contact: (T, 2) what the feet stand on (``mbkf.sensors.contact.records.Contact``); None where not decided.
        position_sd, velocity_sd: (T, nv) standard deviations in the tangent space.
        angle_sd, rate_sd: (T, A) of the clinical coordinates and their rates.
        torque_sd: (T, nv) of generalised forces; NaN where not known.
        foot_height_sd: (T, 2) of the height of right and left foot, m.
        refused: (T, M) markers seen but not believed.
        tracked: (T,) whether enough markers were believed.
        nis: (T,) normalised innovation squared; NaN at a start.
        readings: (T,) numbers in it.
        step_seconds: (T,) computing time of each step.
        starts: Frames at which the filter was started or restarted.
        smoothed: Whether later frames were used.
        covariance: (T, 2 nv, 2 nv) full covariances, or None.
    """

    q: Array
    v: Array
    a: Array
    wrench: Array
    wrench_sd: Array
    contact: Array | None
    position_sd: Array
    velocity_sd: Array
    angle_sd: Array
    rate_sd: Array
    torque_sd: Array
    foot_height_sd: Array
    refused: BoolArray
    tracked: BoolArray
    nis: Array
    readings: Array
    step_seconds: Array
    starts: tuple[int, ...]
    smoothed: bool
    covariance: Array | None


def track(
    follower: Follower,
    recording: Recording,
    *,
    smoothing: SmoothingSettings | None = None,
    keep_covariance: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Track:
    """Runs the filter over all frames.

    Args:
        follower: The filter.
        recording: What the instruments read.
        smoothing: How to smooth; None for the filter alone.
        keep_covariance: Whether to keep the full covariance of (q, v) of every frame.
        progress: Called with frames done and frames in all.

    Raises:
        NotObservable: In no frame do the markers fit the body.
    """
    record = _Recorder(follower, recording, keep_covariance)
    frames = len(recording)
    smoother = None if smoothing is None else StretchSmoother(follower, recording, smoothing)
    for t, fresh, seconds in followed(follower, recording):
        record.step(t, fresh, seconds)
        if smoother is None:
            record.estimate(t, fresh)
        else:
            record.estimates(smoother.push(t, fresh))
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    if not record.starts:
        raise NotObservable(
            "in no frame do the markers fit the scaled body; is this the subject's protocol, "
            "and are unit and axes right (--unit, --up)?"
        )
    if smoother is not None:
        record.estimates(smoother.finish())
    return record.track(smoothed=smoother is not None)


class _Recorder:
    """Fills the arrays of a track, frame by frame."""

    def __init__(self, follower: Follower, recording: Recording, keep_covariance: bool) -> None:
        self._follower = follower
        model, frames = follower.model, len(recording)
        self.starts: list[int] = []
        self._arrays: dict[str, np.ndarray] = {
            name: np.full((frames, *width), np.nan)
            for name, width in {
                "q": (model.nq,),
                "v": (model.nv,),
                "a": (model.nv,),
                "wrench": (2, 6),
                "wrench_sd": (2, 6),
                "nis": (),
                "step_seconds": (),
            }.items()
        }
        self._contact: np.ndarray | None = None
        self._arrays["refused"] = np.zeros((frames, recording.markers_m.shape[1]), dtype=bool)
        self._arrays["tracked"] = np.zeros(frames, dtype=bool)
        self._arrays["readings"] = np.zeros(frames, dtype=int)
        self._frames = frames
        size = 2 * model.nv
        self._covariance = np.full((frames, size, size), np.nan) if keep_covariance else None

    def step(self, t: int, estimate: Estimate, seconds: float) -> None:
        """What the filter did in a frame."""
        if estimate.started:
            self.starts.append(t)
        self._arrays["step_seconds"][t] = seconds
        self._arrays["refused"][t] = estimate.refused
        self._arrays["tracked"][t] = estimate.tracked
        self._arrays["nis"][t], self._arrays["readings"][t] = self._follower.innovation(estimate)
        if estimate.contact is not None:
            if self._contact is None:
                self._contact = np.zeros((self._frames, 2), dtype=int)
            self._contact[t] = estimate.contact

    def estimates(self, found: list[tuple[int, Estimate]]) -> None:
        """Estimates of several frames."""
        for t, estimate in found:
            self.estimate(t, estimate)

    def estimate(self, t: int, estimate: Estimate) -> None:
        """The estimate of a frame and its standard deviations."""
        for name in ("q", "v", "a", "wrench"):
            self._arrays[name][t] = getattr(estimate, name)
        self._arrays["wrench_sd"][t] = self._follower.wrench_sd(estimate)
        spread = self._follower.spread(estimate)
        for name in ("position", "velocity", "angle", "rate", "torque", "foot_height"):
            key, value = f"{name}_sd", getattr(spread, name)
            if key not in self._arrays:
                self._arrays[key] = np.full((self._frames, *value.shape), np.nan)
            self._arrays[key][t] = value
        if self._covariance is not None:
            self._covariance[t] = self._follower.covariance(estimate)

    def track(self, smoothed: bool) -> Track:
        """What was recorded."""
        return Track(
            **self._arrays,
            contact=self._contact,
            starts=tuple(self.starts),
            smoothed=smoothed,
            covariance=self._covariance,
        )
