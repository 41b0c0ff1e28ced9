"""The beginning of a live run in which the person stands still: frames, prompts and live.json until then."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Generic, TypeVar

from mbkf.errors import InvalidInput
from mbkf.numerics.threads import single_threaded
from mbkf.stream.receiving.reader import SILENT_S, next_frame
from mbkf.stream.run.connecting import wait_for
from mbkf.stream.run.events import EventLog
from mbkf.stream.run.low_latency import low_latency
from mbkf.stream.run.prompting import Prompting
from mbkf.stream.run.report import LIVE_FILE, ReportFile
from mbkf.stream.source import FrameSource, SourceFrame, StreamDescription

REPORT_S = 0.5
"""Interval at which live.json is brought up to date."""

STANDING = "standing"
"""State in live.json while the person is to stand still."""

Found = TypeVar("Found")


class StillStart(Generic[Found]):
    """Reads a stream until the person has stood still and the rest can begin.

    Attributes:
        stream: The stream's description, once the source is connected.
        request: Sentence for the person.
        failed_state: State in live.json after an end without a result.
        goal: Past clause of the result, for messages: "a person was scaled".
    """

    stream: StreamDescription
    request: str
    failed_state: str
    goal: str

    def __init__(
        self, source: FrameSource, source_name: str, folder: Path, say: Callable[[str], None]
    ) -> None:
        """A start that is not connected yet.

        Args:
            source: The source of frames.
            source_name: Name of the source, for messages and live.json.
            folder: For the results.
            say: Takes sentences for the person.
        """
        self._source, self._source_name, self._folder = source, source_name, folder
        self._events = EventLog()
        self._prompting = Prompting(say, self._events)
        self._heard_s = self._events.begin_s
        self._frames_in, self._uncounted_s = 0, 0.0

    def connect(self, stop: threading.Event, patience_s: float | None) -> bool:
        """Waits for the source, ``patience_s`` at most; False where it was stopped first.

        Raises:
            InvalidInput: The source did not appear in time, or its stream does not suit.
            MbkfError: The stream cannot be read.
        """
        found = wait_for(self._source, self._source_name, stop, patience_s)
        if found is not None:
            self.stream = found
            self._begin(found)
        return found is not None

    def find(self, stop: threading.Event, patience_s: float | None = None) -> Found | None:
        """Reads the stream until there is a result, of which a file is written; None where it was stopped first.

        ``patience_s`` is the longest wait for a person who stands still, None for as long as it takes.

        Raises:
            InvalidInput: The source ended, or the time was over, before there was a result.
            OSError: Nothing can be written to the folder.
        """
        report = ReportFile(self._folder / LIVE_FILE)
        self._prompting.say(self.request)
        try:
            with single_threaded(), low_latency():
                found = self._look(stop, patience_s, report)
        except InvalidInput as error:
            report.write(self._report(self.failed_state, ended_by=str(error)), last=True)
            raise
        if found is None:
            report.write(self._report(self.failed_state, ended_by="it was stopped"), last=True)
        return found

    def _look(self, stop: threading.Event, patience_s: float | None, report: ReportFile) -> Found | None:
        begin_s, written_s = time.perf_counter(), 0.0
        while not stop.is_set():
            now = time.perf_counter()
            if now - written_s >= REPORT_S:
                report.write(self._report(self._state()))
                written_s = now
            found = self._step(stop)
            if found is not None:
                return found
            if self._state() != STANDING:
                continue
            silent = time.perf_counter() - self._heard_s > SILENT_S
            if silent:
                self._silent()
            self._prompting.waiting("no frames come from the stream" if silent else self._hindrance())
            if patience_s is not None and now - begin_s - self._uncounted_s > patience_s:
                raise InvalidInput(f"{patience_s:.0f} s passed before {self.goal}: {self._reason()}")
        return None

    def _begin(self, stream: StreamDescription) -> None:
        """Checks and takes the stream of a connected source."""
        raise NotImplementedError

    def _step(self, stop: threading.Event) -> Found | None:
        """Takes the next frame; returns the result once there is one."""
        raise NotImplementedError

    def _hindrance(self) -> str:
        """Reason to wait, as a clause."""
        raise NotImplementedError

    def _reason(self) -> str:
        """Reason for an end without a result."""
        return self._hindrance()

    def _state(self) -> str:
        """State in live.json."""
        return STANDING

    def _silent(self) -> None:
        """Called while no frames come."""

    def _progress_report(self) -> dict[str, object]:
        """The entry of live.json on the way to a result."""
        raise NotImplementedError

    def _report(self, state: str, **more: object) -> dict[str, object]:
        return {
            "state": state,
            "source": self._source_name,
            "trial": self.stream.trial,
            "nominal_rate_hz": self.stream.rate_hz,
            **self._progress_report(),
            **more,
            "events": self._events.plain(),
        }

    def _read(self, stop: threading.Event) -> SourceFrame | None:
        """The next frame, None where none came.

        Raises:
            EOFError: The source has ended.
        """
        frame = next_frame(self._source, self._events.note, stop)
        if frame is not None:
            self._frames_in += 1
            self._heard_s = time.perf_counter()
        return frame

    def _ended(self) -> InvalidInput:
        return InvalidInput(f"the source ended before {self.goal}: {self._reason()}")
