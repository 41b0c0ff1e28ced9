"""The receiving side of a live run: a thread reads the source, aligns its frames and fills the ring buffer."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from mbkf.conventions import Array
from mbkf.stream.receiving.alignment import FrameAlignment, Note, ReadyFrame
from mbkf.stream.receiving.reader import Reader
from mbkf.stream.receiving.ring_buffer import RingBuffer
from mbkf.stream.source import FrameSource, PlateSamples, StreamDescription

SLACK_S, START_SLACK_S = 0.25, 5.0
"""The ring buffer holds the frames of this time: a pause of the machine, and a start of the filter with its search."""


class FrameCounts(NamedTuple):
    """Frames by what became of them; ``received - late - overwritten - queued`` were taken.

    Attributes:
        received: Those that arrived.
        late: Those that arrived too late, twice or out of order.
        lost_on_the_way: Those that never arrived, or too late, by the source's count.
        overwritten: Those that the filter was too slow for.
        queued: Those that have not been taken.
    """

    received: int
    late: int
    lost_on_the_way: int
    overwritten: int
    queued: int


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
    ) -> None:
        """The thread is not started yet.

        Args:
            source: A connected source.
            stream: Its description.
            columns: (M,) columns of the subject's markers in the stream; None for points without names.
            samples: Called with the plates' new samples.
            note: Called with events.
            mass_kg: The person's mass, by which readings of the plates are judged; None for not at all.
            failed: Called with the error that ends the thread.
        """
        self.rate_hz = stream.rate_hz
        self._alignment = FrameAlignment(stream, columns, note, mass_kg, live=not source.patient)
        self._patient = source.patient
        self._buffer: RingBuffer[ReadyFrame] = RingBuffer(self._frames(START_SLACK_S), source.patient)
        self._reader = Reader(
            source,
            self._alignment,
            self._buffer,
            samples,
            lambda kind, what: note(kind, what, None, 1),
            failed,
        )

    def start(self) -> None:
        """Begins to read."""
        self._reader.start()

    def stop(self) -> None:
        """Ends the thread; frames in the buffer can still be taken."""
        self._reader.stop()

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
        """Whether the buffer holds no frame."""
        return self._buffer.empty

    @property
    def ended(self) -> bool:
        """Whether no more frames come."""
        return self._buffer.ended

    @property
    def lost(self) -> int:
        """Frames lost so far: on the way here, and in the ring buffer."""
        return self._alignment.lost + self._reader.overwritten

    def counts(self, until: int | None = None) -> FrameCounts:
        """Numbers of frames.

        Frames in the buffer that lie beyond the end of what was asked for, and those of a file, which still has them,
        were not received.

        Args:
            until: Number of the last frame asked for; None where none is beyond it.
        """
        queued = beyond = 0
        for frame in self._buffer.left():
            if not frame.lost:
                queued += 1
                beyond += self._patient or (until is not None and frame.number > until)
        alignment, overwritten = self._alignment, self._reader.overwritten
        return FrameCounts(
            alignment.frames_in - beyond, alignment.late, alignment.lost, overwritten, queued - beyond
        )

    def _frames(self, seconds: float) -> int:
        return round(seconds * self.rate_hz)
