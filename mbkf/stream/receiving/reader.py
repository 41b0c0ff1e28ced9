"""The thread that reads a source and writes aligned frames into the ring buffer; source errors do not end it."""

from __future__ import annotations

import threading
from collections.abc import Callable

from mbkf.stream.receiving.alignment import FrameAlignment, ReadyFrame
from mbkf.stream.receiving.ring_buffer import RingBuffer
from mbkf.stream.source import FrameSource, PlateSamples

READ_S = 0.1
"""How long a read may take, so that the thread notices when it is to stop."""

SILENT_S = 1.0
"""A source without frames for this long counts as silent, which is an event of the run."""

PAUSE_S = 0.5
"""Time until a source is read again after an unforeseen error."""


class Reader:
    """Reads until it is stopped or the source ends.

    Attributes:
        overwritten: Frames that the filter was too slow for.
        too_late: Frames that were read when the run had ended, or that ended it.
        failure: What ended the thread unforeseen; None where nothing did.
    """

    def __init__(
        self,
        source: FrameSource,
        alignment: FrameAlignment,
        buffer: RingBuffer[ReadyFrame],
        samples: Callable[[PlateSamples], None],
        note: Callable[[str, str], None],
    ) -> None:
        """A thread that is not started yet.

        Args:
            source: A connected source.
            alignment: Numbers and aligns its frames.
            buffer: Takes the aligned frames.
            samples: Called with the plates' new samples.
            note: Called with events.
        """
        self._source, self._alignment, self._buffer = source, alignment, buffer
        self._samples, self._note = samples, note
        self.overwritten = self.too_late = 0
        self.failure: Exception | None = None
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="mbkf-reader", daemon=True)

    def start(self) -> None:
        """Begins to read."""
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread; frames that were read can still be taken."""
        self._stopping.set()
        self._buffer.close()
        self._thread.join(timeout=5.0)

    def _run(self) -> None:
        try:
            self._read()
        except Exception as error:  # a dead thread must end the run
            self.failure = error
            self._note("failed", f"the reading thread failed ({type(error).__name__}: {error})")
        finally:
            self._buffer.close()

    def _read(self) -> None:
        while not self._stopping.is_set():
            try:
                frame = self._source.read(READ_S)
            except EOFError:
                break
            except Exception as error:  # libraries of sources raise errors of any kind
                self._note("source", f"the source failed ({type(error).__name__}: {error})")
                self._stopping.wait(PAUSE_S)
                continue
            for kind, what in self._source.news():
                self._note(kind, what)
            if frame is None:
                continue
            try:
                ready, samples = self._alignment.accept(frame)
            except Exception:
                self.too_late += 1
                raise
            for one in ready:
                self._put(one)
            self._samples(samples)

    def _put(self, frame: ReadyFrame) -> None:
        overwritten = self._buffer.put(frame)
        if overwritten is None:
            self.too_late += not frame.lost
            return
        gone = sum(not old.lost for old in overwritten)
        if gone:
            self.overwritten += gone
            self._note("overwritten", "the filter could not keep up; only the latest frame was kept")
