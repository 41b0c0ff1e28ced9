"""Frames from Lab Streaming Layer: a marker stream, and a plate stream at its own rate beside it."""

from __future__ import annotations

import time
from math import ceil
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.resample import WHOLE
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.discovery import streams_of
from mbkf.stream.lsl.format import (
    MARKER_TYPES,
    MarkerLayout,
    PlateLayout,
    read_marker_info,
    read_plates_info,
)
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription, counts

OPEN_S = 3.0
"""Time in which a stream that was found has to answer."""

PLATES_S = 3.0
"""Time for which the plate stream that the markers name is looked for."""

LATE_S = 0.25
"""Plates may come later than the end of their frame by this: a busy computer pauses now and then for a part of it, and
an answer without them stays wrong.
"""

GIVEN_UP = 4
"""After so many frames in a row whose plates came too late, plates are not waited for until they are in time again."""

JUMP_S = 0.5
"""Plates that are behind their frame by more are not waited for: they cannot come in time, or a count has jumped."""

CHUNK = 64
"""Samples of the plates fetched at a time; liblsl is given room for so many, whether they come or not."""

QUIET_S = 0.1
"""Plates without samples for this long are not waited for any more."""

KEPT_S = 10
"""Duration of samples that liblsl buffers."""


class LslSource:
    """A :class:`mbkf.stream.source.FrameSource`."""

    patient = False

    def __init__(self, name: str | None = None, plates_name: str | None = None) -> None:
        """Args: names of the marker stream (default: the first) and of the plate stream (default: its own)."""
        self._lsl = lsl()
        self._name, self._plates_name = name, plates_name
        self._markers: Any = None
        self._plates: Any = None
        self._stream: StreamDescription | None = None
        self._finders: dict[str, Any] = {}
        self._news: list[tuple[str, str]] = []
        self._first_stamp = 0.0
        self._newest_sample: int | None = None
        self._heard_plates_s = 0.0
        self._overdue = 0

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The first marker stream that is found, with its plates."""
        info = self._resolve(self._name, MARKER_TYPES, timeout_s)
        if info is None:
            return None
        try:
            return self._connected(info)
        except (self._lsl.util.LostError, self._lsl.util.TimeoutError):  # gone again
            return None

    def _connected(self, info: Any) -> StreamDescription | None:
        inlet = self._inlet(info, counted=True)
        if inlet is None:
            return None
        full = inlet.info(OPEN_S)
        description, self._layout, wanted = read_marker_info(full)
        self._name = info.name()
        self._plates_name = self._plates_name or wanted or None
        plates = self._connect_plates(self._layout)
        self._counted = self._layout.counter is not None and (plates is None or plates[1].counter is not None)
        self._markers = inlet if self._counted else self._inlet(info, counted=False)
        self._stream = StreamDescription(
            description.trial,
            description.marker_names,
            description.rate_hz,
            description.start_time_s if self._counted else 0.0,
            () if plates is None else plates[0],
        )
        return self._stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next marker frame with the plates' samples until its end."""
        assert self._stream is not None, "connect first"
        self._found_plates_again()
        if self._markers is None and not self._found_again(timeout_s):
            return None
        try:
            sample, stamp = self._markers.pull_sample(timeout_s)
        except self._lsl.util.LostError:
            self._lose("markers")
            return None
        arrival_s = time.perf_counter()
        if sample is None:
            return None
        number = self._number(sample, stamp)
        markers, points = self._layout.points(sample)
        return SourceFrame(number, arrival_s, markers, points, self._samples(number, arrival_s))

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        news, self._news = self._news, []
        return news

    def close(self) -> None:
        """Drops both streams."""
        self._markers = self._plates = None
        self._finders.clear()

    def _resolve(self, name: str | None, types: tuple[str, ...], timeout_s: float) -> Any:
        if name is not None:
            found = self._lsl.resolve_byprop("name", name, 1, timeout_s)
            return found[0] if found else None
        found = streams_of(self._lsl, types, timeout_s)
        return found[0] if found else None

    def _inlet(self, info: Any, counted: bool) -> Any:
        """An open inlet, None where the stream does not answer; stamps are corrected if numbers follow from them."""
        flags = 0
        if not counted:
            # Smoothed stamps separate plate samples; those of frames stay raw, since smoothing would hide lost frames.
            plates = self._lsl.proc_dejitter if info.name() == self._plates_name else 0
            flags = self._lsl.proc_clocksync | plates
        inlet = self._lsl.StreamInlet(
            info, max_buflen=KEPT_S, recover=False, processing_flags=flags, as_numpy=True
        )
        try:
            inlet.open_stream(OPEN_S)
            if not counted:  # else the first frames wait for it
                inlet.time_correction(OPEN_S)
        except (self._lsl.util.LostError, self._lsl.util.TimeoutError):
            return None
        return inlet

    def _connect_plates(self, markers: MarkerLayout) -> tuple[tuple, PlateLayout] | None:
        wanted = self._plates_name
        if wanted is None:
            return None
        info = self._resolve(wanted, (), PLATES_S)
        inlet = None if info is None else self._inlet(info, counted=markers.counter is not None)
        if info is None or inlet is None:
            self._news.append(("plates", f"the plate stream '{wanted}' is missing; going on without plates"))
            return None
        plates, self._plate_layout = read_plates_info(inlet.info(OPEN_S))
        self._plates = inlet
        return plates, self._plate_layout

    def _number(self, sample: Array, stamp: float) -> int:
        assert self._stream is not None
        if self._counted:
            return int(counts(sample[self._layout.counter]))
        if not self._first_stamp and np.isfinite(stamp):
            self._first_stamp = stamp
        return int(counts(np.float64((stamp - self._first_stamp) * self._stream.rate_hz)))

    def _samples(self, number: int, arrival_s: float) -> PlateSamples:
        """Samples of the plates since the frame before, waited for until the end of this frame."""
        assert self._stream is not None
        stream = self._stream
        if self._plates is None:
            return PlateSamples.none(len(stream.plates))
        ratio = stream.plate_rate_hz / stream.rate_hz
        offset = (stream.start_time_s - stream.plates[0].start_time_s) * stream.plate_rate_hz
        until = offset + (number + 0.5) * ratio - WHOLE  # long ago for a frame without a number
        # Each wait in vain halves the next: frames go on coming meanwhile, and the filter has room for a few only.
        patience = (0.5 / stream.rate_hz + LATE_S) * 0.5**self._overdue if self._overdue < GIVEN_UP else 0.0
        deadline = arrival_s + patience
        parts: list[PlateSamples] = []
        before = self._newest_sample
        if not self._heard_plates_s:
            self._heard_plates_s = arrival_s
        try:
            missing = self._missing(until)
            while True:  # asked once at least: a source that counts anew is ahead of itself
                heard_until = min(deadline, self._heard_plates_s + QUIET_S)
                due = 0 < missing <= JUMP_S * stream.plate_rate_hz
                wait = max(0.0, heard_until - time.perf_counter()) if due else 0.0
                # All that a frame brings in one call: each return waits for the interpreter.
                found, stamps = self._plates.pull_chunk(
                    timeout=wait, max_samples=CHUNK, min_samples=max(1, min(missing, int(ratio), CHUNK))
                )
                if len(found):
                    self._heard_plates_s = time.perf_counter()
                    parts.append(self._placed(found, stamps))
                    self._newest_sample = int(parts[-1].index[-1])
                    missing = self._missing(until)
                if missing <= 0 or not (len(found) or wait):
                    break
            self._judge_plates(missing, before, waited_out=time.perf_counter() >= deadline)
        except self._lsl.util.LostError:
            self._lose("plates")
        if not parts:
            return PlateSamples.none(len(stream.plates))
        if len(parts) == 1:
            return parts[0]
        return PlateSamples(
            np.concatenate([part.index for part in parts]), np.concatenate([part.wrench for part in parts])
        )

    def _judge_plates(self, missing: int, before: int | None, waited_out: bool) -> None:
        """Counts frames whose plates came too late; plates that were only a little late are waited for again."""
        assert self._stream is not None
        comes = self._newest_sample is not None and self._newest_sample != before
        if missing <= 0:
            self._overdue = 0
        elif self._overdue < GIVEN_UP:
            self._overdue += waited_out
        elif comes and missing < LATE_S * self._stream.plate_rate_hz:
            self._overdue = GIVEN_UP - 1

    def _missing(self, until: float) -> int:
        """Number of samples to come until that index."""
        return 1 if self._newest_sample is None else ceil(until) - self._newest_sample

    def _placed(self, samples: Array, stamps: Array) -> PlateSamples:
        assert self._stream is not None
        if self._counted:
            index = counts(samples[:, self._plate_layout.counter])
        else:
            index = counts((np.asarray(stamps) - self._first_stamp) * self._stream.plate_rate_hz)
        return PlateSamples(index, self._plate_layout.wrenches(samples))

    def _lose(self, kind: str) -> None:
        """A stream broke off; it is looked for in the background."""
        name = self._name if kind == "markers" else self._plates_name
        self._news.append((f"{kind} gone", f"the stream '{name}' broke off and is looked for"))
        if kind == "plates":
            self._plates, self._newest_sample = None, None
        else:
            self._markers = None
            if self._plates is not None:
                self._lose("plates")
        self._finders[kind] = self._lsl.ContinuousResolver("name", name, forget_after=2.0)

    def _found_again(self, timeout_s: float) -> bool:
        """True once the marker stream is back with the same markers and rate."""
        inlet = self._again("markers", timeout_s)
        if inlet is None:
            return False
        assert self._stream is not None
        try:
            description, layout, _ = read_marker_info(inlet.info(OPEN_S))
            same = description.marker_names == self._stream.marker_names
            if not same or description.rate_hz != self._stream.rate_hz:
                raise InvalidInput(f"the stream '{self._name}' came back with other markers or another rate")
        except (MbkfError, self._lsl.util.LostError, self._lsl.util.TimeoutError) as error:
            self._news.append(("refused", str(error)))
            time.sleep(timeout_s)
            return False
        self._markers, self._layout = inlet, layout
        self._news.append(("markers back", f"the stream '{self._name}' is back"))
        del self._finders["markers"]
        return True

    def _found_plates_again(self) -> None:
        if "plates" not in self._finders:
            return
        inlet = self._again("plates", 0.0)
        if inlet is None:
            return
        assert self._stream is not None
        del self._finders["plates"]
        try:
            plates, layout = read_plates_info(inlet.info(OPEN_S))
            if [one.name for one in plates] != [one.name for one in self._stream.plates]:
                raise InvalidInput(f"the stream '{self._plates_name}' came back with other plates")
            if plates[0].rate_hz != self._stream.plate_rate_hz:
                raise InvalidInput(f"the stream '{self._plates_name}' came back with another rate")
        except MbkfError as error:
            self._news.append(("plates refused", f"{error}; going on without plates"))
            return
        except (self._lsl.util.LostError, self._lsl.util.TimeoutError):  # gone again
            self._lose("plates")
            return
        self._plates, self._plate_layout, self._heard_plates_s = inlet, layout, 0.0
        self._news.append(("plates back", f"the stream '{self._plates_name}' is back"))

    def _again(self, kind: str, timeout_s: float) -> Any:
        found = self._finders[kind].results()
        if not found:
            time.sleep(timeout_s)
            return None
        return self._inlet(found[0], counted=self._counted)
