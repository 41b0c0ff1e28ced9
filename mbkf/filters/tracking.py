"""A whole trial through a filter: start, steps, restart after a loss, smoothing on request."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.errors import NotObservable
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.estimate import Posterior, Recording, TrackingFilter
from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.lag import FixedLag
from mbkf.filters.record import UNASKED, FrameRecorder, blank
from mbkf.filters.spread import ASKED
from mbkf.filters.tracking_loop import followed


@dataclass(frozen=True)
class Track:
    """A followed trial; read off its records; frames before the first fitted pose are NaN.

    Attributes:
        q: (T, nq) configurations.
        v, a: (T, nv) velocities and accelerations.
        wrench: (T, 2, 6) estimated wrenches on right and left foot about the world's origin; NaN where the filter
            estimates none.
        wrench_sd: (T, 2, 6) their standard deviations.
        support: (T, B, 6) wrenches on the parts that may bear load besides the feet (``description.bearings``), 0 on
            one that bears none; NaN where the filter does not ask.
        support_sd: (T, B, 6) their standard deviations.
        contact: (T, 2) what the feet stand on (``mbkf.sensors.contact.records.Contact``); None where not decided.
        position_sd, velocity_sd: (T, nv) standard deviations in the tangent space.
        angle_sd, rate_sd: (T, A) of the clinical coordinates, the root's in the world's axes, and their rates.
        ball_covariance: (T, n, 3, 3) covariances of the rotations of joints with three angles, in the axes of their
            distal segments, rad².
        torque_sd: (T, nv) of generalised forces; NaN where not known.
        position_offset, velocity_offset, torque_offset, angle_offset, rate_offset, wrench_offset: The part of each of
            these standard deviations that repeats in the same posture, since the body is not known exactly.
        ball_offset: (T, n, 3, 3) likewise of the covariances.
        foot_height_sd: (T, 2) of the height of right and left foot, m.
        refused: (T, M) markers seen but refused by the gate.
        tracked: (T,) whether enough markers passed the gate.
        nis: (T,) normalised innovation squared; NaN at a start.
        readings: (T,) numbers in it.
        nis_by_kind, readings_by_kind: (T, 4) the same by :data:`mbkf.conventions.READING_KINDS`.
        marker_nis: (T, M) of each marker per coordinate, NaN where it was not used.
        marker_spread_m: (T, M) the spread it is told in units of, m.
        step_seconds: (T,) computing time of each step.
        known: (T,) whether there is an estimate at all; after the first start there is none of what was no person.
        uncorrected: (T,) frames that stand as the filter had them, since later frames made no person of them.
        starts: Frames at which the filter was started or restarted.
        smoothed: Whether it was smoothed, with all later frames that matter, in more than the uncorrected frames.
        covariance: (T, 2 nv, 2 nv) full covariances, or None.
    """

    q: Array
    v: Array
    a: Array
    wrench: Array
    wrench_sd: Array
    support: Array
    support_sd: Array
    contact: Array | None
    position_sd: Array
    velocity_sd: Array
    angle_sd: Array
    rate_sd: Array
    ball_covariance: Array
    torque_sd: Array
    position_offset: Array
    velocity_offset: Array
    torque_offset: Array
    angle_offset: Array
    rate_offset: Array
    ball_offset: Array
    wrench_offset: Array
    foot_height_sd: Array
    refused: BoolArray
    tracked: BoolArray
    nis: Array
    readings: Array
    nis_by_kind: Array
    readings_by_kind: Array
    marker_nis: Array
    marker_spread_m: Array
    step_seconds: Array
    known: BoolArray
    uncorrected: BoolArray
    starts: tuple[int, ...]
    smoothed: bool
    covariance: Array | None


def track(
    filter: TrackingFilter,
    recording: Recording,
    *,
    smoothing: SmoothingSettings | None = None,
    lag_s: float = 0.0,
    body: BodyErrors | None = None,
    spreads: Collection[str] = ASKED,
    keep_covariance: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Track:
    """Runs the filter over all frames.

    Args:
        filter: The filter.
        recording: What the instruments read.
        smoothing: How to smooth; None for the filter alone.
        lag_s: Without smoothing, how far later readings may correct a frame.
        body: What estimates err by because the person's body is not known exactly; None where that is not told.
        spreads: Which of the standard deviations :data:`mbkf.filters.spread.ASKED` are told.
        keep_covariance: Whether to keep the full covariance of (q, v) of every frame.
        progress: Called with frames done and frames in all.

    Raises:
        NotObservable: In no frame do the markers fit the body.
    """
    recorder, frames = FrameRecorder(filter, recording.markers_m.shape[1], body, spreads), len(recording)
    rows = blank(recorder.dtype, frames)
    rows["number"] = np.arange(frames)
    size = 2 * filter.model.nv
    covariance = np.full((frames, size, size), np.nan) if keep_covariance else None

    def keep(found: Sequence[tuple[int, Posterior]]) -> None:
        for t, posterior in found:
            spread = recorder.motion(rows[t : t + 1], posterior)
            recorder.spread(rows[t : t + 1], spread)
            if covariance is not None:
                covariance[t] = filter.covariance(posterior) + spread.offset_covariance

    later: FixedLag | FixedLagSmoother = FixedLag(filter, lag_s)
    if smoothing is not None:
        later = FixedLagSmoother(filter, recording, smoothing)
    for t, fresh, seconds in followed(filter, recording):
        row = rows[t : t + 1]
        recorder.step(row, fresh, seconds)
        recorder.innovation(row, fresh)
        keep(later.push(t, fresh))
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    if not rows["started"].any():
        raise NotObservable(
            "in no frame do the markers fit the scaled body; is this the subject's protocol, "
            "and are unit and axes right (--unit, --up)?"
        )
    keep(later.finish())
    return track_of(rows, smoothed=smoothing is not None, covariance=covariance)


def track_of(rows: NDArray, smoothed: bool = False, covariance: Array | None = None) -> Track:
    """The trial of a table of records.

    Args:
        rows: (T,) records of its frames (:mod:`mbkf.filters.record`).
        smoothed: Whether it was smoothed.
        covariance: (T, 2 nv, 2 nv) full covariances, where they were kept.
    """
    asked = rows["footing"][:, 0] != UNASKED
    named = {f.name: rows[f.name] for f in fields(Track) if f.name in (rows.dtype.names or ())}
    named.setdefault("uncorrected", np.zeros(len(rows), dtype=bool))  # older logs lack it
    return Track(
        **{name: np.array(values) for name, values in named.items()},
        contact=np.where(asked[:, None], rows["footing"], 0) if asked.any() else None,
        starts=tuple(int(t) for t in np.flatnonzero(rows["started"])),
        smoothed=smoothed and not rows["uncorrected"][rows["known"]].all(),
        covariance=covariance,
    )
