"""Before a long trial is filtered: what is decided for all of it, and its markers, plates and other contacts by pieces.

Axes, use of names, marker positions, dofs without a marker and contradictions of plates with their own area are decided
by a look at frames spread over the trial; exchanged names, mixtures, entering frames, faults of plates and contacts of
other parts by each piece with its margins.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.filters.estimate import Recording
from mbkf.io.capture_pieces import CapturePieces
from mbkf.io.findings import Finding
from mbkf.io.paged import PagedArray
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.scaling.trial_lengths import LengthEvidence
from mbkf.sensors.contact.cleaning import cleaned
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.sensors.supports.block import BEARING
from mbkf.trial.checks.in_view import in_view_finding
from mbkf.trial.checks.trial import trial_checks
from mbkf.trial.long.merging import Remarks, joined_loads, unusual_checks, usual_checks
from mbkf.trial.long.pieces import Piece, PieceSettings, pieces_of
from mbkf.trial.order import needs_motion, put_right, ready, searches_contacts
from mbkf.trial.preparation.coverage import MarkerUse
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.markers_alone import Motion, fill_motion
from mbkf.trial.preparation.other_contacts import with_other_contacts
from mbkf.trial.preparation.selection import (
    hidden_samples,
    subject_markers,
    without_plates,
    without_samples,
)
from mbkf.trial.preparation.settings import ReconstructSettings


class Alone(NamedTuple):
    """The motion of markers alone, in files: (T, nq) configurations and (T, nv) velocities."""

    q: PagedArray
    v: PagedArray


@dataclass
class LongTrial:
    """A trial that is read in pieces, and what is decided for all of it.

    Attributes:
        source: Its frames.
        lengths: Lengths of the pieces.
        settings: Settings of the reconstruction.
        subject: The person, as tracked.
        before: The person before markers were corrected on the trial; None where they were not.
        evidence: Segment lengths by that correction; None without it.
        use: Use of the capture's markers.
        inputs: Inputs of the filters, with the look's plates.
        recording: Readings of the instruments, in files.
        measured: (T, M, 3) the subject's markers, in a file; hidden samples are kept.
        notes: Remarks on the trial.
        remarks, contact_remarks: Remarks of its pieces on markers and plates, and on contacts of other parts.
        exchanged: Frames by pair of markers whose names are exchanged.
        checks, views: Checks of each piece, and those for other persons in view.
    """

    source: CapturePieces
    lengths: PieceSettings
    settings: ReconstructSettings
    subject: Subject
    before: Subject | None
    evidence: LengthEvidence | None
    use: MarkerUse
    inputs: FilterInputs
    recording: Recording
    measured: PagedArray
    notes: tuple[str, ...]
    remarks: Remarks = field(default_factory=Remarks)
    exchanged: dict[tuple[str, str], int] = field(default_factory=dict)
    checks: list[tuple[Finding, ...]] = field(default_factory=list)
    views: list[tuple[Finding, ...]] = field(default_factory=list)
    contact_remarks: Remarks = field(default_factory=Remarks)

    @property
    def rate_hz(self) -> float:
        """Frame rate."""
        return self.source.look.markers.rate_hz

    @property
    def begin_s(self) -> float:
        """Time of the first frame."""
        return self.source.look.markers.start_time_s

    def pieces(self) -> Iterator[Piece]:
        """The pieces, in order."""
        return pieces_of(self.source.frames, self.rate_hz, self.lengths)

    def times_s(self, piece: Piece) -> Array:
        """Times of a piece's frames and margins."""
        return self.begin_s + np.arange(piece.begin, piece.end) / self.rate_hz

    def capture(self, piece: Piece) -> Capture:
        """A piece of the capture with its margins."""
        return self.source.piece(piece.begin, piece.end)

    def plates(self, capture: Capture) -> tuple[tuple[PlateReadings, ...], tuple[str, ...]]:
        """A piece's plates that are used, without impossible readings; and remarks on these."""
        return cleaned(without_plates(capture, self.settings.without_plates).plates, self.subject.mass_kg)

    def markers(self, piece: Piece) -> MarkerTrajectories:
        """A piece's markers with its margins, under the subject's names."""
        return MarkerTrajectories(
            self.inputs.names, self.measured[piece.whole], self.rate_hz, float(self.times_s(piece)[0])
        )

    def shown(self, piece: Piece) -> MarkerTrajectories:
        """A piece's markers with its margins, without hidden samples."""
        own = self.markers(piece)
        return without_samples(own, hidden_samples(own, self.settings.hide))

    def all_checks(self) -> tuple[Finding, ...]:
        """The usual finding of each check."""
        return usual_checks([*self.checks, *self.views])

    def unusual(self) -> tuple[str, ...]:
        """Remarks on checks that are outside their bounds in some pieces only."""
        return unusual_checks([*self.checks, *self.views])


