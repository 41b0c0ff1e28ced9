"""One trial of a batch reconstructed into a folder of its own, which appears whole or not at all."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from mbkf.conventions import StageCallback
from mbkf.io.atomic import check_folder, write_text
from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import LABELS_FILE, RESULT_FILES, read_reconstruction, write_result_files
from mbkf.io.session import plain_events
from mbkf.io.subject import Subject, read_subject
from mbkf.study.batch.curves import write_curves
from mbkf.study.batch.inputs import RECORD, digest, fingerprint, is_made_from, read_record, write_record
from mbkf.study.batch.naming import named
from mbkf.study.batch.other_person import checked_owner
from mbkf.study.batch.plan import Trial
from mbkf.study.batch.progress import READING, WRITING, ignored
from mbkf.trial.preparation.settings import ReconstructSettings, recorded
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise

CURVES_FILE = "curves.parquet"
"""File of a trial's cycles in its result folder."""


DOUBTS = "doubts"
"""Key of a trial's record for doubts about its person."""


def trial_done(
    trial: Trial,
    subject: Path,
    out: Path,
    settings: ReconstructSettings,
    progress: StageCallback = ignored,
) -> bool:
    """Reconstructs a trial, unless its folder was made from the same inputs before; returns whether anything was done.

    Where only the events by hand are others than before, only the curves are made again.

    Args:
        trial: The trial.
        subject: The person's file.
        out: The batch's folder.
        settings: The filter and its settings.
        progress: Called with the stage, items done and items in all.

    Raises:
        MbkfError: An input is unusable, or the trial is another person's.
        OSError: A file cannot be read or written; nothing half-written stays.
    """
    progress(READING, 0, 1)
    target = out / trial.place
    files = [trial.path, subject, *([] if trial.forces is None else [trial.forces])]
    run_settings = recorded(settings)
    del run_settings["kernel"]  # both find the same
    made_from = fingerprint(files, run_settings)
    if trial.events is not None:
        made_from["events"] = plain_events(trial.events)
    if is_made_from(target / RECORD, made_from):
        return curves_anew(trial, out)
    check_folder(target, (*RESULT_FILES, CURVES_FILE))
    person = _person(subject, digest(subject))
    given = named(read_capture(trial.path, forces=trial.forces), person)
    doubts = checked_owner(trial, given.capture, person)
    result = reconstruct(given.capture, person, settings=settings, progress=progress)
    progress(WRITING, 0, 1)
    result = replace(result, warnings=(*result.warnings, *given.warnings))
    with replacing_folder(target, last=RECORD) as partial:
        write_result_files(result, summarise(result), partial)
        write_curves(result, partial / CURVES_FILE, trial.events)
        if given.summary is not None:
            labels = json.dumps(given.summary, indent=2) + "\n"
            write_text(partial / LABELS_FILE, labels)
        write_record(partial / RECORD, {**made_from, DOUBTS: doubts} if doubts else made_from)
    return True


@lru_cache(maxsize=1)
def _person(subject: Path, _content: str) -> Subject:
    """The person in a file of this content; most trials of a worker follow one of the same person."""
    return read_subject(subject)


def trial_doubts(trial: Trial, out: Path) -> str:
    """Doubts about the person of a trial that was done; empty without any.

    Args:
        trial: The trial.
        out: The batch's folder.

    Raises:
        FileFormatError: Its record is missing or damaged.
    """
    return str(read_record(out / trial.place / RECORD).get(DOUBTS, ""))


def curves_anew(trial: Trial, out: Path) -> bool:
    """Makes the curves of a trial that was done again, unless its events are those of before; returns whether it did.

    The record is written last: a kill in between leaves the record of the events before, and the curves are made
    once more.

    Args:
        trial: The trial.
        out: The batch's folder.

    Raises:
        FileFormatError: Its result or record is missing or damaged.
        OSError: A file cannot be read or written.
    """
    target = out / trial.place
    events = None if trial.events is None else plain_events(trial.events)
    made_from = read_record(target / RECORD)
    if made_from.get("events") == events:
        return False
    write_curves(read_reconstruction(target), target / CURVES_FILE, trial.events)
    write_record(target / RECORD, {**made_from, "events": events})
    return True
