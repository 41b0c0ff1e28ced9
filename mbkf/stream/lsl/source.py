"""Frames from Lab Streaming Layer: a marker stream, and a plate stream at its own rate beside it."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.stream.identity import moved_counts, named_columns, same_rate
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import MARKER_TYPES, MarkerLayout, StreamInfo, read_marker_info
from mbkf.stream.lsl.inlets import OPEN_S, Inlet, LostStream, inlet_of, opened, streams_of
from mbkf.stream.lsl.plate_stream import FoundPlates, PlateStream, described_plates, from_first_frame
from mbkf.stream.lsl.stamp_numbering import StampedItems, StampNumbering
from mbkf.stream.source import UNCOUNTED, PlateSamples, SourceFrame, StreamDescription, counts

PLATES_S = 3.0
"""Time for which the plate stream that the markers name is looked for."""

RESTARTED_S = 0.5
"""The count of a sender that was started anew is believed where it fits the time that passed within this."""


@dataclass
class Arrived:
    """A frame on its way.

    Attributes:
        arrival_s: When it arrived, on the clock of ``time.perf_counter``.
        stamp_s: Its time stamp.
        sample: (C,) its channels.
        number: Its number, as soon as that is known.
        repeats: How often it came again while its number was not known.
    """

    arrival_s: float
    stamp_s: float
    sample: Array
    number: int | None = None
    repeats: int = 0


class LslSource:
    """A :class:`mbkf.stream.source.FrameSource`."""

    patient = False

    def __init__(self, name: str | None = None, plates_name: str | None = None) -> None:
        """Args: names of the marker stream (default: the first) and of the plate stream (default: its own)."""
        self._lsl = lsl()
        self._name, self._plates_name = name, plates_name
        self._markers: Inlet = None
        self._plates: PlateStream | None = None
        self._opened = False
        self._stream: StreamDescription | None = None
        self._lost: LostStream | None = None
        self._news: list[tuple[str, str]] = []
        self._stamped: StampedItems[Arrived] | None = None
        self._ready: deque[Arrived] = deque()
        self._newest: Arrived | None = None
        self._ahead = 0
        self._counted: Arrived | None = None
        self._uid, self._restarted = "", False

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """The first marker stream that is found, with its plates; frames flow from the first :meth:`read` on."""
        info = self._resolve(self._name, MARKER_TYPES, timeout_s)
        if info is None:
            return None
        try:
            return self._connected(info)
        except (self._lsl.util.LostError, self._lsl.util.TimeoutError):  # gone again
            return None

    def _connected(self, info: StreamInfo) -> StreamDescription:
        full = inlet_of(self._lsl, info, False).info(OPEN_S)
        stream, self._layout, wanted = read_marker_info(full)
        self._name, self._uid = str(info.name()), str(info.uid())
        self._plates_name = self._plates_name or wanted or None
        found = self._find_plates()
        plates = () if found is None else found.plates
        counted = self._layout.counter is not None and (found is None or found.layout.counter is not None)
        if counted:
            self._stamped = None
            self._stream = replace(stream, plates=plates)
        else:
            self._stamped = StampedItems(StampNumbering(stream.rate_hz))
            self._stream = replace(stream, start_time_s=0.0, plates=from_first_frame(plates))
        self._markers, self._opened = inlet_of(self._lsl, info, not counted), False
        if found is not None:
            frames = None if self._stamped is None else self._stamped.numbering
            self._plates = PlateStream(self._lsl, found, self._stream, frames, self._tell)
        return self._stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next marker frame with the plates' samples until its end."""
        assert self._stream is not None, "connect first"
        if not self._opened:
            self._open()
        if self._plates is not None:
            self._plates.find_again()
        while not self._ready:
            if self._markers is None and not self._found_again(timeout_s):
                return None
            if not self._take(timeout_s):
                break
        if not self._ready:
            return None
        one = self._ready.popleft()
        number = UNCOUNTED if one.number is None else one.number
        markers, points = self._layout.points(one.sample)
        plates = PlateSamples.none(0) if self._plates is None else self._plates.samples(number, one.arrival_s)
        return SourceFrame(number, one.arrival_s, markers, points, plates)

    def news(self) -> list[tuple[str, str]]:
        """Events of the connection since the last call."""
        news, self._news = self._news, []
        return news

    def close(self) -> None:
        """Drops both streams."""
        self._markers = self._plates = self._lost = None

    def _tell(self, kind: str, sentence: str) -> None:
        self._news.append((kind, sentence))

    def _resolve(self, name: str | None, types: tuple[str, ...], timeout_s: float) -> StreamInfo | None:
        if name is not None:
            found = self._lsl.resolve_byprop("name", name, 1, timeout_s)
        else:
            found = streams_of(self._lsl, types, timeout_s)
        if types and len(found) > 1:
            others = ", ".join(f"'{one.name()}' from {one.hostname()}" for one in found[1:])
            first = f"'{found[0].name()}' from {found[0].hostname()}"
            self._tell(
                "chosen",
                f"{len(found)} marker streams were found: {first} is followed, not {others}; see --stream",
            )
        return found[0] if found else None

    def _find_plates(self) -> FoundPlates | None:
        """The plate stream that belongs to the markers; None without one."""
        wanted = self._plates_name
        if wanted is None:
            return None
        info = self._resolve(wanted, (), PLATES_S)
        found = None if info is None else described_plates(self._lsl, info)
        if found is None:
            self._tell("plates", f"the plate stream '{wanted}' is missing; going on without plates")
        return found

    def _open(self) -> None:
        """Begins to receive, not before the first frame is asked for: until then frames would only pile up."""
        self._opened = True
        if self._plates is not None:
            self._plates.open()
        if not opened(self._lsl, self._markers, self._stamped is not None):
            self._lose()

    def _take(self, timeout_s: float) -> bool:
        """Receives the next frame; false where none came, or the stream broke off."""
        try:
            sample, stamp = self._markers.pull_sample(timeout_s)
        except self._lsl.util.LostError:
            self._lose()
            return False
        if sample is None:
            self._release([] if self._stamped is None else self._stamped.flush())
            return False
        one = Arrived(time.perf_counter(), stamp, sample)
        if self._stamped is None:
            self._take_counted(one)
        elif self._repeated(one):
            assert self._newest is not None
            if self._newest.number is None:
                self._newest.repeats += 1
            else:
                one.number = self._newest.number
                self._ready.append(one)
        else:
            self._newest, numbering = one, self._stamped.numbering
            jumps = numbering.jumps
            self._release(self._stamped.put(one, stamp, one.arrival_s))
            if numbering.jumps > jumps:
                self._tell("clock", f"the time stamps of '{self._name}' jumped; its frames follow by arrival")
        return True

    def _release(self, found: list[tuple[int, Arrived]]) -> None:
        """Frames whose numbers are known; one that came twice has the same number again."""
        for number, one in found:
            one.number = number
            self._ready.extend([one] * (1 + one.repeats))

    def _repeated(self, one: Arrived) -> bool:
        """True for the frame before once more: the same stamp and the same numbers."""
        before = self._newest
        if before is None or one.stamp_s != before.stamp_s:
            return False
        return np.array_equal(one.sample, before.sample, equal_nan=True)

    def _take_counted(self, one: Arrived) -> None:
        """A frame with a count; that of a sender that was started anew goes on by the time that passed."""
        one.number, before = self._count(one.sample), self._counted
        if self._restarted and one.number != UNCOUNTED and before is not None and before.number is not None:
            assert self._stream is not None
            self._restarted = False
            passed = round((one.arrival_s - before.arrival_s) * self._stream.rate_hz)
            apart = before.number + passed - one.number
            if abs(apart) > RESTARTED_S * self._stream.rate_hz:
                self._ahead += apart
                one.number += apart
                if self._plates is not None:
                    self._plates.frames_ahead += apart
                self._tell("clock", f"'{self._name}' counts anew; the time here numbers its frames")
        if one.number != UNCOUNTED:
            self._counted = one
        self._ready.append(one)

    def _count(self, sample: Array) -> int:
        found = int(counts(sample[self._layout.counter]))
        return found if found == UNCOUNTED else found + self._ahead

    def _refuse(self, error: MbkfError) -> None:
        self._tell("refused", f"the stream '{self._name}' came back as another one: {error}")

    def _lose(self) -> None:
        """The marker stream broke off; it is looked for in the background, and its plates are, too."""
        self._tell("markers gone", f"the stream '{self._name}' broke off and is looked for")
        self._markers, self._lost = None, LostStream(self._lsl, str(self._name))
        self._release([] if self._stamped is None else self._stamped.flush())
        if self._plates is not None:
            self._plates.lose()

    def _found_again(self, timeout_s: float) -> bool:
        """True once the marker stream is back; its markers are found by their names."""
        assert self._stream is not None and self._lost is not None
        known, counted = self._stream, self._stamped is None

        def same(full: StreamInfo) -> tuple[StreamDescription, MarkerLayout]:
            found, layout, _ = read_marker_info(full)
            same_rate(known.rate_hz, found.rate_hz)
            layout = layout.reordered(named_columns("markers", known.marker_names, found.marker_names))
            if counted and layout.counter is None:
                raise InvalidInput("it has no count of frames any more")
            return found, layout

        back = self._lost.returned(not counted, same, self._refuse)
        if back is None:
            time.sleep(timeout_s)
            return False
        info, self._markers, (found, self._layout) = back
        self._lost = None
        self._restarted, self._uid = self._restarted or info.uid() != self._uid, str(info.uid())
        self._ahead = moved_counts(known, found) if counted else 0
        if self._plates is not None:
            self._plates.frames_ahead = 0
        self._tell("markers back", f"the stream '{self._name}' is back")
        return True
