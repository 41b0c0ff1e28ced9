"""A trial's motion by its markers alone, before plates and Newton's law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.io.paged import PagedArray
from mbkf.trial.preparation.filters import FilterInputs, motion_filter


class Motion(NamedTuple):
    """A trial's motion: (T, nq) configurations and (T, nv) velocities, NaN where it is not tracked."""

    q: Array
    v: Array


def markers_alone(
    inputs: FilterInputs, recording: Recording, progress: Callable[[int, int], None] | None = None
) -> Motion:
    """The motion by the kinematic filter, smoothed.

    Args:
        inputs: Inputs of the filters.
        recording: Readings of the instruments.
        progress: Called with frames done and frames in all.
    """
    frames, model = len(recording), inputs.sensor.model
    found = Motion(np.full((frames, model.nq), np.nan), np.full((frames, model.nv), np.nan))
    fill_motion(found.q, found.v, inputs, recording, progress)
    return found


def fill_motion(
    q: Array | PagedArray,
    v: Array | PagedArray,
    inputs: FilterInputs,
    recording: Recording,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """As :func:`markers_alone`, into arrays that may lie in files.

    Args:
        q: (T, nq) receives the configurations.
        v: (T, nv) receives the velocities.
        inputs: Inputs of the filters.
        recording: Readings of the instruments; its arrays may lie in files, too.
        progress: Called with frames done and frames in all.
    """
    filter, frames = motion_filter(inputs), len(recording)

    def keep(found: Sequence[tuple[int, Posterior]]) -> None:
        for t, posterior in found:
            q[t], v[t] = posterior.q, posterior.v

    smoother = FixedLagSmoother(filter, SmoothingSettings())
    for t, fresh, _ in followed(TrackingLoop(filter), recording, lambda: smoother.earliest):
        keep(smoother.push(t, fresh))
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    keep(smoother.finish())
