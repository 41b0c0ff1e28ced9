"""Inertial sensors from Lab Streaming Layer: one stream of all of them, or a stream of each, as one row of frames."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping, Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import StreamInfo
from mbkf.stream.lsl.inlets import OPEN_S, inlet_of
from mbkf.stream.lsl.sensor_format import SENSOR_TYPES, read_sensor_info, together
from mbkf.stream.lsl.sensor_grid import SensorGrid
from mbkf.stream.lsl.sensor_stream import SensorStream
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription

POLL_S = 0.002
"""Pause between two looks at several streams: short beside a frame."""

NO_MARKERS = np.zeros((0, 3))


class LslSensorSource:
    """A :class:`mbkf.stream.source.FrameSource` of inertial sensors.

    Streams that break off are taken up again when they return with the same sensors.
    """

    patient = False

    def __init__(self, names: Sequence[str] = (), units: Mapping[str, str] | None = None) -> None:
        """Args: names of the streams (default: all of inertial sensors), and units that they do not state."""
        self._lsl = lsl()
        self._names, self._units = tuple(names), dict(units or {})
        self._seen: frozenset[str] = frozenset()
        self._streams: list[SensorStream] = []
        self._stream: StreamDescription | None = None
        self._grid: SensorGrid | None = None
        self._ready: deque[SourceFrame] = deque()
        self._news: list[tuple[str, str]] = []

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The streams, once all that were named, or the same ones twice in a row, are found."""
        found = [one for one in self._lsl.resolve_streams(timeout_s) if self._wanted(one)]
        seen = frozenset(one.uid() for one in found)
        settled, self._seen = seen == self._seen or bool(self._names), seen
        missing = set(self._names) - {one.name() for one in found}
        if not found or missing or not settled:
            return None
        found.sort(key=lambda one: str(one.name()))
        try:
            return self._connected(found)
        except (self._lsl.util.LostError, self._lsl.util.TimeoutError):  # gone again
            self.close()
            return None

    def _wanted(self, info: StreamInfo) -> bool:
        if self._names:
            return info.name() in self._names
        return info.type().lower() in SENSOR_TYPES

    def _connected(self, found: Sequence[StreamInfo]) -> StreamDescription | None:
        described = [(one, read_sensor_info(self._information(one), self._units)) for one in found]
        known = [(info, layout) for info, layout in described if layout is not None]
        if not known:
            return None
        layouts = [layout for _, layout in known]
        self._stream = together(layouts)
        if len(layouts) > 1 or layouts[0].rate_hz > self._stream.rate_hz:
            rates = [one.rate_hz for one in layouts]
            self._grid = SensorGrid([len(one.sensors) for one in layouts], rates, self._stream.rate_hz)
        counted = self._grid is None and layouts[0].counter is not None
        self._streams = [
            SensorStream(self._lsl, info, layout, self._units, counted, self._tell) for info, layout in known
        ]
        return self._stream

    def _information(self, info: StreamInfo) -> StreamInfo:
        return inlet_of(self._lsl, info, False).info(OPEN_S)

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame: a sample of a single stream, or the readings of all streams at its time."""
        assert self._stream is not None, "connect first"
        until = time.perf_counter() + timeout_s
        if self._grid is None:
            while not self._ready and time.perf_counter() <= until:
                found = self._streams[0].take(max(0.0, until - time.perf_counter()), 1)
                if found is not None:
                    self._ready.extend(map(self._frame, found.numbers, found.values))
            return self._ready.popleft() if self._ready else None
        while True:
            row = self._grid.next(self._lsl.local_clock())
            if row is not None:
                return self._frame(row[0], row[1])
            if not self._fetch(self._grid):
                if time.perf_counter() > until:
                    return None
                time.sleep(POLL_S)

    def _fetch(self, grid: SensorGrid) -> bool:
        """Takes the streams' new samples; true where there were any."""
        there = False
        for k, stream in enumerate(self._streams):
            found = stream.take(0.0)
            if found is not None:
                there = True
                grid.put(k, found.times_s, found.values)
        return there

    def _frame(self, number: int, imus: Array) -> SourceFrame:
        return SourceFrame(
            int(number), time.perf_counter(), NO_MARKERS, NO_MARKERS, PlateSamples.none(0), imus
        )

    def _tell(self, kind: str, sentence: str) -> None:
        self._news.append((kind, sentence))

    def news(self) -> list[tuple[str, str]]:
        """Events of the connections since the last call."""
        news, self._news = self._news, []
        return news

    def close(self) -> None:
        """Drops the streams."""
        self._streams = []
