"""The plate stream beside a marker stream: samples until the end of each frame, and the stream's return."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from math import ceil
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.records import PlateReadings
from mbkf.io.resample import WHOLE
from mbkf.stream.identity import moved_counts, plate_order
from mbkf.stream.lsl.format import PlateLayout, StreamInfo, read_plates_info
from mbkf.stream.lsl.inlets import OPEN_S, Inlet, LostStream, inlet_of, opened
from mbkf.stream.lsl.stamp_numbering import StampedItems, StampNumbering
from mbkf.stream.source import UNCOUNTED, PlateSamples, StreamDescription, counts

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

APART = 1.5
"""Samples whose stamps are off those of the frames by more than so many frames are numbered anew."""


class FoundPlates(NamedTuple):
    """A plate stream that was found.

    Attributes:
        info: Its information.
        plates: (K,) its plates, without readings.
        layout: Its channels.
    """

    info: StreamInfo
    plates: tuple[PlateReadings, ...]
    layout: PlateLayout


def described_plates(library: ModuleType, info: StreamInfo) -> FoundPlates | None:
    """The plates of a stream; None where it does not answer.

    Raises:
        InvalidInput: Its plates and channels do not belong together.
    """
    try:
        full = inlet_of(library, info, False).info(OPEN_S)
    except (library.util.LostError, library.util.TimeoutError):  # gone again
        return None
    return FoundPlates(info, *read_plates_info(full))


class PlateStream:
    """Samples of the plates, for one frame after the other.

    Attributes:
        frames_ahead: Added to the count of frames; that of the samples moves with it.
    """

    def __init__(
        self,
        library: ModuleType,
        found: FoundPlates,
        stream: StreamDescription,
        frames: StampNumbering | None,
        tell: Callable[[str, str], None],
    ) -> None:
        """A stream that is not received yet.

        Args:
            library: pylsl.
            found: The plate stream.
            stream: Description of frames and plates together.
            frames: Numbers the frames by their stamps; None where frames and samples carry counts.
            tell: Called with events, kind and sentence.
        """
        self._lsl, self._stream, self._frames, self._tell = library, stream, frames, tell
        self._name, self._layout = str(found.info.name()), found.layout
        self._known = found.plates
        self._inlet: Inlet = inlet_of(library, found.info, frames is not None)
        self._lost: LostStream | None = None
        self._stamped: StampedItems[Array] | None = None
        self._ahead = self.frames_ahead = 0
        self._newest: int | None = None
        self._heard_s = 0.0
        self._overdue = 0

    def open(self) -> None:
        """Begins to receive."""
        if not opened(self._lsl, self._inlet, self._frames is not None):
            self.lose()

    def lose(self) -> None:
        """The stream broke off; it is looked for in the background."""
        if self._inlet is not None:
            self._inlet, self._newest = None, None
            self._lost = LostStream(self._lsl, self._name)
            self._tell("plates gone", f"the stream '{self._name}' broke off and is looked for")

    def find_again(self) -> None:
        """Takes the stream up again once it is back; its plates are found by where they lie."""
        counted = self._frames is None

        def same(full: StreamInfo) -> tuple[tuple[PlateReadings, ...], PlateLayout, NDArray[np.intp]]:
            plates, layout = read_plates_info(full)
            if counted and layout.counter is None:
                raise InvalidInput("it has no count of samples any more")
            return plates, layout, plate_order(self._known, plates)

        back = None if self._lost is None else self._lost.returned(not counted, same, self._refuse)
        if back is None:
            return
        _, self._inlet, (plates, layout, order) = back
        self._lost, self._layout, self._heard_s = None, layout.reordered(order), 0.0
        self._ahead = moved_counts(self._known[0], plates[order[0]])
        mapped = np.array_equal(order, np.arange(len(order)))
        told = "" if mapped else ", its plates in another order, and is read by where they lie"
        self._tell("plates back", f"the stream '{self._name}' is back{told}")

    def _refuse(self, error: MbkfError) -> None:
        self._tell(
            "plates refused",
            f"the stream '{self._name}' came back with other plates: {error}; going on without plates",
        )

    def samples(self, number: int, arrival_s: float) -> PlateSamples:
        """Samples since the frame before, waited for until the end of a frame.

        Args:
            number: The frame.
            arrival_s: When it arrived.
        """
        if self._inlet is None:
            return PlateSamples.none(len(self._known))
        stream = self._stream
        ratio = stream.plate_rate_hz / stream.rate_hz
        offset = (stream.start_time_s - stream.plates[0].start_time_s) * stream.plate_rate_hz
        until = offset + (number + 0.5) * ratio - WHOLE  # long ago for a frame without a number
        # Each wait in vain halves the next: frames go on coming meanwhile, and the filter has room for a few only.
        patience = (0.5 / stream.rate_hz + LATE_S) * 0.5**self._overdue if self._overdue < GIVEN_UP else 0.0
        deadline = arrival_s + patience
        parts: list[PlateSamples] = []
        before = self._newest
        if not self._heard_s:
            self._heard_s = arrival_s
        try:
            missing = self._missing(until)
            while True:  # asked once at least: a source that counts anew is ahead of itself
                heard_until = min(deadline, self._heard_s + QUIET_S)
                due = 0 < missing <= JUMP_S * stream.plate_rate_hz
                wait = max(0.0, heard_until - time.perf_counter()) if due else 0.0
                # All that a frame brings in one call: each return waits for the interpreter.
                found, stamps = self._inlet.pull_chunk(
                    timeout=wait, max_samples=CHUNK, min_samples=max(1, min(missing, int(ratio), CHUNK))
                )
                if len(found):
                    self._heard_s = time.perf_counter()
                    placed = self._placed(found, stamps)
                    if len(placed.index):
                        parts.append(placed)
                        self._newest = int(placed.index[-1])
                    missing = self._missing(until)
                if missing <= 0 or not (len(found) or wait):
                    break
            self._judge(missing, before, waited_out=time.perf_counter() >= deadline)
        except self._lsl.util.LostError:
            self.lose()
        if not parts:
            return PlateSamples.none(len(self._known))
        if len(parts) == 1:
            return parts[0]
        return PlateSamples(
            np.concatenate([part.index for part in parts]), np.concatenate([part.wrench for part in parts])
        )

    def _judge(self, missing: int, before: int | None, waited_out: bool) -> None:
        """Counts frames whose plates came too late; plates that were only a little late are waited for again."""
        comes = self._newest is not None and self._newest != before
        if missing <= 0:
            self._overdue = 0
        elif self._overdue < GIVEN_UP:
            self._overdue += waited_out
        elif comes and missing < LATE_S * self._stream.plate_rate_hz:
            self._overdue = GIVEN_UP - 1

    def _missing(self, until: float) -> int:
        """Number of samples to come until that index."""
        return 1 if self._newest is None else ceil(until) - self._newest

    def _placed(self, samples: Array, stamps: Array) -> PlateSamples:
        """Samples (S, C) with their numbers, as far as these are known."""
        wrenches = self._layout.wrenches(samples)
        if self._frames is not None:
            return self._by_stamps(wrenches, stamps, self._frames)
        index = counts(samples[:, self._layout.counter])
        ratio = self._stream.plate_rate_hz / self._stream.rate_hz
        ahead = self._ahead + round(self.frames_ahead * ratio)
        if ahead:
            index = np.where(index == UNCOUNTED, index, index + ahead)
        return PlateSamples(index, wrenches)

    def _by_stamps(self, wrenches: Array, stamps: Array, frames: StampNumbering) -> PlateSamples:
        """Samples (S, K, 6) in order of arrival, numbered on the clock of the frames."""
        rate_hz, frame_hz = self._stream.plate_rate_hz, self._stream.rate_hz
        if self._stamped is None:
            each = max(1, ceil(rate_hz / frame_hz))
            self._stamped = StampedItems(StampNumbering(rate_hz, each, frames.origin_s))
        now, own = time.perf_counter(), self._stamped.numbering
        found = [
            one
            for wrench, stamp in zip(wrenches, stamps, strict=True)
            for one in self._stamped.put(wrench, float(stamp), now)
        ]
        if own.origin_s is not None and frames.origin_s is not None:
            # Frames may have been lost that no stamp proves; the plates follow the frames' clock.
            apart_s = own.origin_s - frames.origin_s
            if abs(apart_s) * frame_hz > APART:
                own.shift(round(apart_s * rate_hz))
        found = [one for one in found if self._newest is None or one[0] > self._newest]
        if not found:
            return PlateSamples.none(wrenches.shape[1])
        return PlateSamples(np.array([n for n, _ in found]), np.array([wrench for _, wrench in found]))


def from_first_frame(plates: tuple[PlateReadings, ...]) -> tuple[PlateReadings, ...]:
    """Plates whose sample 0 is that of frame 0, as where time stamps number both."""
    return tuple(replace(plate, start_time_s=0.0) for plate in plates)
