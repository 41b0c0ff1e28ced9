"""One person of a batch scaled: from a standing trial, or from the moving ones, and weighed where no mass is stated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.errors import FileFormatError, InvalidInput, MbkfError
from mbkf.io.atomic import check_file, remove_file
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject, write_subject
from mbkf.io.written import SETTINGS
from mbkf.study.batch.inputs import fingerprint, is_made_from, write_record
from mbkf.study.batch.naming import body_of_points, is_nameless, named
from mbkf.study.batch.plan import MOST_MOVING, Files, Person
from mbkf.study.batch.progress import ignored
from mbkf.trial.protocol.standing import stands_still
from mbkf.trial.scale import scale
from mbkf.trial.weighing import PROVISIONAL_KG, weighed

SUBJECT_FILE, RECORD = "subject.toml", "subject.json"
"""Files of a scaled person in the person's folder: the body, and its inputs."""


def subject_of(person: Person, out: Path, progress: StageCallback = ignored) -> Path:
    """The person's subject file: the one given, the one made before from the same, or a new one.

    Args:
        person: The person.
        out: The batch's folder.
        progress: Called with the stage, items done and items in all.

    Raises:
        MbkfError: The person cannot be scaled.
        OSError: A file cannot be read or written.
    """
    if person.subject is not None:
        return person.subject
    place = out / person.place
    used = [Files(path) for path in person.statics[:1]]
    used += person.moving if not used or person.mass_kg is None else ()
    if not used:
        raise FileFormatError(place, "the person has no trial to scale from")
    made_from = fingerprint([file for pair in used for file in pair if file is not None], _stated(person))
    if is_made_from(place / RECORD, made_from) and (place / SUBJECT_FILE).is_file():
        return place / SUBJECT_FILE
    check_file(place / SUBJECT_FILE, form=SETTINGS)  # before the work
    remove_file(place / RECORD)
    subject = scaled(person, progress)
    place.mkdir(parents=True, exist_ok=True)
    write_subject(subject, place / SUBJECT_FILE)
    write_record(place / RECORD, made_from)
    return place / SUBJECT_FILE


def scaled(person: Person, progress: StageCallback = ignored) -> Subject:
    """The person's body: by the first standing trial, by its name or else by standing still, else by the moving ones.

    Captures whose points have no names are left out beside one that has names; without such a one, the body is found
    with the names of the first moving one.

    Raises:
        MbkfError: No trial can be read, or body or mass cannot be determined from them.
        OSError: A file cannot be read.
    """
    static = read_capture(person.statics[0]) if person.statics else None
    if static is not None and is_nameless(static):
        static = None
    found = [] if static is not None else _readable(person.moving)
    trials = [one for one in found if not is_nameless(one)]
    nameless = static is None and not trials
    if static is None and (still := next((one for one in trials if stands_still(one.markers)), None)):
        static, trials = still, []
    trials = (found if nameless else trials)[:MOST_MOVING]
    captures = [*([] if static is None else [static]), *trials]
    file_masses = (one.subject_mass_kg for one in captures if one.subject_mass_kg is not None)
    stated_kg = next(file_masses, None) if person.mass_kg is None else person.mass_kg
    mass_kg = PROVISIONAL_KG if stated_kg is None else stated_kg
    if nameless and trials:
        subject = body_of_points(trials[0], mass_kg, person.height_m, person.protocol)
    else:
        subject = scale(
            static,
            trials,
            mass_kg=mass_kg,
            height_m=person.height_m,
            protocol=person.protocol,
            progress=progress,
        )
    if stated_kg is not None:
        return subject
    if not any(capture.plates for capture in captures):
        captures = _readable(person.moving[:MOST_MOVING])
    try:
        return weighed(subject, [named(one, subject).capture for one in captures])
    except InvalidInput as error:
        raise InvalidInput(
            f"the body mass follows from no capture; state mass_kg in session.toml or in the list ({error})"
        ) from error


def _readable(trials: Sequence[Files]) -> list[Capture]:
    """Those captures that can be read and hold markers.

    Raises:
        MbkfError: Not one can be; the first one's reason.
    """
    found, why = [], None
    for path, forces in trials:
        try:
            capture = read_capture(path, forces=forces)
        except MbkfError as error:
            why = why or error
            continue
        if np.isfinite(capture.markers.positions_m).any():
            found.append(capture)
    if not found and why is not None:
        raise why
    return found


def _stated(person: Person) -> Mapping[str, object]:
    return {"mass_kg": person.mass_kg, "height_m": person.height_m, "protocol": person.protocol}
