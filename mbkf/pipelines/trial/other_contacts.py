"""Before a trial is filtered: which parts of the body bear load besides the feet, from its markers and plates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Recording, TrackingFilter
from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.tracking_loop import followed
from mbkf.pipelines.trial.filters import FilterInputs, tracking_filter
from mbkf.sensors.contact.offline import assign_feet
from mbkf.sensors.supports.block import BEARING
from mbkf.sensors.supports.search import other_contacts


def with_other_contacts(
    inputs: FilterInputs,
    recording: Recording,
    times_s: Array,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[FilterInputs, Recording]:
    """Inputs and readings that know which parts bear besides the feet; unchanged where none does.

    The motion comes from the kinematic filter, smoothed, which knows markers alone.

    Args:
        inputs: What filters are built from.
        recording: What the instruments read.
        times_s: (T,) times of the frames.
        progress: Called with frames done and frames in all.
    """
    if not inputs.sensor.model.description.bearings:
        return inputs, recording
    q, v = _motion(tracking_filter("kinematic", inputs), recording, progress)
    model, rate_hz = inputs.sensor.model, 1.0 / inputs.dt_s
    loads = assign_feet(model, q, times_s, rate_hz, inputs.plates)
    plates = recording.plates
    read = np.full(len(plates), plates.shape[1] > 0) & ~np.isnan(plates).any(axis=(1, 2))
    found = other_contacts(model, q, v, rate_hz, loads, read)
    inputs = replace(inputs, remarks=(*inputs.remarks, *found.remarks))
    if not found.flags.any():
        return inputs, recording
    readings = {**recording.readings, BEARING: found.flags.astype(float)}
    return replace(inputs, other_contacts=True), replace(recording, readings=readings)


def _motion(
    filter: TrackingFilter, recording: Recording, progress: Callable[[int, int], None] | None
) -> tuple[Array, Array]:
    """(T, nq) configurations and (T, nv) velocities by a filter and its smoother, NaN where it is not started."""
    frames = len(recording)
    q, v = np.full((frames, filter.model.nq), np.nan), np.full((frames, filter.model.nv), np.nan)

    def keep(found: Sequence[tuple[int, Posterior]]) -> None:
        for t, posterior in found:
            q[t], v[t] = posterior.q, posterior.v

    smoother = FixedLagSmoother(filter, recording, SmoothingSettings())
    for t, fresh, _ in followed(filter, recording):
        keep(smoother.push(t, fresh))
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    keep(smoother.finish())
    return q, v
