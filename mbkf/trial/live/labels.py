"""Names for the points of a live stream, between the filter's prediction and its correction.

While the filter has no estimate (at the start, after a loss) labels are searched, which takes as long as many frames:
those wait, and when a search has succeeded its labels are carried through them pose by pose, both ways. As soon as the
filter has an estimate, each frame is named at once by its prediction and covariance.
"""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Prediction
from mbkf.io.subject import Subject
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.first_frame import FirstFrame, labelled_points
from mbkf.labelling.running import RunningSettings
from mbkf.labelling.tracks import continuing_columns
from mbkf.trial.labelling.body import LabelBody, label_body
from mbkf.trial.labelling.single_pass import LOST_S, LOST_SHARE, RETRY_S, SEARCH_EVERY

LEAST_LABELS = 6
"""With fewer labels no body is tracked."""

LONGEST_WAIT_S = 2.0
"""Frames do not wait longer than this for a search; older ones go on without names."""

LOOKS = 3
"""So many frames are searched at most before the likeliest labels are taken ..."""

UNEXPLAINED = 1
"""... unless all but so many of the points, or of the markers where these are fewer, have found each other."""


def live_body(subject: Subject, names: tuple[str, ...] | None = None) -> LabelBody:
    """The subject's markers ready to be looked for in a stream: those of the ``names``, in that order, or all."""
    subject = subject.in_neutral_posture()
    body = label_body(subject.markers, subject, RunningSettings())
    if names is None or names == body.names:
        return body
    chosen = [body.markers[body.names.index(name)] for name in names]
    return label_body(chosen, subject, RunningSettings())


