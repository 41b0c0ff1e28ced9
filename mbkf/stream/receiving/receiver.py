"""The receiving side of a live run: a thread reads the source, aligns its frames and fills the ring buffer.

Errors of the source do not end the thread; any other error does, and is reported to the run, which cannot go on.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import NamedTuple

from mbkf.conventions import Array
from mbkf.stream.receiving.alignment import BRIDGED_S, FrameAlignment, Note, ReadyFrame, Record
from mbkf.stream.receiving.reader import next_frame
from mbkf.stream.receiving.ring_buffer import RingBuffer
from mbkf.stream.source import FrameSource, PlateSamples, SourceFrame, StreamDescription

SLACK_S, START_SLACK_S = 0.25, 5.0
"""The ring buffer holds the frames of this time: a pause of the machine, and a start of the filter with its search."""


class FrameCounts(NamedTuple):
    """Frames by their fate; ``received - late - overwritten - queued`` were taken.

    Attributes:
        received: Frames that arrived.
        late: Frames that arrived too late, twice or out of order.
        lost_on_the_way: Frames that never arrived, or too late, by the source's count.
        overwritten: Frames that came faster than the filter took them.
        queued: Frames that have not been taken.
    """

    received: int
    late: int
    lost_on_the_way: int
    overwritten: int
    queued: int


def _stale(oldest: ReadyFrame, newest: ReadyFrame) -> bool:
    return newest.arrival_s - oldest.arrival_s >= SLACK_S


class Receiver:
    """Aligned frames of a source, taken one by one.

    Attributes:
        rate_hz: Nominal frame rate.
    """

    def __init__(
        self,
        source: FrameSource,
        stream: StreamDescription,
        columns: Array | None,
        samples: Callable[[PlateSamples], None],
        note: Note,
        mass_kg: float | None = None,
        failed: Callable[[BaseException], None] | None = None,
        record: Record | None = None,
    ) -> None:
        """The thread is not started yet.

        Args:
            source: A connected source.
            stream: Its description.
            columns: (M,) columns of the subject's markers in the stream; None for points without names.
            samples: Called with the plates' new samples.
            note: Called with events.
            mass_kg: The person's mass, by which readings of the plates are judged; None to accept all.
            failed: Called with the error that ends the thread.
            record: Called with each frame as it came.
        """
        self.rate_hz = stream.rate_hz
        self._source, self._samples, self._note, self._failed = source, samples, note, failed
        self._alignment = FrameAlignment(
            stream, columns, note, mass_kg, live=not source.patient, record=record
        )
        self._buffer: RingBuffer[ReadyFrame] = RingBuffer(
            self._frames(START_SLACK_S), source.patient, _stale, self._joined
        )
        self._overwritten = 0
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="mbkf-reader", daemon=True)

    def start(self) -> None:
        """Begins to read."""
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread; frames in the buffer can still be taken."""
        self._stopping.set()
        self._buffer.close()
        self._thread.join(timeout=5.0)

    def take(self, timeout_s: float) -> ReadyFrame | None:
        """The oldest frame in the buffer; None where none comes within the time, or ever (see :attr:`ended`)."""
        return self._buffer.take(timeout_s)

    def allow_start(self) -> None:
        """Gives the buffer room for a start of the filter."""
        self._buffer.allow(self._frames(START_SLACK_S))

    def allow_pause(self) -> None:
        """Gives the buffer room for a pause of the machine only."""
        self._buffer.allow(self._frames(SLACK_S))

    @property
    def empty(self) -> bool:
        """True while the buffer holds no frame."""
        return self._buffer.empty

    @property
    def ended(self) -> bool:
        """True when no more frames come."""
        return self._buffer.ended

    @property
    def lost(self) -> int:
        """Frames lost so far: on the way here, and in the ring buffer."""
        return self._alignment.lost + self._overwritten

    def counts(self, until: int | None = None) -> FrameCounts:
        """Numbers of frames up to the last frame asked for; ``until`` is its number, None for all.

        Frames in the buffer beyond it, and those of a file, which still has them, were not received.
        """
        queued = beyond = 0
        for frame in self._buffer.left():
            if not frame.lost:
                queued += 1
                beyond += self._source.patient or (until is not None and frame.number > until)
        aligned, overwritten = self._alignment, self._overwritten
        return FrameCounts(
            aligned.frames_in - beyond, aligned.late, aligned.lost, overwritten, queued - beyond
        )

    def _frames(self, seconds: float) -> int:
        return round(seconds * self.rate_hz)

    def _run(self) -> None:
        try:
            self._read()
        except BaseException as error:
            if self._failed is None:
                raise
            self._failed(error)
        finally:
            self._buffer.close()

    def _read(self) -> None:
        def note(kind: str, sentence: str) -> None:
            self._note(kind, sentence, None, 1)

        while not self._stopping.is_set():
            try:
                frame = next_frame(self._source, note, self._stopping)
            except EOFError:
                return
            if frame is not None:
                self._put(frame)

    def _put(self, frame: SourceFrame) -> None:
        """Aligns a frame of the source and buffers it."""
        ready, samples = self._alignment.accept(frame)
        for one in ready:
            gone = [old for old in self._buffer.put(one) if not old.lost]
            if gone:
                self._overwritten += len(gone)
                sentence = "the filter could not keep up; only the latest frame was kept"
                self._note("overwritten", sentence, None, 1)
        self._samples(samples)

    def _joined(self, gone: list[ReadyFrame], newest: ReadyFrame) -> ReadyFrame:
        """The newest frame with the plates of those that it overwrites, of as many as are bridged."""
        left = [known for one in gone for known in (*one.left_out, (one.number, one.plates))]
        return newest._replace(left_out=tuple(left[-self._frames(BRIDGED_S) :]))
