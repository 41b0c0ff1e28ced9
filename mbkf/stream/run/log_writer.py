"""Writes the log of a live run in a thread of its own, so that a slow or full disk never stalls the filter."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from mbkf.io.frame_log import FrameLogWriter
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.stream.receiving.alignment import Record
from mbkf.stream.run.recorder import Recorder
from mbkf.stream.source import PlateSamples
from mbkf.trial.live.log import LIMBS_DTYPE, LiveLog
from mbkf.trial.live.recording import RecordingFiles

EVERY_S = 0.2
"""Interval at which new rows are written."""

AGAIN_S = 1.0
"""Time after a failure until writing is tried again."""

REPORTED_S = 5.0
"""Interval at which the state of the run is reported."""

MOST_HELD_BYTES = 256 * 1024 * 1024
"""Most memory held while nothing can be written; the oldest rows are dropped first."""

MOST_LATER = 2000
"""Calls that make rows and wait for the log's thread, at most, two a frame: ten seconds at 100 Hz. While writing takes
longer, each further call makes the oldest rows itself."""


def arrived(rows: NDArray) -> int:
    """Number of rows but those of lost frames, which have no latency."""
    return int(np.isfinite(rows["latency_s"]).sum()) if "latency_s" in (rows.dtype.names or ()) else len(rows)


@dataclass
class _Log:
    """Rows on their way into one file."""

    writer: FrameLogWriter
    rows: deque[NDArray] = field(default_factory=deque)
    waiting: int = 0
    dropped: int = 0
    written: int = 0

    @property
    def unwritten(self) -> int:
        """Number of rows that are not in the file."""
        return self.dropped + sum(map(arrived, self.rows))

    def put(self, rows: NDArray) -> None:
        self.rows.append(rows)
        self.waiting += rows.nbytes

    def shed(self) -> None:
        """Forgets the oldest rows where too many wait."""
        while self.waiting > MOST_HELD_BYTES:
            gone = self.rows.popleft()
            self.waiting -= gone.nbytes
            self.dropped += arrived(gone)


class LogWriter:
    """A thread that appends rows to a :class:`LiveLog`.

    Attributes:
        record: Takes each frame as it came; None where the run is not recorded.
        unrecorded: Number of frames that are missing in the recording, once the log is closed.
    """

    def __init__(
        self,
        log: LiveLog,
        failed: Callable[[OSError], None],
        report: Callable[[], None] | None = None,
        died: Callable[[BaseException], None] | None = None,
    ) -> None:
        """Starts the thread.

        Args:
            log: The log.
            failed: Called with the error where writing failed.
            report: Called every few seconds.
            died: Called with any other error, which ends the thread.
        """
        self._log, self._failed, self._report, self._died = log, failed, report, died
        self._logs = [_Log(one) for one in (log.frames, log.plates, log.limbs, *log.recording)]
        self._recorded = dict(zip(log.recording, self._logs[3:], strict=True))
        self._later: deque[Callable[[], None]] = deque()
        self._making = threading.Lock()
        self.record: Record | None = None
        self.unrecorded = 0
        if log.recording:
            take = Recorder(RecordingFiles(*log.recording), self._put_recorded).take
            self.record = lambda *frame: self._make_later(partial(take, *frame))
        self._changed = threading.Condition()
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="mbkf-log", daemon=True)
        self._thread.start()

    def put_row(self, row: NDArray) -> None:
        """An answered frame."""
        with self._changed:
            self._logs[0].put(row)

    def put_samples(self, samples: PlateSamples) -> None:
        """Readings of the plates."""
        if len(samples.index):
            self._make_later(partial(self._put_samples, samples))

    def _put_samples(self, samples: PlateSamples) -> None:
        rows = np.zeros(len(samples.index), dtype=self._log.plates.dtype)
        rows["index"], rows["wrench"] = samples.index, samples.wrench
        with self._changed:
            self._logs[1].put(rows)

    def put_doubt(self, doubt: LimbDoubt) -> None:
        """A limb in doubt."""
        row = np.array([(doubt.as_text().encode(),)], dtype=LIMBS_DTYPE)
        with self._changed:
            self._logs[2].put(row)

    def _make_later(self, make: Callable[[], None]) -> None:
        """Leaves rows to the log's thread, so that the calling thread passes its frame on at once."""
        self._later.append(make)
        self._make_rows(MOST_LATER)

    def _make_rows(self, waiting: int = 0) -> None:
        """Makes rows, the oldest first, until so many calls that make some are left."""
        while len(self._later) > waiting:
            with self._making:  # taken and made under one lock: rows keep their order
                if len(self._later) > waiting:
                    self._later.popleft()()
            time.sleep(0.0)  # another thread may go on

    def _put_recorded(self, file: FrameLogWriter, rows: NDArray) -> None:
        with self._changed:
            self._recorded[file].put(rows)

    def close(self) -> tuple[int, int]:
        """Writes the remaining rows; returns the numbers of frames that arrived and are, or are not, in the log."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join()
        while self._later:  # calls and rows left by a thread that died
            with suppress(Exception):
                self._make_rows()
        for log in reversed(self._logs):  # the answered frames last
            with suppress(Exception):
                self._flush(log)
        self._log.close()
        frames = self._logs[0]
        self.unrecorded = sum(self._recorded[one].unwritten for one in self._log.recording[:1])
        return frames.written, frames.unwritten

    def _run(self) -> None:
        try:
            self._write()
        except BaseException as error:
            if self._died is None:
                raise
            self._died(error)

    def _write(self) -> None:
        pause, unreported_s = EVERY_S, 0.0
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closing, pause)
                closing = self._closing
            pause = EVERY_S if self._write_waiting() else AGAIN_S
            unreported_s += pause
            if self._report is not None and unreported_s >= REPORTED_S:
                unreported_s = 0.0
                self._report()
            if closing:
                return

    def _write_waiting(self) -> bool:
        """Writes what waits, the answered frames last: where the run is killed, their samples are in the log."""
        frames, *others = self._logs
        with self._changed:
            answered = len(frames.rows)
        self._make_rows()
        return all([*map(self._flush, others), self._flush(frames, answered)])

    def _flush(self, log: _Log, most: int | None = None) -> bool:
        """Writes the waiting rows of one file, or so many of them; False where that failed."""
        with self._changed:
            rows = list(islice(log.rows, most))
        if not rows:
            return True
        # As bytes: numpy joins records field by field.
        together = np.concatenate([row.view(np.uint8) for row in rows]).view(log.writer.dtype)
        before = log.writer.rows
        try:
            log.writer.append(together)
        except OSError as error:
            self._failed(error)
        done = log.writer.rows - before
        log.written += arrived(together[:done])
        left = together[done:]
        with self._changed:
            for _ in rows:
                log.waiting -= log.rows.popleft().nbytes
            if len(left):
                log.rows.appendleft(left)
                log.waiting += left.nbytes
                log.shed()
        return not len(left)
