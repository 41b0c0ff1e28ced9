"""A source that goes on where somebody else stopped reading, with the frames that were kept for it first."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from mbkf.stream.source import FrameSource, SourceFrame, StreamDescription


class ResumedSource:
    """A :class:`mbkf.stream.source.FrameSource` that is connected already."""

    def __init__(
        self, source: FrameSource, stream: StreamDescription, kept: Iterable[SourceFrame] = ()
    ) -> None:
        """Args: the source, what it said of itself, and frames that were read and are to be read again."""
        self._source, self._stream = source, stream
        self._kept = deque(kept)
        self.patient = source.patient

    def connect(self, timeout_s: float) -> StreamDescription:
        """What the source said when it was connected."""
        del timeout_s
        return self._stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The frames kept, then those of the source.

        Raises:
            EOFError: No more frames will ever come.
        """
        return self._kept.popleft() if self._kept else self._source.read(timeout_s)

    def news(self) -> list[tuple[str, str]]:
        """What happened to the connection since this was asked last."""
        return self._source.news()

    def close(self) -> None:
        """Lets go of the stream."""
        self._source.close()
