"""Frame alignment: frames numbered, gaps filled, plates averaged over each frame, implausible points removed."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.stream.receiving.numbering import Numbered, Numbering
from mbkf.stream.receiving.plate_buffer import PlateBuffer
from mbkf.stream.receiving.rate import RateWatch
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription, plausible

BRIDGED_S = 1.0
"""A gap up to this long is filled with empty frames, which keep the filter's clock true; after a longer one it starts
anew."""

ALIGNED_S = 0.25
"""After a source restarted its count, plate samples whose own count fits that of the frames within this keep it."""

PLATES_OFF_S, PLATES_OFF_FRAMES = 5.0, 10
"""Plates whose count is off by more than this, or does not go on, in so many frames one after another count anew; a
reader that is behind finds them ahead by less."""

NO_POINTS = read_only(np.zeros((0, 3)))
"""The points without names of a frame that has none."""

Note = Callable[[str, str, int | None, int], None]
"""Takes an event: kind, sentence, frame, number of occurrences."""


class ReadyFrame(NamedTuple):
    """A frame for the filter.

    Attributes:
        number: Frame number; never decreases.
        arrival_s: When it arrived, or for a lost one the frame after it.
        markers_m: (M, 3) the subject's markers, NaN where missing; None where they have to be labelled.
        unlabelled_m: (N, 3) points without names.
        plates: (K, 6) mean wrenches about the world's origin, NaN where not read.
        lost: Whether the frame never came.
    """

    number: int
    arrival_s: float
    markers_m: Array | None
    unlabelled_m: Array
    plates: Array
    lost: bool = False


class FrameAlignment:
    """Aligns a stream's frames, one by one.

    Attributes:
        frames_in: Frames that arrived.
        lost: Frames that did not.
        late: Frames that arrived too late, twice or out of order, and were left out.
    """

    def __init__(
        self,
        stream: StreamDescription,
        columns: Array | None,
        note: Note,
        mass_kg: float | None = None,
        live: bool = True,
    ) -> None:
        """An alignment that has seen no frame yet.

        Args:
            stream: The stream's description.
            columns: (M,) columns of the subject's markers in the stream; None for points without names.
            note: Called with events.
            mass_kg: The person's mass, by which readings of the plates are judged; None for not at all.
            live: Whether frames come when they were measured, not as fast as a file can be read.
        """
        self._live = live
        self._stream, self._columns, self._note = stream, columns, note
        self._numbering = Numbering(stream.rate_hz)
        self._plates = PlateBuffer(stream, mass_kg)
        self._ratio = stream.plate_rate_hz / stream.rate_hz
        self._plate_shift = 0
        self._plates_strange = 0
        self._heard_s: float | None = None
        self._plates_silent = False
        self._rates = RateWatch(stream.rate_hz)
        self.frames_in = self.lost = self.late = 0

    def accept(self, frame: SourceFrame) -> tuple[list[ReadyFrame], PlateSamples]:
        """Takes the next frame; returns aligned frames, lost ones before it included, and the plates' new samples."""
        self.frames_in += 1
        place = self._numbering.place(frame.number, frame.arrival_s)
        if place.number is None:
            self.late += 1
            self._note("late", "frames arrived late, twice or out of order and were left out", None, 1)
            return [], self._take_plates(frame, place)
        self._note_losses(place)
        self._check_rate(frame, place)
        samples = self._take_plates(frame, place)
        ready = self._missing(place, frame.arrival_s) if place.lost else []
        markers, points = self._points(frame, place.number)
        self._check_plates(frame, place.number)
        return [
            *ready,
            ReadyFrame(place.number, frame.arrival_s, markers, points, self._plates.mean(place.number)),
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

    def _check_rate(self, frame: SourceFrame, place: Numbered) -> None:
        """Tells of frames that come at another rate than the stream states, since velocities are wrong by as much."""
        assert place.number is not None
        if self._live and (rate := self._rates.unlike(place.number, frame.arrival_s)) is not None:
            self._note(
                "rate",
                f"frames come at {rate:.0f} Hz, the stream states {self._stream.rate_hz:g} Hz: times, velocities and "
                "torques are wrong",
                place.number,
                1,
            )

    def _note_losses(self, place: Numbered) -> None:
        if place.uncounted:
            self._note(
                "count", "frames came with an impossible count; they follow those before", place.number, 1
            )
        if place.reset:
            way = "back" if place.backwards else "ahead"
            self._note(
                "clock",
                f"the source's count jumped {way}; time here decides how many frames are missing",
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
            points = points[~np.isnan(points).any(axis=1)]
        if self._columns is not None:
            markers, more = plausible(frame.markers_m[self._columns])
            wrong += more
        if wrong:
            self._note("nonsense", "points too far away to be true were left out", number, wrong)
        return markers, points

    def _take_plates(self, frame: SourceFrame, place: Numbered) -> PlateSamples:
        samples = frame.plates
        if place.reset and place.number is not None and len(samples.index):
            self._realign(frame, place.number)
        before, refused = self._plates.missing, self._plates.refused
        if self._plate_shift:
            samples = PlateSamples(samples.index + self._plate_shift, samples.wrench)
        samples = self._in_step(samples, place.number)
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

    def _in_step(self, samples: PlateSamples, number: int | None) -> PlateSamples:
        """Samples whose count goes on with that of the frames; none, until it is sure that the plates count anew."""
        if number is None or not len(samples.index) or not self._stream.plates:
            return samples
        newest, now = int(samples.index[-1]), self._plates.position(number)
        known = self._plates.newest
        off = abs(newest - now) > PLATES_OFF_S * self._stream.plate_rate_hz
        if not off and (known is None or newest > known):
            self._plates_strange = 0
            return samples
        self._plates_strange += 1
        if self._plates_strange < PLATES_OFF_FRAMES:
            return PlateSamples.none(len(self._stream.plates)) if off else samples
        self._plates_strange = 0
        shift = round(now) - newest
        self._plate_shift += shift
        self._note(
            "plates clock", "the count of the plates jumped; their samples are taken as of now", number, 1
        )
        return PlateSamples(samples.index + shift, samples.wrench)

    def _realign(self, frame: SourceFrame, number: int) -> None:
        """Aligns the plates with the frames' new count: by their own count where it fits, else by the latest sample."""
        newest = int(frame.plates.index[-1])
        fitting = round((number - frame.number) * self._ratio)
        wanted = round((number + 0.5) * self._ratio) - newest
        fits = abs(fitting - wanted) <= ALIGNED_S * self._stream.plate_rate_hz
        self._plate_shift = fitting if fits else wanted

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
