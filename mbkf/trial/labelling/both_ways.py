"""A capture labelled from one frame forwards and backwards; of several starts, the most likely run is kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import Indices
from mbkf.labelling.first_frame import FirstFrame, labelled_points
from mbkf.numerics.runs import spread_indices
from mbkf.trial.labelling.body import LabelBody
from mbkf.trial.labelling.starts import Starts, points_of

RUNS = 3
"""Greatest number of runs, from starts that disagree."""

COMPARED = 40
"""Frames, spread over the capture, by which runs are compared."""


@dataclass(frozen=True)
class Run:
    """A capture labelled frame by frame.

    Attributes:
        markers_m: (T, M, 3) labelled trajectories.
        label_of_point: (T, C) marker of every point, ``HIDDEN`` where none.
        q: (T, nq) the filter's poses, NaN where the body was not tracked.
        step_seconds: (T,) computing time of each frame's labels, NaN where they were searched.
        starts: Frames whose labels were searched.
        repaired: Number of markers whose labels were taken back from a wrong point.
    """

    markers_m: Array
    label_of_point: Indices
    q: Array
    step_seconds: Array
    starts: tuple[int, ...]
    repaired: int


def most_likely_run(
    body: LabelBody,
    markers: MarkerTrajectories,
    starts: Starts,
    known: Indices | None,
    progress: Callable[[int, int], None],
) -> Run:
    """The run whose labels fit the body best, of those from a few starts that disagree.

    Args:
        body: The subject and its markers.
        markers: The points.
        starts: Frames to start from, with their labels.
        known: (T, C) marker of the points that carry a reliable name; None where none does.
        progress: Called with frames done and frames in all.
    """
    runs: list[Run] = []
    for t, first in starts:
        shown = labelled_points(points_of(markers, t), first.points)
        if any(np.array_equal(run.markers_m[t], shown, equal_nan=True) for run in runs):
            continue
        runs.append(_both_ways(body, markers, t, first, known, progress))
        if len(runs) == RUNS:
            break
    return max(runs, key=lambda run: _log_ratio(body, run))


def _log_ratio(body: LabelBody, run: Run) -> float:
    """Log-likelihood ratio of a run's labels, summed over a few frames."""
    frames = [t for t in spread_indices(len(run.q), COMPARED) if not np.isnan(run.q[t]).any()]
    return sum(body.search.log_ratio(run.markers_m[t], run.q[t]) for t in frames)


def _both_ways(
    body: LabelBody,
    markers: MarkerTrajectories,
    start: int,
    first: FirstFrame,
    known: Indices | None,
    progress: Callable[[int, int], None],
) -> Run:
    """Labels from a frame to the end and back to the beginning."""
    positions, dt, frames = markers.positions_m, 1.0 / markers.rate_hz, markers.frames
    ahead = body.start_pass(positions, dt, known)
    ahead.run(start, first, lambda done: progress(done - start, frames))
    back = body.start_pass(positions[::-1], dt, None if known is None else known[::-1])
    mirror = frames - 1 - start
    back.run(mirror, first, lambda done: progress(frames - start + done - mirror - 1, frames))
    progress(frames, frames)

    def joined(later: NDArray[Any], earlier: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([earlier[::-1][:start], later[start:]])

    return Run(
        joined(ahead.markers_m, back.markers_m),
        joined(ahead.label_of_point, back.label_of_point),
        joined(ahead.q, back.q),
        joined(ahead.step_seconds, back.step_seconds),
        tuple(sorted({*ahead.starts, *(frames - 1 - t for t in back.starts)})),
        ahead.labeller.repaired + back.labeller.repaired,
    )
