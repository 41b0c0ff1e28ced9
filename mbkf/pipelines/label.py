"""From unlabelled points and a subject to named trajectories: first frame, filter and assignment in one loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, StageCallback
from mbkf.errors import MbkfError, NotObservable
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.kinematic_follower import KinematicFollower
from mbkf.filters.settings import KinematicSettings
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.first_frame import FirstFrame, FirstFrameSearch, labelled
from mbkf.labelling.placing import likeness
from mbkf.labelling.running import RunningLabeller, RunningSettings
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.label_score import LabelScore
from mbkf.pipelines.labelling_pass import LabellingPass
from mbkf.scaling.correction import correct_markers
from mbkf.sensors.markers import MarkerSensor

CANDIDATES = 8
"""Frames, spread over the capture, that are looked at for a start."""

PASSES = 3
"""At most so many passes are made from starts that disagree; the likeliest is kept."""

JUDGED = 40
"""Frames, spread over the capture, by which passes are compared."""

SCAN_S = 0.1
"""Where none of these will do, frames so far apart are tried in turn, and those above in any attitude."""

CORRECTED_SD_M = 0.006
"""How far a marker sits from where a first pass over the capture found it."""

LEAST_SEEN = 0.05
"""A marker that the first pass saw in a smaller share of the frames was not worn: a ghost took its place."""


@dataclass(frozen=True)
class Labelling:
    """What was labelled.

    Attributes:
        markers: (T, M, 3) trajectories under the subject's names, NaN where a marker is hidden.
        label_of_point: (T, C) marker of every point of the capture, ``HIDDEN`` for ghosts and empty columns.
        ghosts: (T,) points that are nobody's.
        starts: Frames at which labels were found without those of the frame before.
        repaired: How many markers had their labels taken back from a wrong point.
        step_seconds: (T,) computing time of each frame's labels, filter not counted; NaN where searched.
    """

    markers: MarkerTrajectories
    label_of_point: Indices
    ghosts: Array
    starts: tuple[int, ...]
    repaired: int
    step_seconds: Array

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


def summarise(found: Labelling, compared: LabelScore | None = None) -> dict[str, Any]:
    """Plain numbers for the summary beside the labelled file; the last three only with a truth."""
    summary: dict[str, Any] = {
        "frames": found.markers.frames,
        "markers": int(found.markers.present.any(axis=0).sum()),
        "assigned_fraction": found.assigned_fraction,
        "ghosts_dropped": int(found.ghosts.sum()),
        "swaps_repaired": found.repaired,
        "first_labelled_frame": found.first_labelled_frame,
        "starts": list(found.starts),
        "step_seconds_median": _median(found.step_seconds),
    }
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
class _Body:
    """A subject's markers ready to be looked for."""

    subject: Subject
    markers: tuple[SubjectMarker, ...]
    sensor: MarkerSensor
    search: FirstFrameSearch

    settings: RunningSettings

    def start_pass(self, positions_m: Array, dt_s: float) -> LabellingPass:
        """A pass over points (T, C, 3) with a filter and a labeller of its own."""
        noise = np.array([m.noise_m for m in self.markers])
        placement = np.array([m.session_sd_m for m in self.markers])
        held = ~self.sensor.model.supports[self.sensor.joint_ids].any(axis=0)
        follower = KinematicFollower(KinematicFilter(self.sensor, noise, dt_s, held, KinematicSettings()))
        return LabellingPass(
            follower,
            self.sensor,
            self.search,
            RunningLabeller(noise, placement, dt_s, self.settings),
            positions_m,
        )


def label(capture: Capture, subject: Subject, *, progress: StageCallback | None = None) -> Labelling:
    """Names the points of a capture.

    The columns of the capture may be tracks or may be shuffled in every frame. The capture is labelled from its surest
    frame forwards and backwards, once with the subject's own marker geometry and once with that geometry corrected
    on the result (thesis 4.1.1).

    Args:
        capture: Unlabelled points; their names are ignored.
        subject: The scaled person. Markers that scaling never saw are not looked for.
        progress: Called with the stage, items done and items in all.

    Raises:
        NotObservable: In no frame do the points fit the subject's markers.
    """
    report = progress or (lambda *_: None)
    markers = capture.markers
    with single_threaded():
        body = _body(subject.markers, subject, RunningSettings())
        found = _likeliest(body, markers, lambda n, all_: report("Labelling", n, all_))
        corrected = _corrected(body, found.labelling)
        if corrected is None:
            return found.labelling
        again = corrected.search.about(_present(markers, found.start), found.q[found.start])
        if again is None:
            return found.labelling
        return _both_ways(
            corrected, markers, found.start, again, lambda n, all_: report("Labelling again", n, all_)
        ).labelling


@dataclass(frozen=True)
class _Run:
    """A labelled capture, the frame it was labelled from and the filter's poses (T, nq)."""

    labelling: Labelling
    start: int
    q: Array


