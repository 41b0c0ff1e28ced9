"""A whole trial through the kinematic filter: start, steps, restart after a loss."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotObservable
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.state import FilterState

WARM_UP_S = 0.25
"""Stretch of a trial that is first run through backwards to start with a velocity."""

SETTLING_S = 0.05
"""While a started filter settles, accelerations are those of the backward run."""


@dataclass(frozen=True)
class Track:
    """A followed trial; frames before the first fitted pose are NaN.

    Attributes:
        q: (T, nq) configurations.
        v: (T, nv) velocities.
        a: (T, nv) accelerations (v_k − v_{k−1}) / Δt (eq. 3.7).
        position_covariance: (T, nv, nv) covariance of q.
        velocity_sd: (T, nv).
        velocity_step_covariance: (T, nv, nv) covariance of v_k − v_{k−1}; NaN at a start.
        refused: (T, M) markers seen but not believed.
        tracked: (T,) whether enough markers were believed.
        nis: (T,) normalised innovation squared; NaN at a start.
        readings: (T,) coordinates in it.
        step_seconds: (T,) computing time of each step.
        starts: Frames at which the filter was started or restarted.
        covariance: (T, 2 nv, 2 nv) full covariances, or None.
    """

    q: Array
    v: Array
    a: Array
    position_covariance: Array
    velocity_sd: Array
    velocity_step_covariance: Array
    refused: BoolArray
    tracked: BoolArray
    nis: Array
    readings: Array
    step_seconds: Array
    starts: tuple[int, ...]
    covariance: Array | None


def track(
    kalman: KinematicFilter,
    measured_m: Array,
    *,
    keep_covariance: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Track:
    """Runs the filter over all frames.

    Args:
        kalman: The filter.
        measured_m: (T, M, 3) marker positions, NaN where missing.
        keep_covariance: Whether to keep the full covariance of every frame.
        progress: Called with frames done and frames in all.

    Raises:
        NotObservable: In no frame do the markers fit the body.
    """
    frames, nv = len(measured_m), kalman.sensor.model.nv
    out = _empty(frames, measured_m.shape[1], kalman, keep_covariance)
    state: FilterState | None = None
    starts: list[int] = []
    lost_for, early = 0, np.zeros((0, nv))
    for t in range(frames):
        begin = time.perf_counter()
        if state is None or lost_for * kalman.plant.dt_s > kalman.settings.restart_after_s:
            fresh = _warm_start(kalman, measured_m, t, None if state is None else state.q)
            if fresh is not None:
                state, lost_for = fresh.state, 0
                starts.append(t)
                early = fresh.accelerations
                out.tracked[t], out.a[t] = True, early[0]
                _store(out, t, state, nv)
                out.step_seconds[t] = time.perf_counter() - begin
                continue
        if state is None:
            continue
        result = kalman.step(state, measured_m[t])
        since = t - starts[-1]
        out.a[t] = early[since] if since < len(early) else (result.state.v - state.v) / kalman.plant.dt_s
        state = result.state
        lost_for = 0 if result.tracked else lost_for + 1
        out.refused[t], out.tracked[t] = result.refused, result.tracked
        out.nis[t], out.readings[t] = result.nis, result.readings
        out.velocity_step_covariance[t] = result.velocity_step_covariance
        _store(out, t, state, nv)
        out.step_seconds[t] = time.perf_counter() - begin
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    if not starts:
        raise NotObservable(
            "in no frame do the markers fit the scaled body; is this the subject's protocol, "
            "and are unit and axes right (--unit, --up)?"
        )
    return Track(**{**out.__dict__, "starts": tuple(starts)})


@dataclass(frozen=True)
class _Start:
    """A first state, and the accelerations (n, nv) of the n frames from it on while the filter settles."""

    state: FilterState
    accelerations: Array


def _warm_start(kalman: KinematicFilter, measured_m: Array, t: int, guess: Array | None) -> _Start | None:
    """A state at frame t that already knows its velocity: the next frames are run through backwards first."""
    dt = kalman.plant.dt_s
    last = min(t + round(WARM_UP_S / dt), len(measured_m) - 1)
    here = kalman.start(measured_m[t], guess)
    state = None if here is None else kalman.start(measured_m[last], here.q)
    if here is None:
        return None
    if state is None or last == t:
        return _Start(here, np.zeros((1, len(here.v))))
    backwards = [state.v]
    for frame in measured_m[t:last][::-1]:
        state = kalman.step(state, frame).state
        backwards.append(state.v)
    accelerations = -np.diff(np.array(backwards)[::-1], axis=0) / dt
    return _Start(state.reversed_in_time(), accelerations[: max(1, round(SETTLING_S / dt))])


def _empty(frames: int, markers: int, kalman: KinematicFilter, keep: bool) -> Track:
    nq, nv = kalman.sensor.model.nq, kalman.sensor.model.nv

    def nan(*shape: int) -> Array:
        return np.full((frames, *shape), np.nan)

    return Track(
        q=nan(nq),
        v=nan(nv),
        a=nan(nv),
        position_covariance=nan(nv, nv),
        velocity_sd=nan(nv),
        velocity_step_covariance=nan(nv, nv),
        refused=np.zeros((frames, markers), dtype=bool),
        tracked=np.zeros(frames, dtype=bool),
        nis=nan(),
        readings=np.zeros(frames, dtype=int),
        step_seconds=nan(),
        starts=(),
        covariance=nan(2 * nv, 2 * nv) if keep else None,
    )


def _store(out: Track, t: int, state: FilterState, nv: int) -> None:
    out.q[t], out.v[t] = state.q, state.v
    out.position_covariance[t] = state.P[:nv, :nv]
    out.velocity_sd[t] = np.sqrt(np.diag(state.P)[nv:])
    if out.covariance is not None:
        out.covariance[t] = state.P
