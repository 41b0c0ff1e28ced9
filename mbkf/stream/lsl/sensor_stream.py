"""One stream of inertial sensors: samples with numbers and times, and the stream's return under the same identity."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.stream.identity import named_columns, same_rate
from mbkf.stream.lsl.format import StreamInfo
from mbkf.stream.lsl.inlets import Inlet, LostStream, inlet_of, opened
from mbkf.stream.lsl.sensor_format import SensorLayout, read_sensor_info
from mbkf.stream.lsl.stamp_numbering import StampedItems, StampNumbering
from mbkf.stream.source import counts

CHUNK = 256
"""Samples fetched of a stream at a time."""


class Samples(NamedTuple):
    """Samples whose numbers are known.

    Attributes:
        numbers: (T,) by the stream's count, or by order of arrival and stamps.
        times_s: (T,) when they were taken, on this computer's LSL clock; NaN where a count numbers them.
        values: (T, S, 6) readings.
    """

    numbers: NDArray[np.int64]
    times_s: Array
    values: Array


class SensorStream:
    """Receives one stream.

    Attributes:
        layout: Its sensors and rate.
    """

    def __init__(
        self,
        library: ModuleType,
        info: StreamInfo,
        layout: SensorLayout,
        units: Mapping[str, str],
        counted: bool,
        tell: Callable[[str, str], None],
    ) -> None:
        """A stream that is received from now on.

        Args:
            library: pylsl.
            info: Its information.
            layout: Its layout.
            units: Units that it does not state.
            counted: Whether its own count numbers the samples; else their order of arrival and their stamps do.
            tell: Called with events, kind and sentence.
        """
        self._lsl, self._units, self._tell, self._name = library, dict(units), tell, str(info.name())
        self.layout = layout
        self._lost: LostStream | None = None
        self._stamped = None if counted else StampedItems[Array](StampNumbering(layout.rate_hz))
        self._inlet: Inlet = inlet_of(library, info, not counted)
        if not opened(library, self._inlet, not counted):
            self._lose()

    def take(self, timeout_s: float, most: int = CHUNK) -> Samples | None:
        """The next samples; None where none came, or their numbers are not known yet.

        Args:
            timeout_s: Longest wait for the first of them.
            most: Number of samples at most.
        """
        if self._inlet is None and not self._found_again():
            time.sleep(timeout_s)
            return None
        try:
            samples, stamps = self._inlet.pull_chunk(timeout=timeout_s, max_samples=most, min_samples=1)
        except self._lsl.util.LostError:
            self._lose()
            return None
        rows, now = np.asarray(samples, dtype=float), time.perf_counter()
        if self._stamped is None:
            if not len(stamps):
                return None
            numbers = counts(rows[:, self.layout.counter])
            return Samples(numbers, np.full(len(rows), np.nan), self.layout.readings(rows))
        readings = self.layout.readings(rows) if len(stamps) else ()
        found = [
            one
            for reading, stamp in zip(readings, stamps, strict=True)
            for one in self._stamped.put(reading, float(stamp), now)
        ]
        if not len(stamps) and timeout_s > 0.0:
            found = self._stamped.flush()
        origin_s = self._stamped.numbering.origin_s
        if not found or origin_s is None:
            return None
        numbers = np.array([number for number, _ in found])
        times_s = origin_s + numbers / self.layout.rate_hz
        return Samples(numbers, times_s, np.array([reading for _, reading in found]))

    def _refuse(self, error: MbkfError) -> None:
        self._tell("refused", f"the stream '{self._name}' came back as another one: {error}")

    def _lose(self) -> None:
        self._tell("sensors gone", f"the stream '{self._name}' broke off and is looked for")
        self._inlet, self._lost = None, LostStream(self._lsl, self._name)

    def _found_again(self) -> bool:
        """True once the stream is back; its sensors are found by their names."""
        known, counted = self.layout, self._stamped is None

        def same(full: StreamInfo) -> SensorLayout:
            found = read_sensor_info(full, self._units)
            if found is None:
                raise InvalidInput("it has no sensors any more")
            same_rate(known.rate_hz, found.rate_hz)
            layout = found.reordered(named_columns("sensors", known.sensors, found.sensors))
            if counted and layout.counter is None:
                raise InvalidInput("it has no count of samples any more")
            return layout

        back = None if self._lost is None else self._lost.returned(not counted, same, self._refuse)
        if back is None:
            return False
        _, self._inlet, self.layout = back
        self._lost = None
        self._tell("sensors back", f"the stream '{self._name}' is back")
        return True
