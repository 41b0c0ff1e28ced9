"""A live run from end to end: a thread reads the stream, this one filters, another writes, listeners are shown."""

from __future__ import annotations

import threading
import time
from array import array
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.record import FrameRecorder
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.live.filter import LiveFilter, LiveStep, live_inputs
from mbkf.pipelines.live.labels import live_body
from mbkf.pipelines.reconstruct import ReconstructSettings
from mbkf.pipelines.trial.followers import follower
from mbkf.stream.receiving.alignment import BRIDGED_S, Intake, ReadyFrame
from mbkf.stream.receiving.reader import Reader
from mbkf.stream.receiving.ring_buffer import Slot
from mbkf.stream.results.frame import FrameSink
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import Events
from mbkf.stream.run.folder import LOG_FOLDER, drop_log, open_log, write_results
from mbkf.stream.run.frame_maker import FrameMaker
from mbkf.stream.run.log_writer import LogWriter
from mbkf.stream.run.low_latency import prompt
from mbkf.stream.run.point_names import PointNames
from mbkf.stream.run.report import LIVE_FILE, ReportFile, latency_summary
from mbkf.stream.source import FrameSource, StreamDescription

SLACK_S, START_SLACK_S = 0.25, 5.0
"""The slot holds the frames of this time: what a hiccup of the machine takes, and what a start with its search does."""

RUNNING, RECENT_FRAMES = "running", 5000
"""While a run goes on, its latencies are those of so many frames."""

SILENT_S = 1.0
"""A stream that says nothing for this long is told of."""


@dataclass(frozen=True)
class LiveOutcome:
    """How a run ended.

    Attributes:
        report: The contents of live.json.
        summary: The contents of summary.json; None where no results could be made.
        problem: Why not.
    """

    report: dict[str, Any]
    summary: dict[str, Any] | None
    problem: str | None


