"""The receiving side of a live run: a thread reads the source, aligns its frames and fills the ring buffer."""

from __future__ import annotations

from collections.abc import Callable

from mbkf.conventions import Array
from mbkf.stream.receiving.alignment import FrameAlignment, Note, ReadyFrame
from mbkf.stream.receiving.reader import Reader
from mbkf.stream.receiving.ring_buffer import RingBuffer
from mbkf.stream.source import FrameSource, PlateSamples, StreamDescription

SLACK_S, START_SLACK_S = 0.25, 5.0
"""The ring buffer holds the frames of this time: a pause of the machine, and a start of the filter with its search."""


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
    ) -> None:
        """The thread is not started yet.

        Args:
            source: A connected source.
            stream: Its description.
            columns: (M,) columns of the subject's markers in the stream; None for points without names.
            samples: Called with the plates' new samples.
            note: Called with events.
            mass_kg: The person's mass, by which readings of the plates are judged; None for not at all.
        """
        self.rate_hz = stream.rate_hz
        self._alignment = FrameAlignment(stream, columns, note, mass_kg, live=not source.patient)
        self._buffer: RingBuffer[ReadyFrame] = RingBuffer(self._frames(START_SLACK_S), source.patient)
        self._reader = Reader(
            source, self._alignment, self._buffer, samples, lambda kind, what: note(kind, what, None, 1)
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

    @property
    def failure(self) -> Exception | None:
        """What ended the reading thread; None where nothing did."""
        return self._reader.failure

    @property
    def left(self) -> int:
        """Frames that arrived and were neither taken nor overwritten."""
        return self._reader.too_late + sum(not frame.lost for frame in self._buffer.left())

    def counts(self) -> dict[str, int]:
        """Numbers of frames for live.json: received, left out as late, and lost, by cause."""
        return {
            "frames_in": self._alignment.frames_in,
            "frames_late": self._alignment.late,
            "frames_lost": self.lost,
            "frames_lost_on_the_way": self._alignment.lost,
            "frames_overwritten": self._reader.overwritten,
        }

    def _frames(self, seconds: float) -> int:
        return round(seconds * self.rate_hz)
