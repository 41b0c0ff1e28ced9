"""Names for the points of a stream that has none, and the frames that wait for them."""

from __future__ import annotations

from collections import deque

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.estimate import Posterior, Prediction
from mbkf.io.subject import Subject
from mbkf.stream.receiving.alignment import Note, ReadyFrame
from mbkf.trial.live.filter import NUMERICAL
from mbkf.trial.live.labels import LiveLabels, live_body

NamedFrames = list[tuple[ReadyFrame, Array]]
"""Frames with their markers (M, 3)."""


class PointNames:
    """Holds frames until their points have names."""

    def __init__(
        self, subject: Subject, names: tuple[str, ...], dt_s: float, patient: bool, note: Note
    ) -> None:
        """A labeller that has seen no frame yet.

        Args:
            subject: The scaled person.
            names: (M,) markers tracked.
            dt_s: Time step, s.
            patient: Whether the source waits for a slow reader.
            note: Called with events.
        """
        self._body = live_body(subject, names)
        self._dt_s, self._patient, self._note = dt_s, patient, note
        self._waiting: deque[ReadyFrame] = deque()
        self._labels = self._fresh()

    def push(self, frame: ReadyFrame, prediction: Prediction | None) -> NamedFrames:
        """Takes a frame, with the filter's prediction of it (None before a start); gives back those that are due."""
        self._waiting.append(frame)
        try:
            return self._due(self._labels.push(frame.unlabelled_m, prediction))
        except NUMERICAL as error:
            self._note("labels", f"labels are searched anew ({error})", frame.number, 1)
            self._labels = self._fresh()
            unseen = np.full((len(self._body.names), 3), np.nan)
            unnamed = [(one, unseen) for one in self._waiting]
            self._waiting.clear()
            return unnamed

    def learn(self, estimate: Posterior) -> None:
        """Takes the filter's estimate of the frame pushed last."""
        self._labels.learn(estimate.q)

    def finish(self) -> NamedFrames:
        """The frames that still wait, when no more follow."""
        return self._due(self._labels.finish())

    def _fresh(self) -> LiveLabels:
        return LiveLabels(self._body, self._dt_s, patient=self._patient)

    def _due(self, found: list[Array]) -> NamedFrames:
        return [(self._waiting.popleft(), markers) for markers in found]