class LiveSession:
    """One live run.

    Attributes:
        stream: What the source says, once it is connected.
        names: (M,) markers followed.
        model: The body.
    """

    def __init__(
        self,
        source: FrameSource,
        subject: Subject,
        settings: ReconstructSettings,
        folder: Path,
        source_name: str,
        scaling: Mapping[str, Any] | None = None,
    ) -> None:
        """Args: as follows.

        source: Where frames come from.
        subject: The scaled person.
        settings: The filter and its settings.
        folder: For the results.
        source_name: What to call the source.
        scaling: How the person was scaled from the stream, for live.json.
        """
        self._source, self._subject, self._settings = source, subject, settings
        self._folder, self._source_name = folder, source_name
        self._scaling = {} if scaling is None else {"scaling": dict(scaling)}
        self._begin_s = time.perf_counter()
        self._events = Events()
        self._latencies, self._at_start = array("d"), array("d")
        self._processed = self._starts = 0
        self._first: ReadyFrame | None = None
        self._latest: ReadyFrame | None = None
        self._starting_until_s = 0.0
        self._waiting: deque[ReadyFrame] = deque()
        self._silent = False
        self._sinks: list[FrameSink] = []

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source; False where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most.

        Raises:
            InvalidInput: The source did not appear in time.
            MbkfError: It is not what it should be.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is not None:
            self._prepare(found)
        return found is not None

    def _prepare(self, stream: StreamDescription) -> None:
        self.stream = stream
        wanted = stream.marker_names or live_body(self._subject).names
        with single_threaded():
            self._live = live_inputs(wanted, stream.rate_hz, stream.plates, self._subject, self._settings)
            self._follower = follower(self._settings.filter, self._live.inputs)
        self.names = self._live.names
        self.model = self._live.inputs.sensor.model
        self._filter = LiveFilter(self._follower)
        self._maker = FrameMaker(self._live, stream.rate_hz)
        self._rows = FrameRecorder(self._follower, len(self.names))
        self._named_here = None
        if not stream.marker_names:
            patient = self._source.patient
            self._named_here = PointNames(
                self._subject, self.names, 1.0 / stream.rate_hz, patient, self._note
            )

    @property
    def plate_corners_m(self) -> Array:
        """(K, 4, 3) corners of the plates, NaN where they are not known."""
        unknown = np.full((4, 3), np.nan)
        plates = self.stream.plates
        corners = [unknown if plate.corners_m is None else plate.corners_m for plate in plates]
        return np.array(corners).reshape(-1, 4, 3)

    def run(
        self,
        stop: threading.Event,
        sinks: Sequence[FrameSink] = (),
        seconds: float | None = None,
        keep_log: bool = False,
    ) -> LiveOutcome:
        """Follows the stream until it is stopped, it ends or the time is over, and writes the results.

        Args:
            stop: Set when the run is to end.
            sinks: Who is shown each frame.
            seconds: How long to follow, from the first frame.
            keep_log: Whether the log stays beside the results.

        Raises:
            OSError: Nothing can be written to the folder.
        """
        self._sinks = list(sinks)
        report = ReportFile(self._folder / LIVE_FILE)
        log = open_log(self._folder, self.stream, self._rows.dtype, self._settings, self.names, self._subject)
        writer = LogWriter(log, self._disk_failed, lambda: report.write(self._report(RUNNING)))
        columns = self._live.columns if self.stream.marker_names else None
        intake = Intake(self.stream, columns, self._note)
        slot: Slot[ReadyFrame] = Slot(round(START_SLACK_S * self.stream.rate_hz), self._source.patient)
        reader = Reader(self._source, intake, slot, writer.put_samples, self._note_unplaced)
        self._intake, self._slot, self._writer, self._reader = intake, slot, writer, reader
        with single_threaded(), prompt():
            reader.start()
            ended_by = self._guarded(stop, seconds)
            reader.stop()
        self._source.close()
        for sink in self._sinks:
            sink.close()
        unwritten = writer.close()
        return self._finish(report, ended_by, unwritten, keep_log)

    def _guarded(self, stop: threading.Event, seconds: float | None) -> str:
        """Follows the stream and says what ended it; what was found until then is kept whatever happens."""
        try:
            ended_by = self._follow(stop, seconds)
            for frame, markers in [] if self._named_here is None else self._named_here.finish():
                self._feed(frame, markers)
            self._answer(self._filter.finish())
        except Exception as error:
            ended_by = f"an unforeseen {type(error).__name__}: {error}"
            self._note("failed", ended_by, None if self._latest is None else self._latest.number, 1)
        return ended_by

    def _follow(self, stop: threading.Event, seconds: float | None) -> str:
        """Answers frames until something ends it; says what did."""
        while not stop.is_set():
            frame = self._slot.take(0.1)
            now = time.perf_counter()
            if frame is not None:
                self._take(frame)
                self._give_time()
                self._filter.expect()
            elif self._slot.ended:
                return "the source ended"
            elif self._latest is not None and now - self._latest.arrival_s > SILENT_S and not self._silent:
                self._silent = True
                self._note("silent", "the source fell silent and is waited for", self._latest.number, 1)
            if seconds is not None and self._first is not None and self._latest is not None:
                followed = (self._latest.number - self._first.number + 1) / self.stream.rate_hz
                over = frame is None and now - self._first.arrival_s >= seconds
                if over or followed >= seconds:
                    return "the time was over"
        return "it was stopped"

    def _take(self, frame: ReadyFrame) -> None:
        """One frame from the slot; those that were overwritten before it are bridged, or what follows starts anew."""
        if self._silent:
            self._silent = False
            self._note("back", "the source is back", frame.number, 1)
        before, self._latest = self._latest, frame
        if self._first is None:
            self._first = frame
        if before is not None and frame.number > before.number + 1:
            if frame.number - before.number <= BRIDGED_S * self.stream.rate_hz:
                for number in range(before.number + 1, frame.number):
                    self._push(self._nothing(number, frame.arrival_s))
            else:
                self._note("cut", "a gap was too long to bridge: the filter starts anew", frame.number, 1)
                self._answer(self._filter.cut())
        if not frame.lost:
            self._processed += 1
            self._maker.arrived(frame.arrival_s)
        self._push(frame)

    def _give_time(self) -> None:
        """While the filter starts, and until it has caught up with what came meanwhile, more frames may wait."""
        now = time.perf_counter()
        if self._filter.latest is None:
            self._starting_until_s = now + START_SLACK_S
            self._slot.allow(round(START_SLACK_S * self.stream.rate_hz))
        elif self._starting_until_s and (not self._slot.left() or now > self._starting_until_s):
            self._starting_until_s = 0.0
            self._slot.allow(round(SLACK_S * self.stream.rate_hz))

    def _nothing(self, number: int, arrival_s: float) -> ReadyFrame:
        plates = np.full((len(self.stream.plates), 6), np.nan)
        unseen = np.full((len(self.names), 3), np.nan)
        return ReadyFrame(number, arrival_s, unseen, np.zeros((0, 3)), plates, lost=True)

    def _push(self, frame: ReadyFrame) -> None:
        """Gives the filter a frame, or those whose points have been named by now."""
        if self._named_here is None:
            assert frame.markers_m is not None
            self._feed(frame, frame.markers_m)
            return
        due = self._named_here.push(frame, self._filter.expect())
        for one, markers in due:
            self._feed(one, markers)
        latest = self._filter.latest
        if due and latest is not None:
            self._named_here.learn(latest)

    def _feed(self, frame: ReadyFrame, markers_m: Array) -> None:
        self._waiting.append(replace(frame, markers_m=markers_m))
        self._answer(self._filter.push(frame.number, markers_m, frame.plates))

    def _answer(self, steps: list[LiveStep]) -> None:
        """Logs and shows what is due."""
        for step in steps:
            ready = self._waiting.popleft()
            assert ready.markers_m is not None
            if step.trouble is not None:
                self._note("numbers", f"the filter starts anew ({step.trouble})", step.number, 1)
            row, spread = self._rows.row(step.number, ready.markers_m, step.estimate, step.seconds)
            latency = time.perf_counter() - ready.arrival_s
            if not ready.lost:
                row["latency_s"] = latency
                waited = step.awaited or self._starting_until_s > 0.0
                (self._at_start if waited else self._latencies).append(latency)
            if step.estimate is not None and step.estimate.started:
                self._starts += 1
                if self._starts > 1:
                    self._note("start", "the filter started anew", step.number, 1)
            self._show(ready, row, latency)
            self._rows.complete(row, step.estimate, spread)
            self._writer.put_row(row)

    def _show(self, ready: ReadyFrame, row: np.ndarray, latency_s: float) -> None:
        if not self._sinks:
            return
        shown = self._maker.frame(ready, row, latency_s, self._lost)
        for sink in list(self._sinks):
            try:
                sink.take(shown)
            except Exception as error:  # whoever looks on must not end a recording
                self._sinks.remove(sink)
                self._note("viewer", f"a listener failed and was dropped ({error})", ready.number, 1)

    @property
    def _lost(self) -> int:
        return self._intake.lost + self._reader.overwritten

    def _note(self, kind: str, what: str, frame: int | None, count: int) -> None:
        self._events.note(kind, what, time.perf_counter() - self._begin_s, frame, count)

    def _note_unplaced(self, kind: str, what: str) -> None:
        self._note(kind, what, None, 1)

    def _disk_failed(self, error: OSError) -> None:
        self._note(
            "disk",
            f"the log could not be written ({error.strerror or error}); rows are held in memory and tried again",
            None,
            1,
        )

    def _report(self, state: str, **more: Any) -> dict[str, Any]:
        first, latest = self._first, self._latest
        rate = None
        if first is not None and latest is not None and latest.arrival_s > first.arrival_s:
            rate = (self._processed - 1) / (latest.arrival_s - first.arrival_s)
        left = sum(not frame.lost for frame in self._slot.left())
        recent = RECENT_FRAMES if state == RUNNING else 0
        return {
            "state": state,
            "source": self._source_name,
            "trial": self.stream.trial,
            "filter": self._settings.filter,
            "frames_in": self._intake.frames_in - left,
            "frames_lost": self._lost,
            "frames_lost_on_the_way": self._intake.lost,
            "frames_overwritten": self._reader.overwritten,
            "frames_processed": self._processed,
            **latency_summary(self._latencies[-recent:], self._at_start[-recent:]),
            "rate_hz": rate,
            "nominal_rate_hz": self.stream.rate_hz,
            "starts": self._starts,
            **self._scaling,
            **more,
            "events": self._events.plain(),
        }

    def _finish(self, report: ReportFile, ended_by: str, unwritten: int, keep_log: bool) -> LiveOutcome:
        """The results from the log; where they cannot be made, the log stays."""
        log = self._folder / LOG_FOLDER
        notes = tuple(f"live: {event['what']} ({event['count']} times)" for event in self._events.plain())
        summary, problem = write_results(self._folder, notes)
        if problem is not None:
            self._note("results", f"the results could not be written: {problem}", None, 1)
        complete = problem is None and not unwritten
        if not self._latest or (complete and not keep_log):
            drop_log(self._folder)
        plain = self._report(
            "finished" if problem is None else "results missing",
            ended_by=ended_by,
            frames_not_written=unwritten,
            log=str(log) if log.is_dir() else None,
        )
        report.write(plain, last=True)
        return LiveOutcome(plain, summary, problem)
