"""A whole trial through the kinematic filter: start, steps, restart after a loss."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotObservable
from mbkf.filters.kinematic import KinematicFilter, StepResult
from mbkf.filters.spread import SpreadReader
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
        a: (T, nv) accelerations (v_k − v_{k−1}) / Δt (eq. 3.7), of the backward run while a start settles.
        position_sd, velocity_sd: (T, nv) standard deviations in the tangent space.
        angle_sd, rate_sd: (T, A) of the clinical coordinates and their rates.
        torque_sd: (T, nv) of generalised forces, as far as accelerations cause it; NaN at a start.
        foot_height_sd: (T, 2) of the height of right and left foot, m.
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
    frames = len(measured_m)
    record = _Recorder(kalman, frames, measured_m.shape[1], keep_covariance)
    state: FilterState | None = None
    start: _Start | None = None
    lost_for = 0
    for t in range(frames):
        begin = time.perf_counter()
        fresh = None
        if state is None or lost_for * kalman.plant.dt_s > kalman.settings.restart_after_s:
            fresh = _warm_start(kalman, measured_m, t, None if state is None else state.q)
        if fresh is not None:
            start, state, lost_for = fresh, fresh.state, 0
            seconds = time.perf_counter() - begin
            record.start(t, fresh, seconds)
        elif state is not None and start is not None:
            result = kalman.step(state, measured_m[t])
            since = t - record.starts[-1]
            difference = (result.state.v - state.v) / kalman.plant.dt_s
            acceleration = start.accelerations[since] if since < len(start.accelerations) else difference
            state = result.state
            lost_for = 0 if result.tracked else lost_for + 1
            seconds = time.perf_counter() - begin
            record.step(t, result, acceleration, seconds)
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    if not record.starts:
        raise NotObservable(
            "in no frame do the markers fit the scaled body; is this the subject's protocol, "
            "and are unit and axes right (--unit, --up)?"
        )
    return record.track()


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


class _Recorder:
    """Fills the arrays of a track, frame by frame."""

    def __init__(self, kalman: KinematicFilter, frames: int, markers: int, keep_covariance: bool) -> None:
        model = kalman.sensor.model
        self._spread = SpreadReader(model, kalman.plant.dt_s)
        self.starts: list[int] = []
        widths = {
            "q": (model.nq,),
            "v": (model.nv,),
            "a": (model.nv,),
            "position_sd": (model.nv,),
            "velocity_sd": (model.nv,),
            "angle_sd": (self._spread.coordinates,),
            "rate_sd": (self._spread.coordinates,),
            "torque_sd": (model.nv,),
            "foot_height_sd": (2,),
            "nis": (),
            "step_seconds": (),
        }
        self._arrays: dict[str, np.ndarray] = {n: np.full((frames, *w), np.nan) for n, w in widths.items()}
        self._arrays["refused"] = np.zeros((frames, markers), dtype=bool)
        self._arrays["tracked"] = np.zeros(frames, dtype=bool)
        self._arrays["readings"] = np.zeros(frames, dtype=int)
        self._covariance = np.full((frames, 2 * model.nv, 2 * model.nv), np.nan) if keep_covariance else None

    def start(self, t: int, start: _Start, seconds: float) -> None:
        """A frame at which the filter was started."""
        self.starts.append(t)
        self._state(t, start.state, start.accelerations[0], seconds, None)
        self._arrays["tracked"][t] = True

    def step(self, t: int, result: StepResult, acceleration: Array, seconds: float) -> None:
        """A frame the filter stepped to."""
        self._state(t, result.state, acceleration, seconds, result.velocity_step_covariance)
        for name in ("refused", "tracked", "nis", "readings"):
            self._arrays[name][t] = getattr(result, name)

    def _state(
        self, t: int, state: FilterState, acceleration: Array, seconds: float, step_covariance: Array | None
    ) -> None:
        spread = self._spread.at(state, step_covariance)
        values = {"q": state.q, "v": state.v, "a": acceleration, "step_seconds": seconds}
        values |= {f"{name}_sd": value for name, value in vars(spread).items()}
        for name, value in values.items():
            self._arrays[name][t] = value
        if self._covariance is not None:
            self._covariance[t] = state.P

    def track(self) -> Track:
        """What was recorded."""
        return Track(**self._arrays, starts=tuple(self.starts), covariance=self._covariance)
