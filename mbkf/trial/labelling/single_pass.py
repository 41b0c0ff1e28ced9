"""One pass over unlabelled points in one direction of time: search, track, and search again after a loss."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.first_frame import FirstFrame, labelled_points
from mbkf.labelling.running import RunningLabeller
from mbkf.labelling.tracks import continuing_columns
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.labelling.any_attitude import AnyAttitude

START_FRAMES = 6
"""Frames labelled pose by pose on which a filter is started: they give its velocity."""

LOST_S = 0.2
"""Time with hardly a point labelled after which the labels are searched anew."""

LOST_SHARE = 0.4
"""Hardly a point: less than this share of those that could be labelled."""

RETRY_S = 0.05
"""Time after which a failed search is repeated: it costs as much as many frames."""

SEARCH_EVERY = 20
"""The slow search in any attitude is part of every so many tries."""


@dataclass(frozen=True)
class Points:
    """The points of a frame.

    Attributes:
        positions_m: (N, 3) those present.
        columns: (N,) their columns.
    """

    positions_m: Array
    columns: Indices


class LabellingPass:
    """Labels a capture frame by frame.

    Attributes:
        markers_m: (T, M, 3) labelled so far, NaN elsewhere.
        label_of_point: (T, C) marker of each column, ``HIDDEN`` where none.
        q: (T, nq) poses of the filter, NaN where the body is not tracked.
        labeller: Assigns points from frame to frame.
        starts: Frames at which labels were found by search.
        step_seconds: (T,) computing time of the labels alone, NaN where they were searched.
    """

    def __init__(
        self,
        filter: TrackingFilter,
        sensor: MarkerSensor,
        any_attitude: AnyAttitude,
        labeller: RunningLabeller,
        positions_m: Array,
        known: Indices | None = None,
    ) -> None:
        """A pass that has labelled no frame yet.

        Args:
            filter: The filter.
            sensor: The markers on its body.
            any_attitude: Finds labels in frames without a prediction.
            labeller: Assigns points from frame to frame.
            positions_m: (T, C, 3) points of the capture, NaN where empty.
            known: (T, C) marker of the points that carry a reliable name; None where none does.
        """
        self._filter, self._sensor, self._known = filter, sensor, known
        self._search, self._any_attitude = any_attitude.search, any_attitude
        self.labeller, self._positions_m = labeller, positions_m
        frames, markers = len(positions_m), len(sensor.segments)
        self.markers_m = np.full((frames, markers, 3), np.nan)
        self.label_of_point = np.full(positions_m.shape[:2], HIDDEN, dtype=np.intp)
        self.q = np.full((frames, sensor.model.nq), np.nan)
        self.starts: list[int] = []
        self.step_seconds = np.full(frames, np.nan)
        self._recording = Recording(self.markers_m, np.zeros((frames, 0, 6)), filter.dt_s)

    def run(
        self, start: int, first: FirstFrame | None, progress: Callable[[int], None] | None = None
    ) -> None:
        """Labels all frames from ``start`` on; ``first`` are its labels, None to search for them.

        Args:
            start: First frame.
            first: Its labels.
            progress: Called with the frames done.
        """
        t, frames, tries = start, len(self._positions_m), 0
        wait = max(1, round(RETRY_S / self._filter.dt_s))
        while t < frames:
            if (
                t > start
                and np.count_nonzero(~np.isnan(self._positions_m[t, :, 0])) < self._search.fewest_points
            ):
                t += 1
                continue
            found = first if t == start and first is not None else self.find(t, tries % SEARCH_EVERY == 0)
            estimate = None if found is None else self._begin(t, found)
            tries += 1
            if estimate is None:
                t += wait
            else:
                t, tries = self._follow(t + 1, estimate, progress), 0

    def find(self, t: int, thorough: bool) -> FirstFrame | None:
        """Labels of a frame by search; where ``thorough``, also in any attitude."""
        points = self._points(t).positions_m
        if len(points) < self._search.fewest_points:
            return None
        found = self._search.upright(points)
        return self._any_attitude.at(t) if found is None and thorough else found

    def _as_named(self, t: int, points: Points, labels: Indices) -> Indices:
        """(M,) labels, in which reliable names take precedence."""
        if self._known is None:
            return labels
        marker = self._known[t, points.columns]
        named = np.flatnonzero(marker != HIDDEN)
        labels = np.where(np.isin(labels, named), HIDDEN, labels)
        labels[marker[named]] = named
        return labels

    def _begin(self, t: int, found: FirstFrame) -> Posterior | None:
        """The filter's first estimate; the next frames are labelled pose by pose for its velocities."""
        points = self._points(t)
        first = self._as_named(t, points, found.points)
        self._note(t, points, first)
        last, poses = t, [found.q]
        model = self._sensor.model
        for k in range(t + 1, min(t + START_FRAMES, len(self._positions_m))):
            guess = poses[-1]
            if len(poses) > 1:
                guess = model.integrate(guess, model.difference(poses[-2], guess))
            frame = self._points(k)
            then = self._search.near_pose(frame.positions_m, guess)
            if then is None:
                break
            self._note(k, frame, self._as_named(k, frame, then.points))
            poses.append(then.q)
            last = k
        known = Recording(
            self.markers_m[t : last + 1], self._recording.plates[t : last + 1], self._filter.dt_s
        )
        estimate = self._filter.start(known, 0, found.q)
        self._forget(t if estimate is None else t + 1, last + 1)
        if estimate is None:
            return None
        self.starts.append(t)
        self.labeller.restart()
        self._remember(t, points, first, estimate)
        return estimate

    def _follow(self, t: int, estimate: Posterior, progress: Callable[[int], None] | None) -> int:
        """Labels frames from t on until the end or a loss; returns the frame after the last."""
        lost = 0
        while t < len(self._positions_m):
            points = self._points(t)
            prediction = self._filter.predict(estimate)
            labels = self._as_named(t, points, self._labels(t, points, prediction, lost))
            could = min(len(labels), len(points.positions_m))
            few = np.count_nonzero(labels != HIDDEN) < max(LOST_SHARE * could, 6)
            lost = lost + 1 if few else 0
            if lost * self._filter.dt_s > LOST_S:
                return t
            estimate, labels = self._corrected(t, points, labels, estimate, prediction)
            self._remember(t, points, labels, estimate)
            if progress is not None:
                progress(t + 1)
            t += 1
        return t

    def _corrected(
        self, t: int, points: Points, labels: Indices, before: Posterior, prediction: Prediction
    ) -> tuple[Posterior, Indices]:
        """The filter's step with these labels, or with those of them that fit the corrected pose."""
        self._note(t, points, labels)
        estimate = self._filter.step(before, self._recording, t, prediction)
        on_body = self._sensor.positions(estimate.q)
        contradicted = self.labeller.contradicted(labels, points.positions_m, on_body)
        if not contradicted.any():
            return estimate, labels
        labels = np.where(contradicted, HIDDEN, labels)
        self._note(t, points, labels)
        return self._filter.step(before, self._recording, t), labels

    def _labels(self, t: int, points: Points, prediction: Prediction, lost: int) -> Indices:
        """Labels by prediction; after a loss first by the pose, since the prediction is uncertain."""
        begin = time.perf_counter()
        if lost and len(points.positions_m) >= self._search.fewest_points:
            found = self._search.near_pose(points.positions_m, prediction.q)
            if found is not None:
                return found.points
        labels = self.labeller.label(
            prediction.markers, points.positions_m, lambda: self._follows(t, points.columns)
        )
        self.step_seconds[t] = time.perf_counter() - begin
        return labels

    def _points(self, t: int) -> Points:
        now = self._positions_m[t]
        columns = np.flatnonzero(~np.isnan(now).any(axis=1))
        return Points(now[columns], columns)

    def _follows(self, t: int, columns: Indices) -> Indices:
        """(N,) point of the frame before that each of a frame continues, ``HIDDEN`` where unknown."""
        now, follows = self._positions_m[t], np.full(len(columns), HIDDEN, dtype=np.intp)
        if t:
            before = self._positions_m[t - 1]
            place = np.cumsum(~np.isnan(before).any(axis=1)) - 1
            same = continuing_columns(before, now)[columns]
            follows[same] = place[columns[same]]
        return follows

    def _note(self, t: int, points: Points, labels: Indices) -> None:
        self.markers_m[t] = labelled_points(points.positions_m, labels)
        seen = labels != HIDDEN
        self.label_of_point[t] = HIDDEN
        self.label_of_point[t, points.columns[labels[seen]]] = np.flatnonzero(seen)

    def _forget(self, first: int, end: int) -> None:
        self.markers_m[first:end] = np.nan
        self.label_of_point[first:end] = HIDDEN

    def _remember(self, t: int, points: Points, labels: Indices, estimate: Posterior) -> None:
        self.q[t] = estimate.q
        self.labeller.remember(labels, points.positions_m, self._sensor.positions(estimate.q))
