"""From unlabelled points and a subject to named trajectories: first frame, filter and assignment in one loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NotRequired, TypedDict

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, StageCallback
from mbkf.errors import NotObservable
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.first_frame import FirstFrame, labelled
from mbkf.labelling.running import RunningSettings
from mbkf.numerics.runs import spread_indices
from mbkf.numerics.threads import single_threaded
from mbkf.trial.labelling.any_attitude import STAGE, AnyAttitude
from mbkf.trial.labelling.body import LabelBody, label_body
from mbkf.trial.labelling.doubts import Doubts
from mbkf.trial.labelling.known_names import known_names, no_names, with_claims
from mbkf.trial.labelling.relabelling import relabel_offline, trajectories
from mbkf.trial.labelling.scaled_doubts import scaled_doubts
from mbkf.trial.labelling.score import LabelScore

CANDIDATES = 8
"""Frames, spread over the capture, that are looked at for a start."""

PASSES = 3
"""At most so many passes are made from starts that disagree; the likeliest is kept."""

NAMED_TRIES = 3
"""Frames with most named points that are tried as a start."""

COMPARED = 40
"""Frames, spread over the capture, by which passes are compared."""

SCAN_S = 0.1
"""Where none of these will do, frames so far apart are tried in turn, and those above in any attitude."""


@dataclass(frozen=True)
class Labelling:
    """What was labelled.

    Attributes:
        markers: (T, M, 3) trajectories under the subject's names, NaN where a marker is hidden.
        label_of_point: (T, C) marker of every point of the capture, ``HIDDEN`` for ghosts and empty columns.
        ghosts: (T,) number of points that are no marker's.
        starts: Frames at which labels were found without those of the frame before.
        repaired: How many markers had their labels taken back from a wrong point.
        step_seconds: (T,) computing time of each frame's labels, filter not counted; NaN where searched.
        relabelled: Number of samples whose label was removed or changed by the offline relabelling.
        doubts: Possible errors in the labels.
    """

    markers: MarkerTrajectories
    label_of_point: Indices
    ghosts: Array
    starts: tuple[int, ...]
    repaired: int
    step_seconds: Array
    relabelled: int = 0
    doubts: Doubts | None = None

    @property
    def assigned_fraction(self) -> float:
        """Share of marker-frames that have a point, over the markers the capture shows at all."""
        present = self.markers.present
        worn = present.any(axis=0)
        return float(present[:, worn].mean()) if worn.any() else 0.0

    @property
    def first_labelled_frame(self) -> int:
        """The first frame with a label."""
        return int(np.flatnonzero(self.markers.present.any(axis=1))[0])


class LabelSummary(TypedDict):
    """Plain numbers about labels, as they stand beside the labelled file.

    Attributes:
        frames, markers: How many frames, and how many markers in them.
        assigned_fraction: Share of marker samples that a point was assigned to.
        ghosts_dropped, ghosts_per_frame: Points that are no marker, in all and by frame.
        swaps_repaired: Exchanged labels that were put right.
        samples_relabelled: Marker samples that offline relabelling changed.
        first_labelled_frame: First frame with labels.
        starts: Frames in which the labeller started.
        step_seconds_median: Computing time of a frame.
        doubts: Labels that may be wrong.
        correct_fraction, wrong_fraction, missed_fraction: Against a truth; only where it is known.
    """

    frames: int
    markers: int
    assigned_fraction: float
    ghosts_dropped: int
    ghosts_per_frame: list[int]
    swaps_repaired: int
    samples_relabelled: int
    first_labelled_frame: int
    starts: list[int]
    step_seconds_median: float | None
    doubts: NotRequired[dict[str, object]]
    correct_fraction: NotRequired[float]
    wrong_fraction: NotRequired[float]
    missed_fraction: NotRequired[float]


def label_summary(found: Labelling, compared: LabelScore | None = None) -> LabelSummary:
    """Plain numbers for the summary beside the labelled file; doubts and truth only where there are any."""
    summary: LabelSummary = {
        "frames": found.markers.frames,
        "markers": int(found.markers.present.any(axis=0).sum()),
        "assigned_fraction": found.assigned_fraction,
        "ghosts_dropped": int(found.ghosts.sum()),
        "ghosts_per_frame": [int(n) for n in found.ghosts],
        "swaps_repaired": found.repaired,
        "samples_relabelled": found.relabelled,
        "first_labelled_frame": found.first_labelled_frame,
        "starts": list(found.starts),
        "step_seconds_median": _median(found.step_seconds),
    }
    if found.doubts is not None:
        summary["doubts"] = found.doubts.summary()
    if compared is not None:
        summary["correct_fraction"] = compared.correct_fraction
        summary["wrong_fraction"] = compared.wrong_fraction
        summary["missed_fraction"] = compared.missed_fraction
    return summary


def _median(values: Array) -> float | None:
    known = values[~np.isnan(values)]
    return float(np.median(known)) if len(known) else None


def labelled_capture(raw: Capture, found: Labelling) -> Capture:
    """The capture with the labelled markers that it shows, plates and all else as they were."""
    shown = np.asarray(found.markers.present.any(axis=0))
    names = tuple(name for name, there in zip(found.markers.names, shown, strict=True) if there)
    return replace(raw, markers=found.markers.select(names))


@dataclass(frozen=True)
class Start:
    """A frame and the pose (nq,) of the body in it, nearly, where both are known beforehand."""

    frame: int
    q: Array


def label(
    capture: Capture,
    subject: Subject,
    *,
    start: Start | None = None,
    ignore_names: bool = False,
    progress: StageCallback | None = None,
) -> Labelling:
    """Names the points of a capture.

    The columns of the capture may be tracks or may be shuffled in every frame. The capture is labelled from its surest
    frame forwards and backwards; then a smoother decides again, with the subject's marker geometry corrected on the
    result (thesis 4.1.1).

    Args:
        capture: Points, wholly, partly or not named.
        subject: The scaled person. Markers that scaling never saw are not looked for.
        start: Where to start from; by default it is searched for.
        ignore_names: Whether names mean nothing; by default those are relied on that stay on their points from frame to
            frame and that the body does not contradict.
        progress: Called with the stage, items done and items in all.

    Raises:
        NotObservable: In no frame do the points fit the subject's markers.
    """
    report = progress or (lambda *_: None)
    markers = capture.markers
    with single_threaded():
        body = label_body(subject.markers, subject, RunningSettings())
        names = no_names(markers) if ignore_names else known_names(markers, body.markers, body.sensor)
        known = names.trusted if names.names else None
        starts = [] if start is not None or known is None else _named_start(body, markers, known)
        if not starts:
            starts = (
                _starts(body, markers, report) if start is None else _started(body, markers, start, report)
            )
        found = _likeliest(body, markers, starts, lambda n, all_: report("Labelling", n, all_), known)
        again = relabel_offline(
            body,
            markers,
            found.labelling.label_of_point,
            found.q,
            lambda n, all_: report("Looking again", n, all_),
            known,
        )
        labels = with_claims(again.label_of_point, names)
        again = replace(again, label_of_point=labels)
        return replace(
            found.labelling,
            markers=trajectories(markers, labels, body.names),
            label_of_point=labels,
            ghosts=_ghosts(markers.positions_m, labels),
            relabelled=again.changed,
            doubts=scaled_doubts(body, markers, again, names),
        )


def _ghosts(positions_m: Array, label_of_point: Indices) -> Array:
    """(T,) number of points that are no marker's."""
    there = ~np.isnan(positions_m).any(axis=2)
    return np.asarray((there & (label_of_point == HIDDEN)).sum(axis=1))


