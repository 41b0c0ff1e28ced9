"""A live run from end to end: one thread reads the stream, one filters, one writes the log; listeners get frames."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from mbkf.io.results_folder import Summary
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.live.filter import live_settings
from mbkf.pipelines.reconstruct import ReconstructSettings
from mbkf.stream.receiving.receiver import Receiver
from mbkf.stream.results.frame import FrameSink
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.folder import LOG_FOLDER, drop_log, open_log, write_results
from mbkf.stream.run.log_writer import LogWriter
from mbkf.stream.run.loop import TIME_OVER, FilterLoop
from mbkf.stream.run.low_latency import low_latency
from mbkf.stream.run.output import RunOutput
from mbkf.stream.run.report import LIVE_FILE, ReportFile
from mbkf.stream.run.setup import LiveSetup, prepare
from mbkf.stream.run.statistics import RunStatistics
from mbkf.stream.source import FrameSource

RUNNING = "running"
"""State of a run in live.json until it has ended."""


@dataclass(frozen=True)
class LiveOutcome:
    """How a run ended.

    Attributes:
        report: The contents of live.json.
        summary: The contents of summary.json; None where no results could be made.
        problem: Why not.
        failed: Whether an unforeseen error ended the run.
    """

    report: dict[str, object]
    summary: Summary | None
    problem: str | None
    failed: bool = False


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
    ) -> None:
        """A run that is not connected yet.

        Args:
            source: Where frames come from.
            subject: The scaled person.
            settings: The filter and its settings; the answer is causal, or has their lag.
            folder: For the results.
            source_name: Name of the source, for messages and live.json.
            scaling: How the person was scaled from the stream, for live.json.

        Raises:
            InvalidInput: Smoothing is asked for.
        """
        self._source, self._subject, self._settings = source, subject, live_settings(settings)
        self._folder, self._source_name = folder, source_name
        self._scaling = {} if scaling is None else {"scaling": dict(scaling)}
        self._events = EventLog()
        self._setup: LiveSetup | None = None

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source and prepares the filter for its stream; False where it was stopped first.

        Args:
            stop: Set when the run is to end.
            patience_s: How long to wait at most; None for as long as it takes.

        Raises:
            InvalidInput: The source did not appear in time.
            MbkfError: The stream does not suit the subject, or cannot be read.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is None:
            return False
        self._setup = prepare(found, self._subject, self._settings, self._source.patient, self._events.note)
        return True

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
        report = ReportFile(self._folder / LIVE_FILE)
        log = open_log(
            self._folder, setup.stream, setup.rows.dtype, self._settings, setup.names, self._subject
        )

        def report_running() -> None:
            report.write(self._report(RUNNING, receiver, statistics))

        def log_died(error: Exception) -> None:
            died.append(error)
            note("failed", f"writing the log failed ({type(error).__name__}: {error})")
            receiver.stop()

        died: list[Exception] = []
        writer = LogWriter(log, self._disk_failed, report_running, log_died)
        receiver = Receiver(
            self._source, setup.stream, setup.columns, writer.put_samples, note, self._subject.mass_kg
        )
        output = RunOutput(setup, sinks, writer.put_row, statistics, note)
        loop = FilterLoop(setup, receiver, output, statistics, note)
        with single_threaded(), low_latency():
            writer.start()
            receiver.start()
            ended_by = loop.run(stop, seconds)
            receiver.stop()
        try:
            self._source.close()
        except (
            Exception
        ) as error:  # libraries of sources raise errors of any kind; the results are still to be made
            note("source", f"the source could not be closed ({type(error).__name__}: {error})")
        output.close()
        unwritten = writer.close()
        summary, problem = self._write_results()
        if statistics.latest is None or (problem is None and not unwritten and not keep_log):
            drop_log(self._folder)
        kept = self._folder / LOG_FOLDER
        threads = [error for error in (receiver.failure, *died) if error is not None]
        if threads:
            ended_by = f"an unforeseen {type(threads[0]).__name__}: {threads[0]}"
        left = receiver.left
        of_the_run = left if ended_by != TIME_OVER else 0
        plain = self._report(
            "finished" if problem is None else "results missing",
            receiver,
            statistics,
            ended_by=ended_by,
            frames_written=statistics.answered_frames - unwritten,
            frames_not_written=unwritten,
            frames_in=receiver.counts()["frames_in"] - left + of_the_run,
            frames_unanswered=of_the_run + statistics.processed - statistics.answered_frames,
            log=str(kept) if kept.is_dir() else None,
        )
        report.write(plain, last=True)
        return LiveOutcome(plain, summary, problem, failed=loop.failed or bool(threads))

    def _write_results(self) -> tuple[Summary | None, str | None]:
        """The results from the log: their summary, or why there are none."""
        notes = tuple(f"live: {event['what']} ({event['count']} times)" for event in self._events.plain())
        summary, problem = write_results(self._folder, notes)
        if problem is not None:
            self._events.note("results", f"the results could not be written: {problem}")
        return summary, problem

    def _disk_failed(self, error: OSError) -> None:
        why = error.strerror or error
        self._events.note(
            "disk", f"the log could not be written ({why}); rows are held in memory and tried again"
        )

    def _report(
        self, state: str, receiver: Receiver, statistics: RunStatistics, **more: object
    ) -> dict[str, object]:
        """The contents of live.json."""
        stream = self.setup.stream
        return {
            "state": state,
            "source": self._source_name,
            "trial": stream.trial,
            "filter": self._settings.filter,
            "lag_ms": 1e3 * self.setup.filter.lag_frames / stream.rate_hz,
            **receiver.counts(),
            "frames_processed": statistics.processed,
            **statistics.latencies(recent=state == RUNNING),
            **statistics.rates(stream.rate_hz),
            **self._scaling,
            **more,
            "events": self._events.plain(),
        }
