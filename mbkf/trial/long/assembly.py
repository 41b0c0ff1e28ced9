"""The result of a long trial from the records of its filter, piece by piece, and the judgement of the whole."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.filters.record import UNASKED, Track
from mbkf.filters.tracking import Settled, track_of
from mbkf.io.contacts import ContactInterval
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.paged import PagedArray
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import Summary
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.long.merging import Remarks, joined_contacts, joined_loads
from mbkf.trial.long.numbers import KeyNumbers
from mbkf.trial.long.pieces import Piece
from mbkf.trial.long.prepared import LongTrial
from mbkf.trial.order import result_of
from mbkf.trial.preparation.exchanged import renamed_by_filter
from mbkf.trial.preparation.selection import hidden_samples
from mbkf.trial.results import innovations
from mbkf.trial.results.assembly import in_time
from mbkf.trial.results.progression import (
    Progression,
    frame_of,
    laboratory,
    path_and_facing,
    standing_height,
)
from mbkf.trial.results.summary import contact_summary, progression_summary
from mbkf.trial.results.supports import supports_remarks
from mbkf.trial.results.warnings import TrackCounts, finding_warnings, subject_warnings, track_warnings
from mbkf.trial.verdict.evidence import Found, evidence_from
from mbkf.trial.verdict.judge import judge
from mbkf.trial.verdict.sums import Followed, TrialSums, frames_of


@dataclass(frozen=True)
class Survey:
    """Findings from the records of all frames.

    Attributes:
        frame: The frame of the pelvis's angles.
        smoothed: Later frames corrected earlier ones.
        decides: The filter decides what the feet stand on.
        counts: Frames that did not go as usual.
    """

    frame: Progression
    smoothed: bool
    decides: bool
    counts: TrackCounts


def assembled(
    trial: LongTrial,
    rows: PagedArray,
    settled: Settled,
    write: Callable[[Reconstruction], None],
    progress: StageCallback | None,
) -> tuple[Reconstruction, Summary, bool]:
    """Gives the result piece by piece, and at the end what holds for the whole trial.

    Args:
        trial: The trial.
        rows: (T,) records of its frames.
        settled: Findings of the filter that are complete at the last frame.
        write: Called with each piece, without margins, in order.
        progress: Called with the stage, items done and items in all.

    Returns:
        The last piece with attributes and remarks of the whole trial, its summary, and False where the verdict leaves
        no valid frame.
    """
    survey, whole = _survey(trial, rows), _Whole(trial)
    piece_result: Reconstruction | None = None
    for piece in trial.pieces():
        piece_result = _result(trial, piece, rows, settled, survey)
        whole.add_contacts(piece_result, piece.inner)
        piece_result = piece_result.part(piece.inner)
        write(piece_result)
        whole.add(piece_result)
        if progress is not None:
            progress("Assembling", piece.after, trial.source.frames)
    assert piece_result is not None
    doubts = in_time(settled.limb_doubts, np.array([trial.begin_s]))
    return whole.finished(piece_result, survey, doubts)


def _survey(trial: LongTrial, rows: PagedArray) -> Survey:
    """Findings from the records of all frames, each of which is read once."""
    model, frames = trial.inputs.sensor.model, trial.source.frames
    path_m, facing = np.full((2, frames, 2), np.nan)
    counts, corrected, decides = TrackCounts(), 0, 0
    for piece in trial.pieces():
        own = rows[piece.own]
        path_m[piece.own], facing[piece.own] = path_and_facing(model, np.array(own["q"]))
        counts.add(own)
        corrected += int((own["known"] & ~own["uncorrected"]).sum())
        decides += int((own["footing"][:, 0] != UNASKED).sum())
    times_s = trial.begin_s + np.arange(frames) / trial.rate_hz
    lab = trial.settings.pelvis == "lab"
    frame = laboratory(frames) if lab else frame_of(path_m, facing, times_s, standing_height(model))
    return Survey(frame, trial.settings.smooths and corrected > 0, decides > 0, counts)


def _result(
    trial: LongTrial, piece: Piece, rows: PagedArray, settled: Settled, survey: Survey
) -> Reconstruction:
    """The result of a piece, with its margins."""
    track = _track(piece, rows, settled, survey)
    capture = replace(trial.capture(piece), notes=())
    later_s = piece.begin / trial.rate_hz
    named, doubts = trial.markers(piece), [in_piece(one, later_s) for one in settled.limb_doubts]
    hidden = hidden_samples(named, trial.settings.hide)
    measured, _ = renamed_by_filter(named, doubts)
    plates, _ = trial.plates(capture)
    frame = replace(
        survey.frame,
        heading_rad=survey.frame.heading_rad[piece.whole],
        turning_rad_s=survey.frame.turning_rad_s[piece.whole],
    )
    inputs = replace(trial.inputs, plates=plates)
    asked = trial.subject, trial.settings, (measured, hidden, trial.use)
    return result_of(capture, *asked, inputs, track, trial.recording.plates[piece.whole], frame)


def _track(piece: Piece, rows: PagedArray, settled: Settled, survey: Survey) -> Track:
    records = rows[piece.whole]
    track = track_of(records, decides=survey.decides)
    track = replace(track, smoothed=survey.smoothed)
    return track if settled.changes is None else settled.changes.added_to(track, records, piece.begin)


def in_piece(doubt: LimbDoubt, later_s: float) -> LimbDoubt:
    """A doubt with its times since the first frame of a piece."""
    right = doubt.right_from_s
    return replace(
        doubt,
        from_s=doubt.from_s - later_s,
        to_s=doubt.to_s - later_s,
        right_from_s=None if right is None else right - later_s,
    )


class _Whole:
    """Findings on the whole trial, from its pieces."""

    def __init__(self, trial: LongTrial) -> None:
        self._trial, self._numbers, self._remarks = trial, KeyNumbers(), Remarks()
        self._sums: TrialSums | None = None
        self._loads: list[UnexplainedLoad] = []
        self._contacts: list[ContactInterval] = []

    def add_contacts(self, r: Reconstruction, inner: slice) -> None:
        """Adds the stretches of contacts and of unexplained loads of a piece with its margins.

        Args:
            r: The piece with its margins.
            inner: Frames of the piece itself.
        """
        self._loads += r.unexplained
        self._contacts += r.loads.intervals(r.times_s, r.rate_hz, inner)

    def add(self, r: Reconstruction) -> None:
        """Adds a piece without its margins."""
        self._sums = self._sums or TrialSums(Followed.of(r))
        self._numbers.add(r)
        self._sums.add(frames_of(r, self._numbers.settled(r)))
        remarks = (*innovations.remarks(r), *r.warnings)
        self._remarks.add(remarks, float(r.times_s[0]), float(r.times_s[-1]))

    def finished(
        self, last: Reconstruction, survey: Survey, doubts: tuple[LimbDoubt, ...]
    ) -> tuple[Reconstruction, Summary, bool]:
        """The last piece with what holds for the whole trial, the summary, and whether frames may be valid."""
        trial, frame_s = self._trial, 1.0 / self._trial.rate_hz
        assert self._sums is not None
        loads = joined_loads(self._loads, frame_s)
        contacts = joined_contacts(self._contacts, frame_s)
        checks = trial.all_checks()
        found = Found(doubts, loads, contacts, checks, last.markers_explained, last.smoothed)
        verdict = judge(evidence_from(self._sums, found))
        whole = replace(
            last,
            unexplained=loads,
            limb_doubts=doubts,
            checks=checks,
            verdict=verdict,
            uncorrected=survey.counts.uncorrected,
        )
        whole = replace(
            whole,
            warnings=(
                *finding_warnings(checks, whole),
                *trial.unusual(),
                *subject_warnings(trial.subject),
                *trial.notes,
                *trial.remarks.texts(),
                *trial.contact_remarks.texts(),
                *self._remarks.texts(),
                *track_warnings(survey.counts, last.dof_names, trial.inputs.unobservable, "marker"),
                *supports_remarks(contacts),
            ),
            names_exchanged=(*((a, b, n) for (a, b), n in trial.exchanged.items()), *self._taken_up(doubts)),
        )
        summary = self._numbers.summary(whole)
        summary["contacts"] = [contact_summary(one) for one in contacts]
        summary["progression"] = progression_summary(last.direction, survey.frame.heading_rad)
        if not verdict.loads_usable:
            summary["valid_frames"] = 0
        return whole, summary, verdict.loads_usable

    def _taken_up(self, doubts: tuple[LimbDoubt, ...]) -> list[tuple[str, str, int]]:
        """Pairs of markers whose names the filter exchanged, and in how many frames."""
        trial = self._trial
        times_s = trial.begin_s + np.arange(trial.source.frames) / trial.rate_hz
        return [
            (a, b, int((times_s >= one.right_from_s - 0.5 / trial.rate_hz).sum()))
            for one in doubts
            for a, b in one.exchanged
            if one.right_from_s is not None
        ]
