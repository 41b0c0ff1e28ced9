"""One trial of a batch reconstructed into a folder of its own, which appears whole or not at all."""

from __future__ import annotations

import shutil
import uuid
from contextlib import suppress
from pathlib import Path

from mbkf.io.capture import read_capture
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.subject import read_subject
from mbkf.pipelines.batch.curves import write_curves
from mbkf.pipelines.batch.inputs import RECORD, fingerprint, is_made_from, write_record
from mbkf.pipelines.batch.plan import Trial
from mbkf.pipelines.reconstruct import reconstruct
from mbkf.pipelines.reconstruct_settings import ReconstructSettings, recorded
from mbkf.pipelines.results.summary import summarise

PARTIAL = ".partial-"
"""How folders begin that are not finished."""

CURVES_FILE = "curves.parquet"


def trial_done(trial: Trial, subject: Path, out: Path, settings: ReconstructSettings) -> bool:
    """Reconstructs a trial, unless its folder was made from the same inputs before; returns whether it did.

    Args:
        trial: The trial.
        subject: The person's file.
        out: The batch's folder.
        settings: The filter and its settings.

    Raises:
        MbkfError: An input is unusable.
        OSError: A file cannot be read or written; nothing half-written stays.
    """
    target = out / trial.place
    files = [trial.path, subject, *([] if trial.forces is None else [trial.forces])]
    told = recorded(settings)
    del told["kernel"]  # both find the same
    made_from = fingerprint(files, told)
    if is_made_from(target / RECORD, made_from):
        return False
    capture = read_capture(trial.path, forces=trial.forces)
    result = reconstruct(capture, read_subject(subject), settings=settings)
    partial = target.with_name(f"{PARTIAL}{target.name}-{uuid.uuid4().hex}")
    try:
        write_reconstruction(result, summarise(result), partial)
        write_curves(result, partial / CURVES_FILE)
        write_record(partial / RECORD, made_from)
        _replace(target, partial)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return True


def remove_partial(out: Path) -> None:
    """Removes what workers left unfinished that were killed."""
    for place in [*out.glob(f"*/{PARTIAL}*"), *out.glob(f"*/*/{PARTIAL}*")]:
        shutil.rmtree(place, ignore_errors=True)


def _replace(target: Path, partial: Path) -> None:
    """Puts a finished folder in the place of an earlier one."""
    earlier = partial.with_name(partial.name + "-earlier")
    with suppress(FileNotFoundError):
        target.rename(earlier)
    try:
        partial.rename(target)
    except OSError:
        with suppress(OSError):
            earlier.rename(target)
        raise
    shutil.rmtree(earlier, ignore_errors=True)
