"""A sending thread between the filter and a receiver of results, so that a slow receiver never delays the filter."""

from __future__ import annotations

import threading
from collections.abc import Callable

from mbkf.stream.receiving.ring_buffer import RingBuffer
from mbkf.stream.results.frame import LiveFrame

HELD = 256
"""Frames that may wait; when the receiver is slower for longer than that, only the latest is kept."""


class SendingThread:
    """A :class:`mbkf.stream.results.frame.FrameSink` that calls a function with each frame, in a thread of its own."""

    def __init__(self, send: Callable[[LiveFrame], None], name: str, held: int = HELD) -> None:
        """Starts the thread.

        Args:
            send: Called with each frame.
            name: Name of the thread.
            held: Frames that may wait.
        """
        self._send = send
        self._error: Exception | None = None
        self._buffer: RingBuffer[LiveFrame] = RingBuffer(held)
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def take(self, frame: LiveFrame) -> None:
        """A new frame.

        Raises:
            Exception: What the function raised, which ended the thread.
        """
        if self._error is not None:
            raise self._error
        self._buffer.put(frame)

    def close(self) -> None:
        """Sends the waiting frames, and ends."""
        self._buffer.close()
        self._thread.join(timeout=5.0)

    def _run(self) -> None:
        while not self._buffer.ended:
            frame = self._buffer.take(0.5)
            if frame is None:
                continue
            try:
                self._send(frame)
            except Exception as error:  # raised with the next frame
                self._error = error
                return
