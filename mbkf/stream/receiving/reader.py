"""The thread that reads a source and writes aligned frames into the ring buffer.

Errors of the source do not end it; any other error does, and is told to the run, which cannot go on without it.
"""

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
    """

    def __init__(
        self,
        source: FrameSource,
        alignment: FrameAlignment,
        buffer: RingBuffer[ReadyFrame],
        samples: Callable[[PlateSamples], None],
        note: Callable[[str, str], None],
        failed: Callable[[BaseException], None] | None = None,
    ) -> None:
        """A thread that is not started yet.

        Args:
            source: A connected source.
            alignment: Numbers and aligns its frames.
            buffer: Takes the aligned frames.
            samples: Called with the plates' new samples.
            note: Called with events.
            failed: Called with the error that ends the thread.
        """
        self._source, self._alignment, self._buffer = source, alignment, buffer
        self._samples, self._note, self._failed = samples, note, failed
        self.overwritten = 0
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
        except BaseException as error:
            if self._failed is None:
                raise
            self._failed(error)
        finally:
            self._buffer.close()

    def _read(self) -> None:
        while not self._stopping.is_set():
            try:
                frame = self._source.read(READ_S)
                news = self._source.news()
            except EOFError:
                return
            except Exception as error:  # libraries of sources raise errors of any kind
                self._note("source", f"the source failed ({type(error).__name__}: {error})")
                self._stopping.wait(PAUSE_S)
                continue
            for kind, what in news:
                self._note(kind, what)
            if frame is None:
                continue
            ready, samples = self._alignment.accept(frame)
            for one in ready:
                gone = [old for old in self._buffer.put(one) if not old.lost]
                if gone:
                    self.overwritten += len(gone)
                    self._note("overwritten", "the filter could not keep up; only the latest frame was kept")
            self._samples(samples)