def _body(markers: Sequence[SubjectMarker], subject: Subject, settings: RunningSettings) -> _Body:
    seen = subject.report.get("markers")
    worn = tuple(m for m in markers if seen is None or m.name in seen)
    model = HumanModel.scaled(subject.scale_factors, subject.mass_kg, subject.body)
    sensor = MarkerSensor(model, [m.segment for m in worn], np.array([m.position_m for m in worn]))
    sd = np.array([np.hypot(m.noise_m, m.session_sd_m) for m in worn])
    return _Body(subject, worn, sensor, FirstFrameSearch(sensor, sd), settings)


def _present(markers: MarkerTrajectories, t: int) -> Array:
    frame = markers.positions_m[t]
    return frame[~np.isnan(frame).any(axis=1)]


def _likeliest(body: _Body, markers: MarkerTrajectories, progress: Callable[[int, int], None]) -> _Run:
    """The pass whose labels fit the body best, of those from a few starts that disagree."""
    runs: list[_Run] = []
    for t, first in _starts(body, markers):
        points = _present(markers, t)
        shown = labelled(points, first.points)
        if any(np.array_equal(run.labelling.markers.positions_m[t], shown, equal_nan=True) for run in runs):
            continue
        runs.append(_both_ways(body, markers, t, first, progress))
        if len(runs) == PASSES:
            break
    return max(runs, key=lambda run: _likelihood(body, run))


def _likelihood(body: _Body, run: _Run) -> float:
    """Worth of a run's labels, summed over a few frames; see :func:`mbkf.labelling.placing.likeness`."""
    total, shown = 0.0, run.labelling.markers.positions_m
    for t in np.unique(np.linspace(0, len(shown) - 1, JUDGED).astype(int)):
        if not np.isnan(run.q[t]).any():
            away = shown[t] - body.sensor.positions(run.q[t])
            total += float(np.nansum(likeness((away**2).sum(axis=1), body.search.sd_m)))
    return total


def _starts(body: _Body, markers: MarkerTrajectories) -> list[tuple[int, FirstFrame]]:
    """Frames to start from with their labels, surest first; else the first of all frames that can be labelled."""
    last, search = markers.frames - 1, body.search
    looks = sorted({round(share * last) for share in np.linspace(0.02, 0.98, CANDIDATES)})
    found = [(t, search.standing(_present(markers, t))) for t in looks]
    good = [(t, one) for t, one in found if one is not None]
    if good:
        return sorted(good, key=lambda pair: -pair[1].worth)
    for t in range(0, markers.frames, max(1, round(SCAN_S * markers.rate_hz))):
        one = search.standing(_present(markers, t))
        if one is not None:
            return [(t, one)]
    for t in looks:
        one = search.anyhow(_present(markers, t))
        if one is not None:
            return [(t, one)]
    raise NotObservable(
        f"in no frame do the points fit the subject's {len(body.markers)} markers (protocol "
        f"'{body.subject.protocol}'); is it this subject and this marker set, and are unit and axes right "
        "(--unit, --up)?"
    )


def _both_ways(
    body: _Body,
    markers: MarkerTrajectories,
    start: int,
    first: FirstFrame,
    progress: Callable[[int, int], None],
) -> _Run:
    """Labels from a frame to the end and back to the beginning."""
    positions, dt, frames = markers.positions_m, 1.0 / markers.rate_hz, markers.frames
    ahead = body.start_pass(positions, dt)
    ahead.run(start, first, lambda done: progress(done - start, frames))
    back = body.start_pass(positions[::-1], dt)
    mirror = frames - 1 - start
    back.run(mirror, first, lambda done: progress(frames - start + done - mirror - 1, frames))
    progress(frames, frames)

    def joined(later: NDArray[Any], earlier: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([earlier[::-1][:start], later[start:]])

    labels = joined(ahead.label_of_point, back.label_of_point)
    present = ~np.isnan(positions).any(axis=2)
    names = tuple(m.name for m in body.markers)
    found = replace(markers, names=names, positions_m=joined(ahead.markers_m, back.markers_m))
    starts = sorted({*ahead.starts, *(frames - 1 - t for t in back.starts)})
    result = Labelling(
        found,
        labels,
        (present & (labels == HIDDEN)).sum(axis=1),
        tuple(starts),
        ahead.labeller.repaired + back.labeller.repaired,
        joined(ahead.step_seconds, back.step_seconds),
    )
    return _Run(result, start, joined(ahead.q, back.q))


def _corrected(body: _Body, found: Labelling) -> _Body | None:
    """The body with marker positions as the first pass has them, or None where these fit no body."""
    try:
        subject = correct_markers(body.subject, found.markers)
    except MbkfError:
        return None
    share = found.markers.present.mean(axis=0)
    worn = {m.name for m, seen in zip(body.markers, share, strict=True) if seen >= LEAST_SEEN}
    markers = [
        replace(m, session_sd_m=min(m.session_sd_m, CORRECTED_SD_M))
        for m in subject.markers
        if m.name in worn
    ]
    return _body(markers, subject, RunningSettings(unseen_sd_m=0.0))
