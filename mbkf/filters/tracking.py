"""A whole trial through a filter: start, steps, restart after a loss, smoothing on request."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.contact_opening import ContactWatch
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.lag import FixedLag
from mbkf.filters.offset_change import OffsetChanges
from mbkf.filters.record import UNASKED, FrameRecorder, Track, blank
from mbkf.filters.spread import ASKED
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.paged import PagedArray
from mbkf.io.quantities import LATER, quantities, unknown


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
    contacts: ContactWatch | None = None,
    filtered: Callable[[int, Posterior], bool] | None = None,
) -> Track:
    """Runs the filter over all frames.

    Args:
        filter: The filter.
        recording: What the instruments read.
        smoothing: How to smooth; None for the filter alone.
        lag_s: Without smoothing, how far later readings may correct a frame.
        body: What estimates err by because the person's body is not known exactly; None where that is not known.
        spreads: Which of the standard deviations :data:`mbkf.filters.spread.ASKED` are stated.
        keep_covariance: Whether to keep the full covariance of (q, v) of every frame.
        progress: Called with frames done and frames in all.
        contacts: Without smoothing, opens contacts of other parts than the feet on the way; None: those of the
            recording.
        filtered: Called with each frame and its filtered estimate; where it returns False the run ends, and this and
            later frames, and those that wait to be smoothed, stay blank.

    Raises:
        NotObservable: In no frame do the markers fit the body.
    """
    frames, size = len(recording), 2 * filter.model.nv
    covariance = np.full((frames, size, size), np.nan) if keep_covariance else None
    recorder = FrameRecorder(filter, recording.markers_m.shape[1], body, spreads, levels=True)
    rows = blank_records(recorder.dtype, 0, frames)
    settled = fill(
        rows,
        recorder,
        recording,
        smoothing=smoothing,
        lag_s=lag_s,
        body=body,
        progress=progress,
        contacts=contacts,
        covariance=covariance,
        filtered=filtered,
    )
    found = track_of(rows, smoothed=smoothing is not None, covariance=covariance)
    found = replace(found, limb_doubts=settled.limb_doubts)
    return found if settled.changes is None else settled.changes.added_to(found, rows)


class Settled(NamedTuple):
    """Findings on a trial that are complete when its last frame is.

    Attributes:
        limb_doubts: Stretches in which a limb was in doubt.
        changes: Roots of the errors by the body; None where these are not known.
    """

    limb_doubts: tuple[LimbDoubt, ...]
    changes: OffsetChanges | None


def blank_records(dtype: np.dtype, first: int, after: int) -> NDArray:
    """Blank records of frames.

    Args:
        dtype: Their type.
        first: Number of the first frame.
        after: Number of the one after the last.
    """
    rows = blank(dtype, after - first)
    rows["number"] = np.arange(first, after)
    return rows


def fill(
    rows: NDArray | PagedArray,
    recorder: FrameRecorder,
    recording: Recording,
    *,
    smoothing: SmoothingSettings | None,
    lag_s: float,
    body: BodyErrors | None,
    progress: Callable[[int, int], None] | None,
    contacts: ContactWatch | None,
    covariance: Array | None = None,
    kept_bytes: int | None = None,
    filtered: Callable[[int, Posterior], bool] | None = None,
) -> Settled:
    """Runs a filter over all frames and fills their records.

    Args:
        rows: (T,) blank records of the recorder's type with the frames' numbers; they are filled.
        recorder: Fills a record, and knows the filter.
        recording: What the instruments read; its arrays may be paged (:class:`mbkf.io.paged.PagedArray`).
        smoothing: How to smooth; None for the filter alone.
        lag_s: Without smoothing, how far later readings may correct a frame.
        body: What estimates err by because the person's body is not known exactly; None where that is not known.
        progress: Called with frames done and frames in all.
        contacts: Without smoothing, opens contacts of other parts than the feet on the way.
        covariance: (T, 2 nv, 2 nv) receives the full covariances; None: they are not kept.
        kept_bytes: Memory for roots of the errors by the body (:class:`~mbkf.filters.offset_change.OffsetChanges`).
        filtered: Called with each frame and its filtered estimate; where it returns False the run ends, and this and
            later frames, and those that wait to be smoothed, stay blank.

    Raises:
        NotObservable: In no frame do the markers fit the body.
    """
    filter, frames, started = recorder.filter, len(recording), False
    changes = None if body is None else OffsetChanges(body, filter.clinical, filter.dt_s, kept_bytes)

    def keep(found: Sequence[tuple[int, Posterior]]) -> None:
        for t, posterior in found:
            spread = recorder.motion(rows[t : t + 1], posterior)
            recorder.spread(rows[t : t + 1], spread)
            if changes is not None and spread.body is not None:
                changes.follow(t, spread.q, spread.body)
            if covariance is not None:
                covariance[t] = filter.covariance(posterior) + spread.offset_covariance

    loop, earliest = TrackingLoop(filter, contacts), None
    later: FixedLag | FixedLagSmoother = FixedLag(filter, lag_s)
    if smoothing is not None:
        later = smoother = FixedLagSmoother(filter, smoothing)
        earliest = lambda: smoother.earliest  # noqa: E731
    for t, fresh, seconds in followed(loop, recording, earliest):
        row = rows[t : t + 1]
        recorder.step(row, fresh, seconds)
        recorder.innovation(row, fresh)
        started = started or fresh.started
        if filtered is not None and not filtered(t, fresh):
            return Settled((), None)
        keep(later.push(t, fresh))
        if progress is not None and (t % 20 == 0 or t == frames - 1):
            progress(t + 1, frames)
    if not started:
        raise NotObservable(
            "in no frame do the markers fit the scaled body; is this the subject's protocol, "
            "and are unit and axes right (--unit, --up)?"
        )
    keep(later.finish())
    return Settled(() if loop.watch is None else tuple(loop.watch.doubts), changes)


def track_of(
    rows: NDArray, smoothed: bool = False, covariance: Array | None = None, decides: bool | None = None
) -> Track:
    """The trial of a table of records.

    Args:
        rows: (T,) records of its frames (:mod:`mbkf.filters.record`).
        smoothed: Whether it was smoothed.
        covariance: (T, 2 nv, 2 nv) full covariances, where they were kept.
        decides: Whether the filter decides what the feet stand on; None: the records show it.
    """
    logged = {name: one for name, one in quantities(Track).items() if one.key in (rows.dtype.names or ())}
    values: dict[str, Any] = {name: np.array(rows[one.key]) for name, one in logged.items()}
    sizes = {
        axis: n for name, one in logged.items() for axis, n in zip(one.axes, values[name].shape, strict=True)
    }
    for field in fields(Track):
        if field.default is LATER:
            values.setdefault(field.name, unknown(quantities(Track)[field.name], sizes))
    for name, one in quantities(Track).items():
        if one.change_of:
            values[name] = np.where(np.isnan(values[one.change_of]), np.nan, np.float32(0.0))
    asked = rows["footing"][:, 0] != UNASKED
    decides = bool(asked.any()) if decides is None else decides
    values["foot_contact"] = np.where(asked[:, None], rows["footing"], 0) if decides else None
    values.setdefault("uncorrected", np.zeros(len(rows), dtype=bool))  # older logs lack it
    return Track(
        **values,
        starts=tuple(int(t) for t in np.flatnonzero(rows["started"])),
        smoothed=smoothed and not rows["uncorrected"][rows["known"]].all(),
        covariance=covariance,
    )
