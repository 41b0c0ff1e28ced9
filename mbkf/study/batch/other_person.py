"""A trial against the capture that its person was scaled from: no body is used for another person."""

from __future__ import annotations

from pathlib import Path

from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.study.batch.plan import Person, Trial, trial_names
from mbkf.study.scaling.owner import Reference, few_frames, owner_of
from mbkf.study.scaling.report import used_trials

ANEW = "markers were put on anew since the body was scaled"
"""Doubt about a trial whose markers are elsewhere, on bones of the person's lengths."""

REMEDY = (
    "put it into a folder with a standing trial of its person and session, or name person and trial in a list if they "
    "belong together"
)
"""Mend for a trial that belongs to no standing trial."""


def checked_owner(trial: Trial, capture: Capture, subject: Subject) -> str:
    """Doubts about the person of a trial; empty where its markers are where they were when the body was scaled.

    Args:
        trial: The trial.
        capture: Its capture, under the subject's names.
        subject: The person's body.

    Raises:
        InvalidInput: It is another person's, and no list states the person.
    """
    file = reference_of(trial.person, subject)
    if file is None or file == trial.path:
        return ""
    try:
        reference = Reference(file.name, subject, few_frames(read_capture(file)))
    except (MbkfError, OSError):
        return ""  # the body is a file given, and the capture beside it cannot show its markers
    owner = owner_of(few_frames(capture), [reference])
    if owner is None or not owner.found:
        return ""
    if owner.number is None and not trial.person.listed:
        raise InvalidInput(f"{trial.path.name}: {owner.found}; {REMEDY}")
    return f"{trial.path.name}: {owner.found if owner.number is None else f'{ANEW}: {owner.found}'}"


def reference_of(person: Person, subject: Subject) -> Path | None:
    """The capture that shows where a person's markers were when the body was scaled; None without one.

    Args:
        person: The person.
        subject: The person's body.
    """
    if person.statics:
        return person.statics[0]
    files = trial_names(person.moving)
    return next((files[name].path for name in used_trials(subject.report) if name in files), None)