@dataclass(frozen=True)
class _Run:
    """A labelled capture, the frame it was labelled from and the filter's poses (T, nq)."""

    labelling: Labelling
    start: int
    q: Array


def _present(markers: MarkerTrajectories, t: int) -> Array:
    frame = markers.positions_m[t]
    return frame[~np.isnan(frame).any(axis=1)]


def _likeliest(
    body: LabelBody,
    markers: MarkerTrajectories,
    starts: list[tuple[int, FirstFrame]],
    progress: Callable[[int, int], None],
    known: Indices | None,
) -> _Run:
    """The pass whose labels fit the body best, of those from a few starts that disagree."""
    runs: list[_Run] = []
    for t, first in starts:
        points = _present(markers, t)
        shown = labelled(points, first.points)
        if any(np.array_equal(run.labelling.markers.positions_m[t], shown, equal_nan=True) for run in runs):
            continue
        runs.append(_both_ways(body, markers, t, first, progress, known))
        if len(runs) == PASSES:
            break
    return max(runs, key=lambda run: _likelihood(body, run))


def _likelihood(body: LabelBody, run: _Run) -> float:
    """Worth of a run's labels, summed over a few frames."""
    total, shown = 0.0, run.labelling.markers.positions_m
    for t in spread_indices(len(shown), COMPARED):
        if not np.isnan(run.q[t]).any():
            total += body.search.worth(shown[t], run.q[t])
    return total


