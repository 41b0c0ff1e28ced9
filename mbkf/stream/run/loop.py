"""The filter's loop of a live run: takes frames from the ring buffer, bridges gaps, and answers each frame."""

from __future__ import annotations

import threading
import time
from collections import deque

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.receiving.alignment import BRIDGED_S, Note, ReadyFrame
from mbkf.stream.receiving.reader import SILENT_S
from mbkf.stream.receiving.receiver import START_SLACK_S, Receiver
from mbkf.stream.run.failure import Failure
from mbkf.stream.run.output import RunOutput
from mbkf.stream.run.setup import LiveSetup
from mbkf.stream.run.statistics import RunStatistics
from mbkf.trial.live.filter import LiveStep

TAKE_S = 0.1
"""Longest wait for a frame before the loop checks for its end."""


class FilterLoop:
    """Gives frames to the filter and its answers to the output.

    Attributes:
        until: Number of the last frame asked for; None where the run did not end by time.
    """

    def __init__(
        self,
        setup: LiveSetup,
        receiver: Receiver,
        output: RunOutput,
        statistics: RunStatistics,
        note: Note,
        failure: Failure,
    ) -> None:
        """Connects the parts of a run.

        Args:
            setup: The prepared filter, and the labeller if points have no names.
            receiver: Gives frames.
            output: Takes answers.
            statistics: Counts frames.
            note: Called with events.
            failure: Failures of other threads; after one, received frames are answered and the run ends.
        """
        self._failure = failure
        self.until: int | None = None
        self._setup, self._receiver, self._output = setup, receiver, output
        self._statistics, self._note = statistics, note
        self._waiting: deque[ReadyFrame] = deque()
        self._starting_until_s = 0.0
        self._silent = False

    def run(self, stop: threading.Event, seconds: float | None) -> str:
        """Answers frames until the run ends, and returns its cause in words; an unforeseen error keeps the results.

        ``seconds`` is the time to track from the first frame, None for as long as frames come.
        """
        ended_by = ""
        try:
            ended_by = self._track(stop, seconds)
            labels = self._setup.labels
            for frame, markers in [] if labels is None else labels.finish():
                self._feed(frame, markers)
            self._answer(self._setup.filter.finish())
        except Exception as error:
            self._failure.of("the filter", error)
        return self._failure.cause or ended_by

    def _track(self, stop: threading.Event, seconds: float | None) -> str:
        """Answers frames until something ends the run, and returns that."""
        statistics = self._statistics
        while not stop.is_set():
            if self._failure.cause is not None:
                self._receiver.stop()
            frame = self._receiver.take(TAKE_S)
            now = time.perf_counter()
            first, latest = statistics.first, statistics.latest
            if frame is not None:
                self._take(frame)
                self._allow_for_start()
                self._setup.filter.predict()
                first, latest = statistics.first, statistics.latest
            elif self._receiver.ended:
                return "the source ended"
            elif latest is not None and now - latest.arrival_s > SILENT_S and not self._silent:
                self._silent = True
                self._note("silent", "the source fell silent and is waited for", latest.number, 1)
            if seconds is not None and first is not None and latest is not None:
                tracked = (latest.number - first.number + 1) / self._setup.stream.rate_hz
                over = frame is None and now - first.arrival_s >= seconds
                if over or tracked >= seconds:
                    self.until = latest.number
                    return "the time was over"
        return "it was stopped"

    def _take(self, frame: ReadyFrame) -> None:
        """One frame from the ring buffer; overwritten ones before it are bridged, or the filter starts anew."""
        if self._silent:
            self._silent = False
            self._note("back", "the source is back", frame.number, 1)
        before = self._statistics.taken(frame)
        if before is not None and frame.number > before.number + 1:
            if frame.number - before.number <= BRIDGED_S * self._setup.stream.rate_hz:
                plates = dict(frame.left_out)
                for number in range(before.number + 1, frame.number):
                    self._push(self._unseen_frame(number, frame.arrival_s, plates.get(number)))
            else:
                self._note("cut", "a gap was too long to bridge: the filter starts anew", frame.number, 1)
                self._answer(self._setup.filter.cut())
        if not frame.lost:
            self._output.arrived(frame.arrival_s)
        self._push(frame)

    def _allow_for_start(self) -> None:
        """Lets more frames wait while the filter starts, and until it has caught up."""
        now = time.perf_counter()
        if self._setup.filter.latest is None:
            self._starting_until_s = now + START_SLACK_S
            self._receiver.allow_start()
        elif self._starting_until_s and (self._receiver.empty or now > self._starting_until_s):
            self._starting_until_s = 0.0
            self._receiver.allow_pause()

    def _unseen_frame(self, number: int, arrival_s: float, plates: Array | None) -> ReadyFrame:
        """A frame without markers; its plates count, as they do in the log."""
        if plates is None:
            plates = np.full((len(self._setup.stream.plates), 6), np.nan)
        unseen = np.full((len(self._setup.names), 3), np.nan)
        return ReadyFrame(number, arrival_s, unseen, np.zeros((0, 3)), plates, lost=True)

    def _push(self, frame: ReadyFrame) -> None:
        """Gives the filter a frame, or those whose points have been named by now."""
        labels = self._setup.labels
        if labels is None:
            assert frame.markers_m is not None
            self._feed(frame, frame.markers_m)
            return
        due = labels.push(frame, self._setup.filter.predict())
        for one, markers in due:
            self._feed(one, markers)
        latest = self._setup.filter.latest
        if due and latest is not None:
            labels.learn(latest)

    def _feed(self, frame: ReadyFrame, markers_m: Array) -> None:
        named = frame if markers_m is frame.markers_m else frame._replace(markers_m=markers_m)
        self._waiting.append(named)
        self._answer(self._setup.filter.push(frame.number, self._setup.frame(frame, markers_m)))

    def _answer(self, steps: list[LiveStep]) -> None:
        """Gives answers to the output, each with its frame."""
        lag = self._setup.filter.lag_frames
        for step in steps:
            at_start = step.awaited or self._starting_until_s > 0.0
            ready = self._waiting.popleft()
            later = min(lag, len(self._waiting))
            last = self._waiting[later - 1] if later else ready
            self._output.put(ready, step, at_start, self._receiver.lost, last.arrival_s)
