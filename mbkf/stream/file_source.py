"""A capture file as a live source: the same path as a camera system's stream, without one."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np

from mbkf.stream.played import Played, PlayedFrame
from mbkf.stream.source import SourceFrame, StreamDescription


class FileSource:
    """A :class:`mbkf.stream.source.FrameSource` that loses no frame: it waits for a slow reader."""

    patient = True

    def __init__(self, played: Played, speed: float = 1.0) -> None:
        """Args: the capture, and how many times real time it is played; 0 for as fast as it is read."""
        self._played, self._speed = played, speed
        self._frames: Iterator[PlayedFrame] = played.frames()
        self._next: PlayedFrame | None = None
        self._begin_s: float | None = None

    def connect(self, timeout_s: float) -> StreamDescription:
        """The description; a file is always there."""
        del timeout_s
        return self._played.stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame, when its time has come."""
        frame = self._next or next(self._frames, None)
        if frame is None:
            raise EOFError
        self._next = frame
        if self._begin_s is None:
            self._begin_s = time.perf_counter()
        if self._speed > 0.0:
            due = self._begin_s + frame.number / (self._played.stream.rate_hz * self._speed)
            wait = due - time.perf_counter()
            if wait > 0.0:
                time.sleep(min(wait, timeout_s))
            if wait > timeout_s:
                return None
        self._next = None
        none = np.zeros((0, 3))
        named = bool(self._played.stream.marker_names)
        markers, points = (frame.markers_m, none) if named else (none, frame.markers_m)
        return SourceFrame(frame.number, time.perf_counter(), markers, points, frame.plates, frame.imus)

    def news(self) -> list[tuple[str, str]]:
        """A file has no events."""
        return []

    def close(self) -> None:
        """A file needs no closing."""
