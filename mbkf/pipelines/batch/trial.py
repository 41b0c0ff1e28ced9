"""One trial of a batch reconstructed into a folder of its own, which appears whole or not at all."""

from __future__ import annotations

from pathlib import Path

from mbkf.io.atomic_folder import replacing_folder
from mbkf.io.capture import read_capture
from mbkf.io.results_folder import write_result_files
from mbkf.io.subject import read_subject
from mbkf.pipelines.batch.curves import write_curves
from mbkf.pipelines.batch.inputs import RECORD, fingerprint, is_made_from, write_record
from mbkf.pipelines.batch.plan import Trial
from mbkf.pipelines.reconstruct import reconstruct
from mbkf.pipelines.reconstruct_settings import ReconstructSettings, recorded
from mbkf.pipelines.results.summary import summarise

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
    with replacing_folder(target, last=RECORD) as partial:
        write_result_files(result, summarise(result), partial)
        write_curves(result, partial / CURVES_FILE)
        write_record(partial / RECORD, made_from)
    return True