class LiveLabels:
    """Names a stream's points: :meth:`push` a frame, let the filter step, then give its estimate to :meth:`learn`.

    Attributes:
        body: Whose markers are looked for; trajectories come in the order of ``body.names``.
        starts: Frames, counted from 0, whose labels were found by search.
    """

    def __init__(self, body: LabelBody, dt_s: float, *, patient: bool = False) -> None:
        """A labeller that has seen no frame yet.

        Args:
            body: The subject's markers, in the filter's order, with a model of its own.
            dt_s: Time between frames.
            patient: Whether the source waits for a slow reader, as a file does: searches are then made at once instead
                of in a thread of their own.
        """
        self.body = body
        self.starts: list[int] = []
        self._patient = patient
        self._labeller = body.labeller(dt_s)
        self._patience = LOST_S / dt_s
        self._retry = max(1, round(RETRY_S / dt_s))
        self._longest = max(2, round(LONGEST_WAIT_S / dt_s))
        self._beside = None if patient else ThreadPoolExecutor(1, "label search")
        self._waiting: deque[tuple[int, Array]] = deque()
        self._search: Future[FirstFrame | None] | None = None
        self._searched, self._tries = 0, 0
        self._found: list[tuple[int, FirstFrame]] = []
        self._frame, self._lost = -1, 0
        self._poses: list[Array] = []
        self._points_m = np.zeros((0, 3))
        self._labels = np.full(len(body.markers), HIDDEN, dtype=np.intp)

    def push(self, points_m: Array, prediction: Prediction | None) -> list[Array]:
        """Markers (M, 3) of the frames that are due, in order: this one, or none, or those that waited and this one.

        Args:
            points_m: (N, 3) the frame's points in any order; NaN rows are no points.
            prediction: What the filter expects of this frame, None where it will start anew.
        """
        self._frame += 1
        missing = np.isnan(points_m)
        present = points_m[~missing.any(axis=1)] if missing.any() else points_m
        if prediction is not None and self._lost <= self._patience:
            return [self._taken(present, self._predicted(present, prediction))]
        carried = self._carried(present, self._poses) if self._poses else None
        if carried is not None:
            self._poses = [*self._poses[-1:], carried.q]
            return [self._taken(present, carried.points)]
        self._poses = []
        self._waiting.append((self._frame, present))
        return self._awaited()

    def learn(self, q: Array) -> None:
        """Takes the filter's pose (nq,) of the frame pushed last."""
        on_body = self._points_m[:0]
        if self._labeller.learns:
            on_body = self.body.sensor.positions(q)
            strange = self._labeller.contradicted(self._labels, self._points_m, on_body)
            self._labels = np.where(strange, HIDDEN, self._labels)
        self._labeller.remember(self._labels, self._points_m, on_body)
        self._poses = [q]

    def finish(self) -> list[Array]:
        """Markers of the frames that still wait, when no more follow."""
        if self._search is not None:
            self._heard(self._search.result())
        due = self._named() if self._found else self._unnamed(0)
        if self._beside is not None:
            self._beside.shutdown()
        return due

    def _taken(self, points_m: Array, labels: Indices) -> Array:
        """Markers (M, 3) of a frame, kept in mind for the next; counts frames with hardly a label."""
        could = min(len(labels), len(points_m))
        few = np.count_nonzero(labels != HIDDEN) < max(LEAST_LABELS, LOST_SHARE * could)
        self._lost = self._lost + 1 if few else 0
        self._points_m, self._labels = points_m, labels
        return labelled_points(points_m, labels)

    def _predicted(self, points_m: Array, prediction: Prediction) -> Indices:
        """By the filter's prediction; after a blackout by the pose first, since the prediction has grown vague."""
        if self._lost and len(points_m) >= self.body.search.fewest_points:
            found = self.body.search.near_pose(points_m, prediction.q)
            if found is not None:
                return found.points
        return self._labeller.label(prediction.markers, points_m, lambda: self._follows(points_m))

    def _follows(self, points_m: Array) -> Indices:
        """(N,) the point of the frame before that stood in the same place of the list, where that is the same one."""
        follows = np.full(len(points_m), HIDDEN, dtype=np.intp)
        if len(points_m) == len(self._points_m):
            same = continuing_columns(self._points_m, points_m)
            follows[same] = np.flatnonzero(same)
        return follows

    def _carried(self, points_m: Array, poses: list[Array]) -> FirstFrame | None:
        """Labels about the pose to which the last two lead."""
        if len(points_m) < self.body.search.fewest_points:
            return None
        model, guess = self.body.sensor.model, poses[-1]
        if len(poses) > 1:
            guess = model.integrate(guess, model.difference(poses[-2], guess))
        return self.body.search.near_pose(points_m, guess)

    def _awaited(self) -> list[Array]:
        """Takes a search's result, and begins the next one; frames that waited too long go on without names."""
        if self._search is None:
            self._begin_search()
        if self._search is not None and self._search.done():
            self._heard(self._search.result())
            if self._found and (len(self._found) == LOOKS or self._sure()):
                return self._named()
        return self._unnamed(self._longest)

    def _begin_search(self) -> None:
        number, points = self._waiting[-1]
        if len(points) < self.body.search.fewest_points or number < self._searched + self._retry * (
            self._tries > 0
        ):
            return
        search = self.body.search
        slowly = self._tries % SEARCH_EVERY == SEARCH_EVERY - 1
        look = search.any_attitude if slowly else search.upright
        self._searched, self._tries = number, self._tries + 1
        if self._beside is not None:
            self._search = self._beside.submit(look, points)
        else:
            self._search = Future()
            self._search.set_result(look(points))

    def _heard(self, found: FirstFrame | None) -> None:
        self._search = None
        if found is not None:
            self._found.append((self._searched, found))

    def _sure(self) -> bool:
        number, found = self._found[-1]
        points = next((points for n, points in self._waiting if n == number), np.zeros((0, 3)))
        return found.labelled >= min(len(points), len(self.body.markers)) - UNEXPLAINED

    def _named(self) -> list[Array]:
        """The frames that wait, named from the likeliest of those searched, forwards and backwards."""
        known = {number: points for number, points in self._waiting}
        usable = [(number, found) for number, found in self._found if number in known]
        self._found, self._tries, self._lost = [], 0, 0
        if not usable:
            return self._unnamed(0)
        start, found = max(usable, key=lambda one: one[1].log_ratio)
        self.starts.append(start)
        self._labeller.restart()
        labels = {start: found.points}
        for step in (-1, 1):
            poses, number = [found.q], start + step
            while number in known:
                there = self._carried(known[number], poses)
                if there is None:
                    break
                labels[number] = there.points
                poses = [poses[-1], there.q]
                number += step
            self._poses = poses if number > self._frame else []
        unlabelled = np.full(len(self.body.markers), HIDDEN, dtype=np.intp)
        self._waiting.clear()
        return [self._taken(points, labels.get(number, unlabelled)) for number, points in known.items()]

    def _unnamed(self, most: int) -> list[Array]:
        """The oldest frames, without names, so that no more than ``most`` wait."""
        unlabelled = np.full(len(self.body.markers), HIDDEN, dtype=np.intp)
        due = []
        while len(self._waiting) > most:
            due.append(labelled_points(self._waiting.popleft()[1], unlabelled))
        return due