def _starts(
    body: LabelBody, markers: MarkerTrajectories, report: StageCallback
) -> list[tuple[int, FirstFrame]]:
    """Frames to start from with their labels, surest first; else the first of all frames that can be labelled."""
    last, search = markers.frames - 1, body.search
    looks = sorted({round(share * last) for share in np.linspace(0.02, 0.98, CANDIDATES)})
    found = [(t, search.standing(_present(markers, t))) for t in looks]
    good = [(t, one) for t, one in found if one is not None]
    if 2 * len(good) < len(looks):
        any_attitude = AnyAttitude(search, markers.positions_m, markers.rate_hz)
        good += any_attitude.starts(looks, lambda n, all_: report(STAGE, n, all_))
    if good:
        return sorted(good, key=lambda pair: -pair[1].worth)
    for t in range(0, markers.frames, max(1, round(SCAN_S * markers.rate_hz))):
        one = search.standing(_present(markers, t))
        if one is not None:
            return [(t, one)]
    for t in looks:
        one = search.any_attitude(_present(markers, t))
        if one is not None:
            return [(t, one)]
    raise NotObservable(
        f"in no frame do the points fit the subject's {len(body.markers)} markers (protocol "
        f"'{body.subject.protocol}'); is it this subject and this marker set, and are unit and axes right "
        "(--unit, --up)?"
    )


def _started(
    body: LabelBody, markers: MarkerTrajectories, start: Start, report: StageCallback
) -> list[tuple[int, FirstFrame]]:
    """The start that is known, or those that can be found where its pose does not fit the subject."""
    first = body.search.about(_present(markers, start.frame), start.q)
    return _starts(body, markers, report) if first is None else [(start.frame, first)]


def _named_start(
    body: LabelBody, markers: MarkerTrajectories, known: Indices
) -> list[tuple[int, FirstFrame]]:
    """The frame with most named points, with its labels, where the body in the pose that these give fits the points."""
    for t in np.argsort(-(known != HIDDEN).sum(axis=1), kind="stable")[:NAMED_TRIES]:
        columns = np.flatnonzero(~np.isnan(markers.positions_m[t]).any(axis=1))
        marker = known[t, columns]
        labels = np.full(len(body.markers), HIDDEN, dtype=np.intp)
        labels[marker[marker != HIDDEN]] = np.flatnonzero(marker != HIDDEN)
        first = body.search.settled(markers.positions_m[t, columns], labels)
        if first is not None:
            return [(int(t), first)]
    return []


def _both_ways(
    body: LabelBody,
    markers: MarkerTrajectories,
    start: int,
    first: FirstFrame,
    progress: Callable[[int, int], None],
    known: Indices | None,
) -> _Run:
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

    labels = joined(ahead.label_of_point, back.label_of_point)
    found = replace(markers, names=body.names, positions_m=joined(ahead.markers_m, back.markers_m))
    starts = sorted({*ahead.starts, *(frames - 1 - t for t in back.starts)})
    result = Labelling(
        found,
        labels,
        _ghosts(positions, labels),
        tuple(starts),
        ahead.labeller.repaired + back.labeller.repaired,
        joined(ahead.step_seconds, back.step_seconds),
    )
    return _Run(result, start, joined(ahead.q, back.q))
