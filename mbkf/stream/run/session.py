"""A live run from end to end: one thread reads the stream, one filters, one writes the log; listeners get frames."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.io.results_folder import Summary
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.stream.receiving.receiver import FrameCounts, Receiver
from mbkf.stream.results.frame import FrameSink
from mbkf.stream.run.checking import LiveChecks
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.failure import Failure
from mbkf.stream.run.folder import LOG_FOLDER, WrittenResults, drop_log, open_log, write_results
from mbkf.stream.run.log_writer import LogWriter
from mbkf.stream.run.loop import FilterLoop
from mbkf.stream.run.low_latency import low_latency
from mbkf.stream.run.output import RunOutput
from mbkf.stream.run.recording import WrittenRecording, write_recording
from mbkf.stream.run.report import LIVE_FILE, ReportFile, frame_report
from mbkf.stream.run.setup import LiveSetup, prepare, prepare_sensors
from mbkf.stream.run.statistics import RunStatistics
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.stream.run.verdict import VerdictWatch
from mbkf.stream.source import FrameSource
from mbkf.trial.live.filter import live_settings
from mbkf.trial.live.log import LiveLog
from mbkf.trial.preparation.settings import ReconstructSettings, recorded

if TYPE_CHECKING:
    from mbkf.trial.live.worn import LiveWorn

NOTICES = ("person", "names", "chosen")
"""Kinds of events that stand beside the running verdict."""

RUNNING = "running"
"""State of a run in live.json until it has ended."""


@dataclass(frozen=True)
class LiveOutcome:
    """Outcome of a run.

    Attributes:
        report: The contents of live.json.
        summary: The contents of summary.json; None where no results could be made.
        problem: The reason.
        failure: Failure that ended the run early, in words; None without one.
        unreported: The reason why live.json does not tell of the run's end; None where it does.
    """

    report: dict[str, object]
    summary: Summary | None
    problem: str | None
    failure: str | None = None
    unreported: str | None = None


class LiveSession:
    """One live run: connect, then run."""

    def __init__(
        self,
        source: FrameSource,
        subject: Subject,
        settings: ReconstructSettings,
        folder: Path,
        source_name: str,
        scaling: Mapping[str, object] | None = None,
        sensors: LiveWorn | None = None,
        record: Path | None = None,
    ) -> None:
        """A run that is not connected yet.

        Args:
            source: Where frames come from.
            subject: The scaled person.
            settings: The filter and its settings; the answer is causal, or has their lag.
            folder: For the results.
            source_name: Name of the source, for messages and live.json.
            scaling: How the person was scaled from the stream, or sensors were calibrated, for live.json.
            sensors: The stream's inertial sensors, if these alone show the person.
            record: C3D file that all that the stream brings is written to; None for no recording.

        Raises:
            InvalidInput: Smoothing is asked for.
        """
        self._source, self._subject, self._settings = source, subject, live_settings(settings)
        self._folder, self._source_name = folder, source_name
        begin = "scaling" if sensors is None else "calibration"
        self._scaling = {} if scaling is None else {begin: dict(scaling)}
        self._events, self._sensors, self._record = EventLog(), sensors, record
        self._setup: LiveSetup | None = None

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source and prepares the filter for its stream; False where it was stopped first.

        ``patience_s`` is the longest wait, None for as long as it takes.

        Raises:
            InvalidInput: The source did not appear in time.
            MbkfError: The stream does not suit the subject, or cannot be read.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is None:
            return False
        if self._sensors is not None:
            self._setup = prepare_sensors(self._sensors, self._settings, found)
        else:
            known = self._subject, self._settings
            self._setup = prepare(found, *known, self._source.patient, self._events.note)
        return True

    def note(self, kind: str, what: str) -> None:
        """Records an event of the run: one word, and a sentence."""
        self._events.note(kind, what)

    @property
    def setup(self) -> LiveSetup:
        """The stream, markers, body and filter; only after :meth:`connect`."""
        assert self._setup is not None, "connect first"
        return self._setup

    def run(
        self,
        stop: threading.Event,
        sinks: Sequence[FrameSink] = (),
        seconds: float | None = None,
        keep_log: bool = False,
    ) -> LiveOutcome:
        """Tracks the stream until it is stopped, it ends or the time is over, and writes the results.

        Args:
            stop: Set when the run is to end.
            sinks: Listeners, which receive each frame.
            seconds: How long to track, from the first frame.
            keep_log: Whether the log stays beside the results.

        Raises:
            OSError: Nothing can be written to the folder.
        """
        setup, note, statistics = self.setup, self._events.note, RunStatistics()
        failure, loads = Failure(), LoadWatch(setup.live, setup.stream.rate_hz, note)
        log, report = self._begun(setup)
        checks = LiveChecks(log.folder, setup.stream.rate_hz, note) if setup.sensors is None else None

        def report_running() -> None:
            counts, found = receiver.counts(), {**loads.lists(), **verdict.plain()}
            with suppress(OSError):  # the disk is full; the next one may have room
                report.write(self._report(RUNNING, counts, statistics, 0, **found))

        writer = LogWriter(log, self._disk_failed, report_running, partial(failure.of, "writing the log"))
        notices = partial(self._notices, loads)
        verdict = VerdictWatch(setup, self._subject, loads, note, checks, writer.put_doubt, notices)
        receiver = Receiver(
            self._source,
            setup.stream,
            setup.columns,
            writer.put_samples,
            note,
            self._subject.mass_kg,
            partial(failure.of, "reading the stream"),
            writer.record,
        )
        output = RunOutput(setup, sinks, writer.put_row, statistics, note, loads, verdict)
        loop = FilterLoop(setup, receiver, output, statistics, note, failure)
        with single_threaded(), low_latency():
            receiver.start()
            ended_by = loop.run(stop, seconds)
            receiver.stop()
        self._close_source()
        if checks is not None:
            checks.close()
        verdict.end()
        output.close()
        logged, unlogged = writer.close()
        self._note_end(failure, logged, unlogged, writer.unrecorded)
        recording, written = self._write_recording(), self._write_results()
        final = None if written.summary is None else written.summary["verdict"]
        needed = keep_log or written.problem is not None or unlogged or written.left_out
        if recording.problem is None and not (needed and statistics.latest is not None):
            drop_log(self._folder)
        kept = self._folder / LOG_FOLDER
        plain = self._report(
            "results missing"
            if written.problem is not None
            else "finished"
            if failure.cause is None
            else "failed",
            receiver.counts(loop.until),
            statistics,
            unlogged,
            **loads.lists(),
            **(verdict.plain() | {"verdict": final}),
            ended_by=ended_by,
            frames_written=logged,
            frames_not_written=unlogged,
            log=str(kept) if kept.is_dir() else None,
            **recording.plain(),
        )
        return LiveOutcome(
            plain, written.summary, written.problem, failure.cause, _last_report(report, plain)
        )

    def _notices(self, loads: LoadWatch) -> tuple[str, ...]:
        """Remarks beside the running verdict: events on the stream, and contacts of other parts than the feet."""
        return (*self._events.sentences(NOTICES), *loads.contacts.sentences())

    def _begun(self, setup: LiveSetup) -> tuple[LiveLog, ReportFile]:
        """The log and live.json of a run that begins; where one of them cannot be made, what was there stays."""
        settings = {**recorded(self._settings), **setup.extra_settings}
        known = settings, setup.names, self._subject
        log = open_log(self._folder, setup.stream, setup.rows.dtype, *known, self._record)
        try:
            return log, ReportFile(self._folder / LIVE_FILE)
        except BaseException:
            log.close()
            drop_log(self._folder)
            raise

    def _close_source(self) -> None:
        try:
            self._source.close()
        except Exception as error:  # the results are still to be written
            self._events.note("source", f"the source failed at the end ({type(error).__name__}: {error})")

    def _note_end(self, failure: Failure, logged: int, unlogged: int, unrecorded: int) -> None:
        """Events of the end: a failure, and frames that are not in the log or the recording."""
        note = self._events.note
        if failure.cause is not None:
            note("failed", failure.cause)
        if unlogged:
            note(
                "disk",
                f"{unlogged} of {logged + unlogged} answered frames are not in the log, nor in the results",
            )
        if unrecorded:
            note(
                "recording", f"recording: {unrecorded} frames could not be written, and are gaps of the file"
            )

    def _write_recording(self) -> WrittenRecording:
        """The C3D file of the recording, from the log."""
        found = write_recording(self._folder)
        for sentence in found.sentences:
            self._events.note("recording", sentence)
        return found

    def _write_results(self) -> WrittenResults:
        """The results from the log, or the reason why there are none."""
        notes = tuple(f"live: {event['what']} ({event['count']} times)" for event in self._events.plain())
        written = write_results(self._folder, notes)
        for sentence in written.left_out:
            self._events.note("log", sentence)
        if written.problem is not None:
            self._events.note("results", f"the results could not be written: {written.problem}")
        return written

    def _disk_failed(self, error: OSError) -> None:
        why = error.strerror or error
        self._events.note(
            "disk", f"the log could not be written ({why}); rows are held in memory and tried again"
        )

    def _report(
        self, state: str, counts: FrameCounts, statistics: RunStatistics, unlogged: int = 0, **more: object
    ) -> dict[str, object]:
        """The contents of live.json."""
        stream = self.setup.stream
        return {
            "state": state,
            "source": self._source_name,
            "trial": stream.trial,
            "filter": self._settings.filter,
            "lag_ms": 1e3 * self.setup.filter.lag_frames / stream.rate_hz,
            **frame_report(counts, statistics.processed, unlogged, running=state == RUNNING),
            **statistics.latencies(recent=state == RUNNING),
            **statistics.rates(stream.rate_hz),
            **self._scaling,
            **more,
            "events": self._events.plain(),
        }


def _last_report(report: ReportFile, plain: Mapping[str, object]) -> str | None:
    """Writes live.json for the last time; the reason, where that fails."""
    try:
        report.write(plain, last=True)
    except OSError as error:
        return f"writing the report failed: {error}"
    return None
