"""The results of a live run from its log, equal to the causal ones of ``reconstruct`` on the same frames."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.errors import NotObservable
from mbkf.filters.tracking import track_of
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import read_subject
from mbkf.numerics.threads import single_threaded
from mbkf.pipelines.live.filter import live_inputs
from mbkf.pipelines.live.log import SUBJECT_FILE, Logged, read_live_log
from mbkf.pipelines.reconstruct import ReconstructSettings, assemble


def live_results(folder: Path, notes: tuple[str, ...] = ()) -> Reconstruction:
    """Motion, torques and reactions of a logged run.

    Args:
        folder: The log.
        notes: Remarks for the reader, e.g. of lost frames.

    Raises:
        FileFormatError: The log is missing or damaged.
        NotObservable: In no frame did the markers fit the body.
    """
    logged = read_live_log(folder)
    if logged.left_out:
        notes = (
            *notes,
            f"live: {logged.left_out} rows of the log are damaged, or came after a gap of an hour",
        )
    subject = read_subject(folder / SUBJECT_FILE)
    chosen = str(logged.settings["filter"])
    settings = ReconstructSettings(filter=chosen, smooth=False, correct_markers=False)
    result = track_of(logged.rows)
    if not result.starts:
        raise NotObservable(
            "in no frame of the stream did the markers fit the scaled body; is this the subject's protocol, "
            "and is the vertical axis right (--up)?"
        )
    measured = _measured(logged)
    # A stream may have held nonsense, which ends as NaN.
    with single_threaded(), np.errstate(invalid="ignore", divide="ignore"):
        inputs = live_inputs(logged.names, measured.rate_hz, logged.stream.plates, subject, settings).inputs
        capture = Capture(logged.stream.trial, measured, logged.stream.plates, notes=notes)
        hidden = np.zeros(measured.present.shape, dtype=bool)
        found = assemble(capture, subject, settings, measured, hidden, inputs, result)
    return replace(found, settings=logged.settings)


def _measured(logged: Logged) -> MarkerTrajectories:
    start = logged.stream.start_time_s + logged.first / logged.stream.rate_hz
    return MarkerTrajectories(logged.names, logged.rows["measured_m"], logged.stream.rate_hz, start)
