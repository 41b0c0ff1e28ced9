"""Offline relabelling: filter and smoother over the labelled capture, then every tracklet as a whole gets its label."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Recording
from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.tracking_loop import followed
from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.neighbours import exchanged, renamed
from mbkf.labelling.offline_relabelling import (
    RelabellingSettings,
    SmoothedMarkers,
    doubtful,
    majority_labels,
    relabel,
    worn,
)
from mbkf.labelling.tracklets import Tracklets, linked
from mbkf.trial.labelling.body import LabelBody, corrected_body

ROUNDS = 4
"""Most iterations of labels and smoothed body."""


@dataclass(frozen=True)
class Relabelled:
    """Labels after the offline relabelling.

    Attributes:
        label_of_point: (T, C) marker of every point, ``HIDDEN`` where none; markers as the body given has them.
        changed: Samples whose label was taken away or is another now.
        places: The smoothed body's markers by which they were judged, None where the body fitted no person.
        body: The body with the markers shown, at the places where the capture has them.
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
        body: The subject as scaled, on whose markers the labels count.
        points: The capture.
        label_of_point: (T, C) labels of its points.
        q: (T, nq) poses of the pass, NaN where the body was not tracked.
        progress: Called with frames done and frames in all.
        known: (T, C) marker of the points that carry a name which is relied on; None where there are none.
    """
    settings = RelabellingSettings()
    tracklets = linked(points.positions_m)
    looked = 0

    def shown(labels: Indices) -> MarkerTrajectories:
        return trajectories(points, labels, body.names)

    def smoothed(labels: Indices) -> tuple[LabelBody, SmoothedMarkers] | None:
        nonlocal looked
        corrected = corrected_body(body, shown(labels))
        if corrected is None:
            return None
        begin, all_ = looked * points.frames, (ROUNDS + 1) * points.frames
        looked += 1
        own = shown(labels).select(corrected.names)
        return corrected, course(corrected, own, lambda done: progress(begin + done, all_))

    label = majority_labels(label_of_point, len(body.markers), tracklets, settings)
    named = np.unique(known[known != HIDDEN]) if known is not None else np.zeros(0, dtype=np.intp)
    name = renamed(body.search, shown(tracklets.points(label)).positions_m, q)
    label = _kept(named, label, np.where(label == HIDDEN, HIDDEN, name[label]))
    other = exchanged(body.search, shown(tracklets.points(label)).positions_m, q, label, tracklets)
    label = _kept(named, label, other)
    labels = tracklets.points(label)
    found = smoothed(labels)
    if found is not None:
        labels, sure = _sure(points, tracklets, labels, body, *found, settings, named)
        found = smoothed(sure)
    for _ in range(ROUNDS):
        if found is None:
            break
        fresh = _relabelled(points, tracklets, labels, body, *found, settings, known)
        settled = bool((fresh == labels).all())
        labels = fresh
        if settled:
            break
        found = smoothed(labels)
    progress(1, 1)
    had = label_of_point != HIDDEN
    own, places = found or (None, None)
    return Relabelled(labels, int((had & (labels != label_of_point)).sum()), places, own)


def _kept(named: Indices, before: Indices, after: Indices) -> Indices:
    """(n,) labels after a change that concerns no marker whose name is known."""
    changed = before != after
    touched = changed & (np.isin(before, named) | np.isin(after, named))
    markers = np.union1d(before[touched], after[touched])
    undone = changed & (np.isin(before, markers) | np.isin(after, markers))
    return np.where(undone, before, after)


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


def course(body: LabelBody, markers: MarkerTrajectories, progress: Callable[[int], None]) -> SmoothedMarkers:
    """Positions of the smoothed body's markers in every frame of labelled trajectories.

    Args:
        body: The body and its markers.
        markers: Labelled trajectories.
        progress: Called with the number of frames done.
    """
    positions, dt = markers.positions_m, 1.0 / markers.rate_hz
    filter, sensor = body.tracking_filter(dt), body.sensor
    recording = Recording(positions, np.zeros((len(positions), 0, 6)), dt)
    smoother = FixedLagSmoother(filter, recording, SmoothingSettings())
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

    for t, estimate, _ in followed(filter, recording):
        keep(smoother.push(t, estimate))
        progress(t)
    keep(smoother.finish())
    return places


def _sure(
    points: MarkerTrajectories,
    tracklets: Tracklets,
    labels: Indices,
    body: LabelBody,
    corrected: LabelBody,
    places: SmoothedMarkers,
    settings: RelabellingSettings,
    named: Indices,
) -> tuple[Indices, Indices]:
    """(T, C) labels of markers that were worn, and those of them that are in no doubt.

    A ghost takes a segment of few markers with it; what is in doubt is judged on a body that it did not move.
    """
    own, place = _numbered(labels, body, corrected)
    shown = trajectories(points, own, corrected.names).positions_m
    there = worn(places, shown, corrected.noise_m, corrected.sensor.segments, settings)
    labels = np.where(np.isin(labels, np.union1d(place[there], named)), labels, HIDDEN)
    dt = 1.0 / points.rate_hz
    astray = doubtful(own, points.positions_m, tracklets, places, corrected.noise_m, dt, settings)
    return labels, np.where(tracklets.points(astray.astype(np.intp)) == 1, HIDDEN, labels)


def _relabelled(
    points: MarkerTrajectories,
    tracklets: Tracklets,
    labels: Indices,
    body: LabelBody,
    corrected: LabelBody,
    places: SmoothedMarkers,
    settings: RelabellingSettings,
    known: Indices | None,
) -> Indices:
    """(T, C) labels as the tracklets' judgement has them."""
    own, place = _numbered(labels, body, corrected)
    shown = trajectories(points, own, corrected.names).positions_m
    there = worn(places, shown, corrected.noise_m, corrected.sensor.segments, settings)
    names = None if known is None else _numbered(known, body, corrected)[0]
    if names is not None:
        there = there | np.isin(np.arange(len(there)), names)
    noise, dt = np.where(there, corrected.noise_m, np.nan), 1.0 / points.rate_hz
    found = relabel(own, points.positions_m, tracklets, places, noise, dt, settings, names)
    return tracklets.points(np.where(found == HIDDEN, HIDDEN, place[found]))


def _numbered(labels: Indices, body: LabelBody, corrected: LabelBody) -> tuple[Indices, Indices]:
    """(T, C) labels counted among the corrected body's markers, and the place of each of these among all."""
    place = np.array([body.names.index(one) for one in corrected.names], dtype=np.intp)
    own = np.full(len(body.markers) + 1, HIDDEN, dtype=np.intp)  # the last is that of HIDDEN
    own[place] = np.arange(len(place))
    return own[labels], place
