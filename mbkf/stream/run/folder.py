"""The folder of a live run: its log while it goes on, and the results made of it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from mbkf.errors import MbkfError
from mbkf.io.atomic import replacing
from mbkf.io.results_folder import Summary, write_reconstruction
from mbkf.io.subject import Subject, write_subject
from mbkf.pipelines.live.log import SUBJECT_FILE, LiveLog, LiveStream
from mbkf.pipelines.live.results import live_results
from mbkf.pipelines.reconstruct import ReconstructSettings, recorded
from mbkf.pipelines.results.summary import summarise
from mbkf.stream.source import StreamDescription

LOG_FOLDER = "live-log"
"""Folder in the output folder that holds the log while a run goes on, and after one whose results could not be made."""


def open_log(
    folder: Path,
    stream: StreamDescription,
    rows: np.dtype,
    settings: ReconstructSettings,
    names: tuple[str, ...],
    subject: Subject,
) -> LiveLog:
    """Begins the log of a run; one that an earlier run left behind is set aside under another name.

    Args:
        folder: The output folder.
        stream: The stream's description.
        rows: Type of a row.
        settings: The filter and its settings.
        names: (M,) markers tracked.
        subject: The person.

    Raises:
        OSError: It cannot be written.
    """
    place = folder / LOG_FOLDER
    if place.exists():
        earlier = (folder / f"{LOG_FOLDER}-{k}" for k in range(1, 1_000_000))
        place.rename(next(path for path in earlier if not path.exists()))
    kept = LiveStream(stream.trial, stream.rate_hz, stream.start_time_s, stream.plates)
    log = LiveLog(place, kept, rows, recorded(settings), list(names))
    with replacing(place / SUBJECT_FILE) as partial:
        write_subject(subject, partial)
    return log


def write_results(folder: Path, notes: tuple[str, ...]) -> tuple[Summary | None, str | None]:
    """Makes the results from the log and writes them; returns the summary, or the reason why there is none.

    Args:
        folder: The output folder.
        notes: Remarks for the reader.
    """
    try:
        found = live_results(folder / LOG_FOLDER, notes)
        summary = summarise(found)
        write_reconstruction(found, summary, folder)
    except (MbkfError, OSError) as error:
        return None, str(error)
    return summary, None


def drop_log(folder: Path) -> None:
    """Removes the log of a run whose results are written."""
    shutil.rmtree(folder / LOG_FOLDER, ignore_errors=True)
