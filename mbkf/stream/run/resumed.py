"""A connected source handed over from one reader to the next, beginning with frames that were kept meanwhile."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from mbkf.stream.source import FrameSource, SourceFrame, StreamDescription


class ResumedSource:
    """A :class:`mbkf.stream.source.FrameSource` that is connected already."""

    def __init__(
        self, source: FrameSource, stream: StreamDescription, kept: Iterable[SourceFrame] = ()
    ) -> None:
        """Takes over a source.

        Args:
            source: The connected source.
            stream: Its description.
            kept: Frames to deliver first.
        """
        self._source, self._stream = source, stream
        self._kept = deque(kept)
        self.patient = source.patient

    def connect(self, timeout_s: float) -> StreamDescription:
        """The stream's description."""
        del timeout_s
        return self._stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The frames kept, then those of the source.

        Raises:
            EOFError: No more frames will ever come.
        """
        return self._kept.popleft() if self._kept else self._source.read(timeout_s)

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        return self._source.news()

    def close(self) -> None:
        """Lets go of the stream."""
        self._source.close()
