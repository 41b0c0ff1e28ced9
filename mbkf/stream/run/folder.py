"""The folder of a live run: its log while it goes on, and the results made of it."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mbkf.errors import MbkfError
from mbkf.io.frame_log import FrameLogWriter
from mbkf.io.results_folder import Summary, write_reconstruction
from mbkf.io.subject import Subject, read_subject, write_subject
from mbkf.stream.source import StreamDescription
from mbkf.trial.live.log import SUBJECT_FILE, LiveLog, LiveStream, read_live_log
from mbkf.trial.live.recording import open_recording
from mbkf.trial.live.results import results_of
from mbkf.trial.results.summary import summarise

LOG_FOLDER = "live-log"
"""Folder in the output folder that holds the log while a run goes on, and after one whose results could not be made."""


def open_log(
    folder: Path,
    stream: StreamDescription,
    rows: np.dtype,
    settings: Mapping[str, object],
    names: tuple[str, ...],
    subject: Subject,
    record: Path | None = None,
) -> LiveLog:
    """Begins the log of a run; one that an earlier run left behind is set aside under another name.

    Args:
        folder: The output folder.
        stream: The stream's description.
        rows: Type of a row.
        settings: The filter and its settings, as plain data.
        names: (M,) markers tracked.
        subject: The person.
        record: C3D file that the run is recorded for; None for no recording.

    Raises:
        OSError: It cannot be written.
    """
    place = folder / LOG_FOLDER
    if place.exists():
        earlier = (folder / f"{LOG_FOLDER}-{k}" for k in range(1, 1_000_000))
        place.rename(next(path for path in earlier if not path.exists()))
    kept = LiveStream(
        stream.trial,
        stream.rate_hz,
        stream.start_time_s,
        stream.plates,
        stream.sensors,
        stream.marker_names,
    )
    recording: Sequence[FrameLogWriter] = ()
    try:
        write_subject(subject, place / SUBJECT_FILE)
        recording = () if record is None else open_recording(place, kept, record)
        return LiveLog(place, kept, rows, dict(settings), list(names), recording)
    except BaseException:
        for one in recording:
            one.close()
        drop_log(folder)  # a log without a run
        raise


class WrittenResults(NamedTuple):
    """Outcome of a run's log.

    Attributes:
        summary: The contents of summary.json; None where no results could be made.
        problem: The reason.
        left_out: A sentence for each file of the log of which damaged rows are left out.
    """

    summary: Summary | None
    problem: str | None
    left_out: tuple[str, ...] = ()


def write_results(folder: Path, notes: tuple[str, ...]) -> WrittenResults:
    """Makes the results from the log in an output folder and writes them, with notes for their reader."""
    log = folder / LOG_FOLDER
    left_out: tuple[str, ...] = ()
    try:
        logged = read_live_log(log)
        left_out = logged.left_out
        found = results_of(logged, read_subject(log / SUBJECT_FILE), notes)
        summary = summarise(found)
        write_reconstruction(found, summary, folder)
    except (MbkfError, OSError) as error:
        return WrittenResults(None, str(error), left_out)
    except Exception as error:  # the log must outlive whatever a damaged or strange one brings about
        return WrittenResults(None, f"an unforeseen {type(error).__name__}: {error}", left_out)
    return WrittenResults(summary, None, left_out)


def drop_log(folder: Path) -> None:
    """Removes the log of a run whose results are written."""
    shutil.rmtree(folder / LOG_FOLDER, ignore_errors=True)
