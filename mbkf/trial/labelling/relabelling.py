"""Offline relabelling: filter and smoother over the labelled capture, then every tracklet as a whole gets its label."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.tracking_loop import TrackingLoop, followed
from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.neighbours import exchanged, renamed
from mbkf.labelling.offline_relabelling import (
    RelabellingSettings,
    SmoothedCapture,
    SmoothedMarkers,
    majority_labels,
    worn_markers,
)
from mbkf.labelling.tracklets import link_points
from mbkf.trial.labelling.body import LabelBody, corrected_body

ROUNDS = 4
"""Greatest number of rounds of alternately relabelling and smoothing."""


@dataclass(frozen=True)
class Relabelled:
    """Labels after the offline relabelling.

    Attributes:
        label_of_point: (T, C) marker of every point, ``HIDDEN`` where none; numbered as in the given body.
        changed: Samples whose label was removed or changed.
        places: The smoothed body's markers by which they were judged, None where the labels fit no body.
        body: The body with the markers shown, corrected to their places in the capture.
    """

    label_of_point: Indices
    changed: int
    places: SmoothedMarkers | None = None
    body: LabelBody | None = None


def relabel_offline(
    body: LabelBody,
    points: MarkerTrajectories,
    label_of_point: Indices,
    q: Array,
    progress: Callable[[int, int], None],
    known: Indices | None = None,
) -> Relabelled:
    """Relabels a capture with the smoothed body, which uses all frames.

    Args:
        body: The subject as scaled, whose markers number the labels.
        points: The capture.
        label_of_point: (T, C) labels of its points.
        q: (T, nq) poses of the pass, NaN where the body was not tracked.
        progress: Called with frames done and frames in all.
        known: (T, C) marker of the points that carry a reliable name; None where none does.
    """
    relabelling = _Relabelling(body, points, known, progress)
    labels = relabelling.by_votes(label_of_point, q)
    found = relabelling.smoothed(labels)
    if found is not None:
        labels, sure = relabelling.without_doubts(labels, *found)
        found = relabelling.smoothed(sure)
    for _ in range(ROUNDS):
        if found is None:
            break
        before, labels = labels, relabelling.by_body(labels, *found)
        if (labels == before).all():
            break
        found = relabelling.smoothed(labels)
    progress(1, 1)
    changed = (label_of_point != HIDDEN) & (labels != label_of_point)
    own, places = found or (None, None)
    return Relabelled(labels, int(changed.sum()), places, own)


def trajectories(
    points: MarkerTrajectories, label_of_point: Indices, names: tuple[str, ...]
) -> MarkerTrajectories:
    """The capture's points as trajectories of named markers.

    Args:
        points: The unlabelled points (T, C, 3).
        label_of_point: (T, C) index of each point's marker, ``HIDDEN`` for none.
        names: (M,) names of the markers.
    """
    positions = np.full((points.frames, len(names), 3), np.nan)
    frames, columns = np.nonzero(label_of_point != HIDDEN)
    positions[frames, label_of_point[frames, columns]] = points.positions_m[frames, columns]
    return replace(points, names=names, positions_m=positions)


def smoothed_markers(
    body: LabelBody, markers: MarkerTrajectories, progress: Callable[[int], None]
) -> SmoothedMarkers:
    """Places of the smoothed body's markers in every frame of labelled trajectories.

    Args:
        body: The body and its markers.
        markers: Labelled trajectories.
        progress: Called with the number of frames done.
    """
    positions, dt = markers.positions_m, 1.0 / markers.rate_hz
    filter, sensor = body.tracking_filter(dt), body.sensor
    recording = Recording(positions, np.zeros((len(positions), 0, 6)), dt)
    smoother = FixedLagSmoother(filter, SmoothingSettings())
    places = SmoothedMarkers(
        np.full(positions.shape, np.nan),
        np.full((*positions.shape, 3), np.nan),
        np.full(positions.shape[:2], np.nan),
    )

    def keep(done: list[tuple[int, Posterior]]) -> None:
        nv = sensor.model.nv
        for t, estimate in done:
            reading = sensor.reading(estimate.q)
            H = reading.jacobian
            rotations, _ = sensor.model.placements(estimate.q)
            places.on_body_m[t] = reading.positions_m
            places.rotations[t] = rotations[sensor.joint_ids]
            HP = H @ filter.covariance(estimate)[:nv, :nv]
            places.variance_m2[t] = np.einsum("mij,mij->m", HP, H) / 3.0

    for t, estimate, _ in followed(TrackingLoop(filter), recording):
        keep(smoother.push(t, estimate))
        progress(t)
    keep(smoother.finish())
    return places


class _Relabelling:
    """The tracklets of a capture and the body that they are judged by."""

    def __init__(
        self,
        body: LabelBody,
        points: MarkerTrajectories,
        known: Indices | None,
        progress: Callable[[int, int], None],
    ) -> None:
        self.body, self.points, self.known, self.progress = body, points, known, progress
        self.tracklets, self.smoothings = link_points(points.positions_m), 0
        self.named = np.zeros(0, dtype=np.intp) if known is None else np.unique(known[known != HIDDEN])

    def by_votes(self, label_of_point: Indices, q: Array) -> Indices:
        """(T, C) labels of whole tracklets by the majority of their frames, neighbours judged by the posture."""
        tracklets, search = self.tracklets, self.body.search
        label = majority_labels(label_of_point, len(self.body.markers), tracklets, RelabellingSettings())
        name = renamed(search, self._shown(tracklets.points(label)), q)
        label = self._kept(label, np.where(label == HIDDEN, HIDDEN, name[label]))
        other = exchanged(search, self._shown(tracklets.points(label)), q, label, tracklets)
        return tracklets.points(self._kept(label, other))

    def smoothed(self, labels: Indices) -> tuple[LabelBody, SmoothedMarkers] | None:
        """The body corrected on labelled trajectories, and its smoothed markers; None where they fit no body."""
        shown = trajectories(self.points, labels, self.body.names)
        corrected = corrected_body(self.body, shown)
        if corrected is None:
            return None
        begin, all_ = self.smoothings * self.points.frames, (ROUNDS + 1) * self.points.frames
        self.smoothings += 1
        own = shown.select(corrected.names)
        return corrected, smoothed_markers(corrected, own, lambda done: self.progress(begin + done, all_))

    def without_doubts(
        self, labels: Indices, corrected: LabelBody, places: SmoothedMarkers
    ) -> tuple[Indices, Indices]:
        """(T, C) labels of markers that were worn, and those of them that are not doubtful.

        A ghost takes a segment of few markers with it; doubtful labels are judged on a body that they did not move.
        """
        own, place = self._numbered(labels, corrected)
        worn = np.union1d(place[self._worn(own, corrected, places)], self.named)
        labels = np.where(np.isin(labels, worn), labels, HIDDEN)
        doubtful = self._beside(places, corrected.noise_m).doubtful(own)
        return labels, np.where(self.tracklets.points(doubtful.astype(np.intp)) == 1, HIDDEN, labels)

    def by_body(self, labels: Indices, corrected: LabelBody, places: SmoothedMarkers) -> Indices:
        """(T, C) labels of whole tracklets by their places on the smoothed body."""
        own, place = self._numbered(labels, corrected)
        worn = self._worn(own, corrected, places)
        names = None if self.known is None else self._numbered(self.known, corrected)[0]
        if names is not None:
            worn = worn | np.isin(np.arange(len(worn)), names)
        noise = np.where(worn, corrected.noise_m, np.nan)
        found = self._beside(places, noise).relabelled(own, names)
        return self.tracklets.points(np.where(found == HIDDEN, HIDDEN, place[found]))

    def _beside(self, places: SmoothedMarkers, noise_m: Array) -> SmoothedCapture:
        dt_s = 1.0 / self.points.rate_hz
        return SmoothedCapture(self.points.positions_m, self.tracklets, places, noise_m, dt_s)

    def _worn(self, own: Indices, corrected: LabelBody, places: SmoothedMarkers) -> BoolArray:
        shown = trajectories(self.points, own, corrected.names).positions_m
        segments = corrected.sensor.segments
        return worn_markers(places, shown, corrected.noise_m, segments, RelabellingSettings())

    def _shown(self, labels: Indices) -> Array:
        return trajectories(self.points, labels, self.body.names).positions_m

    def _kept(self, before: Indices, after: Indices) -> Indices:
        """(n,) labels after a change that concerns no marker whose name is known."""
        changed = before != after
        touched = changed & (np.isin(before, self.named) | np.isin(after, self.named))
        markers = np.union1d(before[touched], after[touched])
        undone = changed & (np.isin(before, markers) | np.isin(after, markers))
        return np.where(undone, before, after)

    def _numbered(self, labels: Indices, corrected: LabelBody) -> tuple[Indices, Indices]:
        """(T, C) labels numbered by the corrected body's markers, and the number of each of these among all."""
        place = np.array([self.body.names.index(one) for one in corrected.names], dtype=np.intp)
        own = np.full(len(self.body.markers) + 1, HIDDEN, dtype=np.intp)  # the last is that of HIDDEN
        own[place] = np.arange(len(place))
        return own[labels], place