def prepared(
    source: CapturePieces,
    subject: Subject,
    settings: ReconstructSettings,
    lengths: PieceSettings,
    folder: Path,
    progress: StageCallback | None,
) -> LongTrial:
    """The trial, with all that its filter reads.

    Args:
        source: Its frames, in right axes.
        subject: The person.
        settings: Settings of the reconstruction.
        lengths: Lengths of the pieces.
        folder: Folder for files of arrays.
        progress: Called with the stage, items done and items in all.

    Raises:
        NotObservable: Too few of the subject's markers to track the body.
        NotConverged: The markers do not fit the subject's body.
        UnknownName: A hidden marker or a withheld plate does not exist.
    """
    look = source.look
    times_s = look.markers.start_time_s + source.look_frames / look.markers.rate_hz
    decided = ready(look, subject, settings, times_s)
    inputs = decided.inputs
    frames, page = source.frames, lengths.frames
    markers = (frames, len(inputs.names), 3)
    kept = PagedArray.unknown(folder / "measured", markers, page)
    shown = PagedArray.unknown(folder / "shown", markers, page) if settings.hide else kept
    wrenches = PagedArray.unknown(folder / "plates", (frames, len(inputs.plates), 6), page)
    recording = Recording(cast(Any, shown), cast(Any, wrenches), inputs.dt_s)
    trial = LongTrial(
        source,
        lengths,
        settings,
        decided.subject,
        decided.before,
        decided.lengths,
        decided.use,
        replace(inputs, remarks=()),
        recording,
        kept,
        (*look.notes, *decided.notes),
    )
    _read(trial, subject, shown, wrenches, progress)
    alone = _alone(trial, folder, progress) if needs_motion(settings, inputs) else None
    if settings.checks or alone is not None:
        _judge(trial, alone, folder, progress)
    return trial


def _read(
    trial: LongTrial,
    subject: Subject,
    shown: PagedArray,
    wrenches: PagedArray,
    progress: StageCallback | None,
) -> None:
    """Reads markers and plates of all pieces.

    Args:
        trial: The trial, whose markers and remarks are filled.
        subject: The person, with marker positions as they were.
        shown: (T, M, 3) receives the markers that are used.
        wrenches: (T, P, 6) receives the plates.
        progress: Called with the stage, items done and items in all.
    """
    for piece in trial.pieces():
        capture, times_s = trial.capture(piece), trial.times_s(piece)
        own, exchanged, notes = put_right(capture.markers, subject, trial.settings)
        trial.measured[piece.own] = own.positions_m[piece.inner]
        if shown is not trial.measured:
            shown[piece.own] = trial.shown(piece).positions_m[piece.inner]
        plates, remarks = trial.plates(capture)
        wrenches[piece.own] = plate_wrenches(plates, times_s, trial.rate_hz)[piece.inner]
        trial.remarks.add([*capture.notes, *notes, *remarks], *times_s[piece.inner][[0, -1]].tolist())
        raw = subject_markers(capture.markers, subject)
        for a, b, _ in exchanged:
            count = _taken_from(own, raw, a, b, piece.inner) + trial.exchanged.get((a, b), 0)
            trial.exchanged[a, b] = count
        if trial.settings.checks:
            trial.views.append((in_view_finding(capture.markers, trial.use.used),))
        if progress is not None:
            progress("Reading", piece.after, trial.source.frames)
    for array in {id(one): one for one in (trial.measured, shown, wrenches)}.values():
        array.close_writing()


def _taken_from(own: MarkerTrajectories, raw: MarkerTrajectories, a: str, b: str, inner: slice) -> int:
    """Number of a piece's own frames in which a marker has the place that the file gives to another name."""
    mine = own.positions_m[inner, own.names.index(a)]
    return int((mine == raw.positions_m[inner, raw.names.index(b)]).all(axis=1).sum())


def _alone(trial: LongTrial, folder: Path, progress: StageCallback | None) -> Alone:
    """The motion of markers alone."""
    frames, page, model = trial.source.frames, trial.lengths.frames, trial.inputs.sensor.model
    q, v = (
        PagedArray.unknown(folder / name, (frames, size), page)
        for name, size in (("alone_q", model.nq), ("alone_v", model.nv))
    )
    followed = None if progress is None else partial(progress, "Following markers alone")
    fill_motion(q, v, trial.inputs, trial.recording, followed)
    for array in (q, v):
        array.close_writing()
    return Alone(q, v)


def _judge(trial: LongTrial, alone: Alone | None, folder: Path, progress: StageCallback | None) -> None:
    """Adds what markers and plates show: checks, contradictions, contacts of other parts."""
    parts = len(trial.inputs.sensor.model.description.bearings)
    bears = PagedArray(
        folder / "bears", lambda a, b: np.zeros((b - a, parts)), trial.source.frames, trial.lengths.frames
    )
    found = False
    loads: list[UnexplainedLoad] = []
    for piece in trial.pieces():
        times_s, shown = trial.times_s(piece), trial.shown(piece)
        motion = None if alone is None else Motion(alone.q[piece.whole], alone.v[piece.whole])
        plates, _ = trial.plates(trial.capture(piece))
        inputs = replace(trial.inputs, plates=plates)
        recording = Recording(shown.positions_m, trial.recording.plates[piece.whole], inputs.dt_s)
        if motion is not None and searches_contacts(trial.settings):
            inputs, recording = with_other_contacts(
                inputs, recording, times_s, motion, trial.settings.smooths
            )
            loads += inputs.contradictions
            if BEARING in recording.readings:
                bears[piece.own] = recording.readings[BEARING][piece.inner]
                found = True
            trial.contact_remarks.add(inputs.remarks, *times_s[piece.inner][[0, -1]].tolist())
        if trial.settings.checks:
            seen = shown, trial.subject, inputs, recording, motion, trial.before, trial.evidence
            trial.checks.append(trial_checks(*seen))
        if progress is not None:
            progress("Checking", piece.after, trial.source.frames)
    contradictions = joined_loads(loads, 1.0 / trial.rate_hz)
    trial.inputs = replace(trial.inputs, contradictions=contradictions, other_contacts=found)
    bears.close_writing()
    if found:
        trial.recording = replace(trial.recording, readings={BEARING: cast(Any, bears)})
