"""Frames from which a capture is labelled, with their labels: known, named by the capture, or searched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.first_frame import FirstFrame
from mbkf.trial.labelling.any_attitude import STAGE, AnyAttitude
from mbkf.trial.labelling.body import LabelBody

CANDIDATES = 8
"""Frames, spread over the capture, that are searched first."""

SCAN_S = 0.1
"""Where none of these can be labelled, frames at this distance are searched in turn for an upright body, and the first
ones again for a body in any attitude."""

NAMED_TRIES = 3
"""Frames with most named points that are tried as a start."""

Starts = list[tuple[int, FirstFrame]]
"""Frames with their labels, the most likely first."""


@dataclass(frozen=True)
class Start:
    """A frame, and roughly the pose (nq,) of the body in it, where both are known beforehand."""

    frame: int
    q: Array


def find_starts(
    body: LabelBody,
    markers: MarkerTrajectories,
    start: Start | None,
    known: Indices | None,
    report: StageCallback,
) -> Starts:
    """Frames to start from with their labels.

    Args:
        body: The subject and its markers.
        markers: The points.
        start: The start, where it is known.
        known: (T, C) marker of the points that carry a reliable name; None where none does.
        report: Called with the stage, items done and items in all.

    Raises:
        NotObservable: In no frame do the points fit the subject's markers.
    """
    found: Starts = []
    if start is not None:
        first = body.search.near_pose(points_of(markers, start.frame), start.q)
        found = [] if first is None else [(start.frame, first)]
    elif known is not None:
        found = _named(body, markers, known)
    return found or _searched(body, markers, report)


def points_of(markers: MarkerTrajectories, t: int) -> Array:
    """(N, 3) the points of a frame, in the order of their columns."""
    frame = markers.positions_m[t]
    return frame[~np.isnan(frame).any(axis=1)]


def _searched(body: LabelBody, markers: MarkerTrajectories, report: StageCallback) -> Starts:
    """A few frames with their labels; else the first of all frames that can be labelled."""
    last, search = markers.frames - 1, body.search
    looks = sorted({round(share * last) for share in np.linspace(0.02, 0.98, CANDIDATES)})
    found = [(t, search.upright(points_of(markers, t))) for t in looks]
    good = [(t, one) for t, one in found if one is not None]
    if 2 * len(good) < len(looks):
        any_attitude = AnyAttitude(search, markers.positions_m, markers.rate_hz)
        good += any_attitude.starts(looks, lambda n, all_: report(STAGE, n, all_))
    if good:
        return sorted(good, key=lambda pair: -pair[1].log_ratio)
    scanned = range(0, markers.frames, max(1, round(SCAN_S * markers.rate_hz)))
    for find, frames in ((search.upright, scanned), (search.any_attitude, looks)):
        for t in frames:
            one = find(points_of(markers, t))
            if one is not None:
                return [(t, one)]
    raise NotObservable(
        f"in no frame do the points fit the subject's {len(body.markers)} markers (protocol "
        f"'{body.subject.protocol}'); check that subject and marker set belong to this capture, and its unit and axes "
        "(--unit, --up)"
    )


def _named(body: LabelBody, markers: MarkerTrajectories, known: Indices) -> Starts:
    """The frame with most named points, where the body in the pose of these fits all points."""
    for t in np.argsort(-(known != HIDDEN).sum(axis=1), kind="stable")[:NAMED_TRIES]:
        marker = known[t, ~np.isnan(markers.positions_m[t]).any(axis=1)]
        labels = np.full(len(body.markers), HIDDEN, dtype=np.intp)
        labels[marker[marker != HIDDEN]] = np.flatnonzero(marker != HIDDEN)
        first = body.search.refined(points_of(markers, int(t)), labels)
        if first is not None:
            return [(int(t), first)]
    return []
