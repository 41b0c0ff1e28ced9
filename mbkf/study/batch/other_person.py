"""A trial against the capture that its person was scaled from: no body is used for another person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.study.batch.outcome import AnotherPerson
from mbkf.study.batch.plan import Files, Person, Plan, Trial, planned, scaling_candidates, trial_names
from mbkf.study.scaling.owner import Reference, few_frames, owner_of
from mbkf.study.scaling.report import used_trials

ANEW = "markers were put on anew since the body was scaled"
"""Doubt about a trial whose markers are elsewhere, on bones of the person's lengths."""

REMEDY = (
    "put it into a folder with a standing trial of its person and session, or name person and trial in a list if they "
    "belong together"
)
"""Mend for a trial that belongs to no standing trial."""

OTHERS = "-other"
"""Ends the name of the person whose trials do not show the person of the standing trial beside them."""


def checked_owner(trial: Trial, capture: Capture, subject: Subject) -> str:
    """Doubts about the person of a trial; empty where its markers are where they were when the body was scaled.

    Args:
        trial: The trial.
        capture: Its capture, under the subject's names.
        subject: The person's body.

    Raises:
        AnotherPerson: It is another person's, and no list states the person.
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
        raise AnotherPerson(f"{trial.path.name}: {owner.found}; {REMEDY}")
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


def plan_of_others(trials: Sequence[Trial]) -> Plan:
    """The plan of trials that do not show their person: each session's are another's, to be sorted and scaled alone.

    Args:
        trials: The trials.
    """
    found = []
    for person in dict.fromkeys(trial.person for trial in trials):
        own = [trial for trial in trials if trial.person == person]
        files = tuple(Files(trial.path, trial.forces) for trial in own)
        other = Person(
            f"{person.name}{OTHERS}",
            person.session,
            moving=scaling_candidates(files),
            protocol=person.protocol,
            remarks=(
                f"its markers do not fit the capture that {person.name} was scaled from: another person, or markers "
                f"put on anew; scaled from its own trials without the mass in session.toml; {REMEDY}",
            ),
            unsorted=files,
        )
        found += [replace(trial, person=other) for trial in own]
    return planned(found, "the captures")
