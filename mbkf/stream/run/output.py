"""Output of a live run: answers become rows of the log, and frames for every listener."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from numpy.typing import NDArray

from mbkf.filters.record import FrameRecorder
from mbkf.stream.receiving.alignment import Note, ReadyFrame
from mbkf.stream.results.frame import FrameSink, LiveFrame
from mbkf.stream.run.frame_maker import FrameMaker
from mbkf.stream.run.setup import LiveSetup
from mbkf.stream.run.statistics import RunStatistics
from mbkf.stream.run.unexplained import LoadWatch
from mbkf.stream.run.verdict import VerdictWatch
from mbkf.trial.live.filter import LiveStep


class RunOutput:
    """Logs and shows answered frames."""

    def __init__(
        self,
        setup: LiveSetup,
        sinks: Sequence[FrameSink],
        put_row: Callable[[NDArray], None],
        statistics: RunStatistics,
        note: Note,
        loads: LoadWatch,
        verdict: VerdictWatch,
    ) -> None:
        """Holds the listeners; one that raises an error is dropped.

        Args:
            setup: Makes log rows and listeners' frames.
            sinks: The listeners.
            put_row: Takes a row for the log.
            statistics: Counts latencies and starts.
            note: Called with events.
            loads: Judges the forces that no contact explains.
            verdict: Judges the run.
        """
        self._rows: FrameRecorder = setup.rows
        self._maker: FrameMaker = setup.maker
        self._sinks, self._opened = list(sinks), tuple(sinks)
        self._put_row, self._statistics, self._note = put_row, statistics, note
        self._loads, self._verdict = loads, verdict

    def arrived(self, arrival_s: float) -> None:
        """Counts a frame that arrived, for the rate shown."""
        self._maker.arrived(arrival_s)

    def put(self, ready: ReadyFrame, step: LiveStep, at_start: bool, lost: int, complete_s: float) -> None:
        """Logs and shows an answered frame.

        Args:
            ready: The frame, with its markers.
            step: The filter's answer.
            at_start: Whether the frame waited for a start of the filter, or until it had caught up.
            lost: Frames lost so far.
            complete_s: When the last frame arrived that the answer knows: this one, or that at the end of a lag.
        """
        assert ready.markers_m is not None
        if step.trouble is not None:
            self._note("numbers", f"the filter starts anew ({step.trouble})", step.number, 1)
        row, spread = self._rows.row(step.number, ready.markers_m, step.estimate, step.seconds)
        now = time.perf_counter()
        latency = now - ready.arrival_s
        if not ready.lost:
            self._statistics.processed += 1
            row["latency_s"] = latency
            self._statistics.answered(now - complete_s, at_start)
        if step.estimate is not None and step.estimate.started:
            self._statistics.starts += 1
            if self._statistics.starts > 1:
                self._note("start", "the filter started anew", step.number, 1)
        if spread is not None:
            self._rows.spread(row, spread)
        load = self._loads.push(ready, row)
        valid = self._verdict.push(row, load)
        if self._sinks:
            judged = load, valid, self._verdict.judgement
            self._show(self._maker.frame(ready, row, latency, lost, *judged), ready.number)
        if step.estimate is not None:
            self._rows.innovation(row, step.estimate)
        self._put_row(row)

    def close(self) -> None:
        """Tells the listeners that no more frames follow."""
        for sink in self._opened:
            try:
                sink.close()
            except Exception as error:  # the results are still to be written
                self._note("viewer", f"a listener failed at the end ({error})", None, 1)

    def _show(self, shown: LiveFrame, number: int) -> None:
        for sink in list(self._sinks):
            try:
                sink.take(shown)
            except Exception as error:  # a listener's error must not end a recording
                self._sinks.remove(sink)
                self._note("viewer", f"a listener failed and was dropped ({error})", number, 1)
