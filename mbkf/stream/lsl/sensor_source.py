"""Inertial sensors from Lab Streaming Layer: one stream of all of them, or a stream of each, as one row of frames."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import StreamInfo
from mbkf.stream.lsl.sensor_format import SENSOR_TYPES, SensorLayout, read_sensor_info, together
from mbkf.stream.lsl.sensor_grid import SensorGrid
from mbkf.stream.lsl.source import KEPT_S, OPEN_S
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription, counts

POLL_S = 0.002
"""Pause between two looks at several streams: short beside a frame."""

CHUNK = 256
"""Samples fetched of a stream at a time."""

NO_MARKERS = np.zeros((0, 3))


class LslSensorSource:
    """A :class:`mbkf.stream.source.FrameSource` of inertial sensors.

    Streams that break off are taken up again by liblsl when they return under the same identity.
    """

    patient = False

    def __init__(self, names: Sequence[str] = (), units: Mapping[str, str] | None = None) -> None:
        """Args: names of the streams (default: all of inertial sensors), and units that they do not state."""
        self._lsl = lsl()
        self._names, self._units = tuple(names), dict(units or {})
        self._seen: frozenset[str] = frozenset()
        self._inlets: list[Any] = []
        self._layouts: list[SensorLayout] = []
        self._stream: StreamDescription | None = None
        self._grid: SensorGrid | None = None
        self._first_stamp: float | None = None

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
        several = len(found) > 1
        for info in found:
            flags = self._lsl.proc_clocksync | (self._lsl.proc_dejitter if several else 0)
            inlet = self._lsl.StreamInlet(info, max_buflen=KEPT_S, processing_flags=flags, as_numpy=True)
            layout = read_sensor_info(inlet.info(OPEN_S), self._units)
            if layout is not None:
                inlet.open_stream(OPEN_S)
                inlet.time_correction(OPEN_S)  # else the first samples wait for it
                self._inlets.append(inlet)
                self._layouts.append(layout)
        if not self._layouts:
            return None
        self._stream = together(self._layouts)
        if len(self._layouts) > 1 or self._layouts[0].rate_hz > self._stream.rate_hz:
            rates = [one.rate_hz for one in self._layouts]
            self._grid = SensorGrid([len(one.sensors) for one in self._layouts], rates, self._stream.rate_hz)
        return self._stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame: a sample of a single stream, or the readings of all streams at its time."""
        assert self._stream is not None, "connect first"
        if self._grid is None:
            return self._sample(timeout_s)
        until = time.perf_counter() + timeout_s
        while True:
            found = self._grid.next(self._lsl.local_clock())
            if found is not None:
                return self._frame(found[0], found[1])
            if not self._fetch(self._grid):
                if time.perf_counter() > until:
                    return None
                time.sleep(POLL_S)

    def _sample(self, timeout_s: float) -> SourceFrame | None:
        assert self._stream is not None
        sample, stamp = self._inlets[0].pull_sample(timeout_s)
        if sample is None:
            return None
        layout, row = self._layouts[0], np.asarray(sample, dtype=float)
        if layout.counter is not None:
            number = int(counts(row[layout.counter]))
        else:
            if self._first_stamp is None and np.isfinite(stamp):
                self._first_stamp = float(stamp)
            passed = float(stamp) - (self._first_stamp or 0.0)
            number = int(counts(np.float64(passed * self._stream.rate_hz)))
        return self._frame(number, layout.readings(row[None])[0])

    def _fetch(self, grid: SensorGrid) -> bool:
        """Takes the streams' new samples; true where there were any."""
        there = False
        for k, (inlet, layout) in enumerate(zip(self._inlets, self._layouts, strict=True)):
            samples, stamps = inlet.pull_chunk(timeout=0.0, max_samples=CHUNK)
            if len(stamps):
                there = True
                grid.put(k, np.asarray(stamps), layout.readings(np.asarray(samples, dtype=float)))
        return there

    def _frame(self, number: int, imus: Array) -> SourceFrame:
        return SourceFrame(number, time.perf_counter(), NO_MARKERS, NO_MARKERS, PlateSamples.none(0), imus)

    def news(self) -> list[tuple[str, str]]:
        """The frames show all events."""
        return []

    def close(self) -> None:
        """Drops the streams."""
        self._inlets, self._layouts = [], []
