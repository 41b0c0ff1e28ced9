"""Frame alignment: frames numbered, gaps filled, plates averaged over each frame, implausible points removed."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.io.resample import WHOLE
from mbkf.stream.receiving.numbering import Numbered, Numbering, readable
from mbkf.stream.receiving.plate_buffer import PlateBuffer
from mbkf.stream.receiving.rate_watch import RateWatch
from mbkf.stream.receiving.sample_numbering import SampleNumbering
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription, plausible, plausible_imus

BRIDGED_S = 1.0
"""A gap up to this long is filled with empty frames, which keep the filter's clock true; after a longer one it starts
anew."""

NO_POINTS = read_only(np.zeros((0, 3)))
"""The points without names of a frame that has none."""

Note = Callable[[str, str, int | None, int], None]
"""Takes an event: kind, sentence, frame, number of occurrences."""

Record = Callable[[int | None, SourceFrame, PlateSamples], None]
"""Takes a frame as it came: its number here, None for one that came too late, and its samples as they are numbered."""


class ReadyFrame(NamedTuple):
    """A frame for the filter.

    Attributes:
        number: Frame number; never decreases.
        arrival_s: Time of its arrival, for a lost one that of the frame after it.
        markers_m: (M, 3) the subject's markers, NaN where missing; None where they have to be labelled.
        unlabelled_m: (N, 3) points without names.
        plates: (K, 6) mean wrenches about the world's origin, NaN where not read.
        lost: The frame never came.
        imus: (S, 6) readings of inertial sensors, NaN where missing; None where there are none.
        orientations: (S, 4) their orientations, NaN where missing; None where they are not known.
        left_out: Numbers and plates (K, 6) of the frames before it that the filter was too slow for, a second of them.
    """

    number: int
    arrival_s: float
    markers_m: Array | None
    unlabelled_m: Array
    plates: Array
    lost: bool = False
    imus: Array | None = None
    orientations: Array | None = None
    left_out: tuple[tuple[int, Array], ...] = ()


class FrameAlignment:
    """Aligns a stream's frames, one by one.

    Attributes:
        frames_in: Frames that arrived.
        late: Frames that arrived too late, twice or out of order, and were left out.
        lost: Frames that did not arrive, or too late.
    """

    def __init__(
        self,
        stream: StreamDescription,
        columns: Array | None,
        note: Note,
        mass_kg: float | None = None,
        live: bool = False,
        record: Record | None = None,
    ) -> None:
        """An alignment that has seen no frame yet.

        Args:
            stream: The stream's description.
            columns: (M,) columns of the subject's markers in the stream; None for points without names.
            note: Called with events.
            mass_kg: The person's mass, by which readings of the plates are judged; None for not at all.
            live: Whether frames come as they are taken, so that their rate can be measured.
            record: Called with each frame as it came.
        """
        self._stream, self._columns, self._note, self._record = stream, columns, note, record
        self._numbering = Numbering(stream.rate_hz)
        self._plates = PlateBuffer(stream, mass_kg)
        self._ratio = stream.plate_rate_hz / stream.rate_hz
        self._samples = SampleNumbering(stream.plate_rate_hz)
        plates_from_s = stream.plates[0].start_time_s if stream.plates else stream.start_time_s
        self._plate_offset = (stream.start_time_s - plates_from_s) * stream.plate_rate_hz
        self._rate = RateWatch(stream.rate_hz) if live else None
        self._latest = 0
        self._heard_s: float | None = None
        self._plates_silent = False
        self.frames_in = self.late = self.lost = 0

    def accept(self, frame: SourceFrame) -> tuple[list[ReadyFrame], PlateSamples]:
        """Takes the next frame; returns aligned frames, lost ones before it included, and the plates' new samples."""
        self.frames_in += 1
        place = self._numbering.place(frame.number, frame.arrival_s)
        self._watch_rate(frame.arrival_s, place.number)
        if place.number is None:
            self.late += 1
            self._note("late", "frames arrived late, twice or out of order and were left out", None, 1)
            return [], self._take_plates(frame, place)
        self._note_losses(frame, place)
        samples = self._take_plates(frame, place)
        ready = self._missing(place, frame.arrival_s) if place.lost else []
        markers, points = self._points(frame, place.number)
        self._check_plates(frame, place.number)
        return [
            *ready,
            ReadyFrame(
                place.number,
                frame.arrival_s,
                markers,
                points,
                self._plates.mean(place.number),
                imus=self._imus(frame, place.number),
                orientations=frame.orientations,
            ),
        ], samples

    def _missing(self, place: Numbered, arrival_s: float) -> list[ReadyFrame]:
        """Empty frames for those that are missing before a place; none for a gap that is too long to bridge."""
        assert place.number is not None
        if place.lost > BRIDGED_S * self._stream.rate_hz:
            return []
        unseen = None if self._columns is None else np.full((len(self._columns), 3), np.nan)
        return [
            ReadyFrame(n, arrival_s, unseen, NO_POINTS, self._plates.mean(n), lost=True)
            for n in range(place.number - place.lost, place.number)
        ]

    def _note_losses(self, frame: SourceFrame, place: Numbered) -> None:
        if place.reset:
            way = "back" if place.backwards else "ahead"
            jumped = f"jumped {way}" if readable(frame.number) else "cannot be read"
            self._note(
                "clock",
                f"the source's count {jumped}; time here decides how many frames are missing",
                place.number,
                1,
            )
        if place.lost:
            self.lost += place.lost
            self._note("lost", "frames were lost on the way", place.number, place.lost)

    def _points(self, frame: SourceFrame, number: int) -> tuple[Array | None, Array]:
        points, wrong, markers = frame.unlabelled_m, 0, None
        if len(points):
            points, wrong = plausible(points)
            if points is not frame.unlabelled_m:  # some are missing
                points = points[~np.isnan(points).any(axis=1)]
        if self._columns is not None:
            markers, more = plausible(frame.markers_m[self._columns])
            wrong += more
        if wrong:
            self._note("nonsense", "points too far away to be true were left out", number, wrong)
        return markers, points

    def _imus(self, frame: SourceFrame, number: int) -> Array | None:
        if frame.imus is None:
            return None
        imus, wrong = plausible_imus(frame.imus)
        if wrong:
            self._note("nonsense", "readings that no sensor can make were left out", number, wrong)
        return imus

    def _watch_rate(self, arrival_s: float, number: int | None) -> None:
        """Reports once that frames come at another rate than the stream states."""
        found = None if self._rate is None else self._rate.arrived(arrival_s, number)
        if found is not None:
            self._rate = None
            self._note(
                "rate",
                f"frames come at {found:.4g} Hz where the stream states {self._stream.rate_hz:.4g} Hz; times and "
                "velocities are those of the stated rate",
                number,
                1,
            )

    def _take_plates(self, frame: SourceFrame, place: Numbered) -> PlateSamples:
        samples = self._numbered(frame, place)
        if self._record is not None:
            self._record(place.number, frame, samples)
        before, refused = self._plates.missing, self._plates.refused
        taken = self._plates.put(samples)
        if self._plates.missing > before:
            self._note(
                "plates lost",
                "samples of the plates were lost on the way",
                place.number,
                self._plates.missing - before,
            )
        if self._plates.refused > refused:
            self._note(
                "plates refused",
                "readings of the plates that this person cannot make were refused",
                place.number,
                self._plates.refused - refused,
            )
        return taken

    def _numbered(self, frame: SourceFrame, place: Numbered) -> PlateSamples:
        """The plates' samples with numbers that rise; those without one are left out."""
        if place.number is not None:
            self._latest = place.number
        number, samples, fitting = self._latest, frame.plates, None
        if place.reset and place.number is not None and readable(frame.number):
            fitting = round((place.number - frame.number) * self._ratio)
        wanted = ceil(self._plate_offset + (number + 0.5) * self._ratio - WHOLE)
        jumps = self._samples.jumps
        index, kept = self._samples.place(samples.index, frame.arrival_s, wanted, fitting)
        if self._samples.jumps > jumps and not place.reset:
            self._note(
                "plates clock",
                "the plates' count jumped; their samples go on with the frames",
                place.number,
                self._samples.jumps - jumps,
            )
        if index is samples.index:
            return samples
        return PlateSamples(index, samples.wrench if kept is None else samples.wrench[kept])

    def _check_plates(self, frame: SourceFrame, number: int) -> None:
        if not self._stream.plates:
            return
        if len(frame.plates.index) or self._heard_s is None:
            if self._plates_silent and len(frame.plates.index):
                self._note("plates", "the plates are back", number, 1)
                self._plates_silent = False
            self._heard_s = frame.arrival_s
        elif not self._plates_silent and frame.arrival_s - self._heard_s > BRIDGED_S:
            self._plates_silent = True
            self._note("plates", "the plates fell silent; reactions are estimated from the motion", number, 1)
