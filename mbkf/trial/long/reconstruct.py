"""A long trial reconstructed in pieces: the filter goes on from piece to piece, results are written as they are made.

The filter's estimates are those of the whole trial: it goes through all frames once, with its smoother, and leaves
records in a file. What follows from them is computed in pieces with margins. The frame of progression, the mean of the
offsets by the body, and the verdict are those of the whole trial.
"""

from __future__ import annotations

import uuid
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.filters.record import FrameRecorder
from mbkf.filters.tracking import Settled, blank_records, fill
from mbkf.io.atomic import remove_file
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.axes import axes_matrix
from mbkf.io.capture_pieces import CapturePieces
from mbkf.io.leftovers import unfinished
from mbkf.io.paged import PagedArray
from mbkf.io.results_folder import MOTION_FILE, SUMMARY_FILE, Summary, write_summary
from mbkf.io.results_h5 import ResultPieces
from mbkf.io.results_opensim import OPENSIM_FILES
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.long.assembly import assembled
from mbkf.trial.long.pieces import PieceSettings
from mbkf.trial.long.prepared import LongTrial, prepared
from mbkf.trial.preparation.filters import tracking_filter
from mbkf.trial.preparation.other_contacts import contact_opener
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import check_names

RECORD_PAGES = 2
"""Pages of the filter's records in memory: the one that is filled, and the one that is smoothed."""


def reconstruct_long(
    source: CapturePieces,
    subject: Subject,
    folder: Path,
    *,
    settings: ReconstructSettings | None = None,
    lengths: PieceSettings | None = None,
    progress: StageCallback | None = None,
) -> Summary:
    """Tracks the subject through a long capture and writes motion.h5 and summary.json.

    Args:
        source: The capture.
        subject: The scaled person.
        folder: Where to write; made where missing. Its files take their places when all of them are whole.
        settings: The filter and its settings; covariances are not kept.
        lengths: Lengths of the pieces.
        progress: Called with the stage, items done and items in all.

    Returns:
        The contents of summary.json.

    Raises:
        InvalidInput: The axes or the unit of the capture cannot be right, and it is not clear what they are.
        NotObservable: Too few of the subject's markers to track the body.
        NotConverged: The markers do not fit the subject's body.
        UnknownName: A hidden marker, a withheld plate, the filter, the frame of the pelvis or the reading of angles
            does not exist.
        OSError: The folder cannot be written to.
    """
    settings, lengths = settings or ReconstructSettings(), lengths or PieceSettings()
    check_names(settings, subject, sensors=False)
    source = in_axes_of(source, subject, settings)
    with single_threaded(), replacing_folder(folder, last=SUMMARY_FILE) as partial_folder:
        with unfinished(partial_folder / "arrays", folder=True, shown=partial_folder) as pages:
            trial = prepared(source, subject, settings, lengths, pages, progress)
            rows, settled = _filtered(trial, pages, progress)
            run_id, written = uuid.uuid4().hex, ResultPieces(partial_folder / MOTION_FILE, source.frames)
            try:
                last, summary, valid = assembled(trial, rows, settled, written.add, progress)
                written.finish(last, run_id, valid)
            finally:
                written.close()
        write_summary(summary, partial_folder, run_id)
    for name in OPENSIM_FILES:
        remove_file(folder / name)
    return summary


def in_axes_of(source: CapturePieces, subject: Subject, settings: ReconstructSettings) -> CapturePieces:
    """The capture in axes that the person's body shows to be right.

    Args:
        source: The capture.
        subject: The person.
        settings: Settings of the reconstruction.

    Raises:
        InvalidInput: The axes or the unit cannot be right, and it is not clear what they are.
    """
    look = source.look
    checked = checked_for_subject(look, subject, settings.without_plates)
    if checked.axes == look.axes:
        return replace(source, look=checked)
    turn = axes_matrix(checked.axes) @ axes_matrix(look.axes).T
    return replace(source.turned(np.asarray(turn), checked.axes_source), look=checked)


def _filtered(trial: LongTrial, folder: Path, progress: StageCallback | None) -> tuple[PagedArray, Settled]:
    """The filter's records of all frames, and what is known when the last one is."""
    settings, inputs = trial.settings, trial.inputs
    filter = tracking_filter(settings.filter, inputs)
    recorder = FrameRecorder(filter, len(inputs.names), inputs.body, settings.spreads, levels=True)
    blank = partial(blank_records, recorder.dtype)
    rows = PagedArray(folder / "records", blank, trial.source.frames, trial.lengths.frames, RECORD_PAGES)
    settled = fill(
        rows,
        recorder,
        trial.recording,
        smoothing=settings.smoothing if settings.smooths else None,
        lag_s=settings.lag_s,
        body=inputs.body,
        progress=None if progress is None else partial(progress, "Filtering"),
        contacts=None if settings.smooths else contact_opener(inputs, settings),
        kept_bytes=0,
    )
    rows.close_writing()
    return rows, settled
