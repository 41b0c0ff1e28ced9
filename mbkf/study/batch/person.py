"""One person of a batch scaled: by standing and the trials that help, else by the moving ones; weighed if need be."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from mbkf.conventions import JsonTable, StageCallback
from mbkf.errors import FileFormatError, InvalidInput, MbkfError
from mbkf.io.atomic import check_file, remove_file
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.subject import Subject, read_subject, write_subject
from mbkf.io.written import SETTINGS
from mbkf.scaling.records import ScalingSettings
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.study.batch.inputs import fingerprint, is_made_from, read_record, write_record
from mbkf.study.batch.naming import body_of_points, is_nameless, named
from mbkf.study.batch.plan import Files, Person, trial_names
from mbkf.study.batch.progress import ignored
from mbkf.study.scaling.report import LEFT_OUT_KEY, SCALED_FROM_KEY, used_trials
from mbkf.study.scaling.session import MOST_MOVING, SessionTrial, scale_from_moving, scale_from_session
from mbkf.trial.protocol.standing import stands_still
from mbkf.trial.scale import scale
from mbkf.trial.weighing import GIVE_MASS, PROVISIONAL_KG, weighed

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
    used += () if used and person.static_only and person.mass_kg is not None else person.moving
    if not used:
        raise FileFormatError(place, "the person has no trial to scale from")
    made_from = fingerprint([file for pair in used for file in pair if file is not None], _stated(person))
    if is_made_from(place / RECORD, made_from) and (place / SUBJECT_FILE).is_file():
        return place / SUBJECT_FILE
    check_file(place / SUBJECT_FILE, form=SETTINGS)  # before the work
    remove_file(place / RECORD)
    subject = scaled(person, progress)
    place.mkdir(parents=True, exist_ok=True)
    # reasons of other trials stay out of the file, which is an input of all results: one more trial changes them
    trials = {key: subject.report[key] for key in (SCALED_FROM_KEY, LEFT_OUT_KEY) if key in subject.report}
    report = {key: value for key, value in subject.report.items() if key != LEFT_OUT_KEY}
    write_subject(replace(subject, report=report), place / SUBJECT_FILE)
    write_record(place / RECORD, {**made_from, **trials})
    return place / SUBJECT_FILE


def doubts_of(person: Person, subject: Path) -> tuple[str, ...]:
    """Doubts about a scaled person: those of the plan and of the scaling; a file that cannot be read raises none.

    Args:
        person: The person.
        subject: The person's file.
    """
    try:
        found = read_subject(subject).report.get(DOUBTS_KEY)
    except MbkfError:
        found = None  # each trial fails by it, with the reason
    return (*person.remarks, *(map(str, found) if isinstance(found, list) else ()))


def record_of(place: Path) -> JsonTable:
    """The record of a scaled person's inputs and trials; empty without one that can be read.

    Args:
        place: The person's folder.
    """
    try:
        found: JsonTable = read_record(place / RECORD)
    except FileFormatError:
        return {}
    return found


def scaled(
    person: Person,
    progress: StageCallback = ignored,
    *,
    body: str | None = None,
    settings: ScalingSettings | None = None,
    read: Callable[..., Capture] = read_capture,
) -> Subject:
    """The person's body: by standing and the trials of the session that help.

    The standing trial is the first one by its name, or else one that stands still; without one, or where that one is a
    pause bent forward, moving trials are taken that help. Captures whose points have no names
    are left out beside one that has names; without such a one, the body is found with the names of the first moving
    one.

    Args:
        person: The person.
        progress: Called with the stage, items done and items in all.
        body: The reference body, its name or its file; by default that of the marker protocol.
        settings: Weights of the priors.
        read: Reads a capture, as :func:`mbkf.read_capture` does.

    Raises:
        MbkfError: No trial can be read, or body or mass cannot be determined from them.
        OSError: A file cannot be read.
    """
    mass_kg = PROVISIONAL_KG if person.mass_kg is None else person.mass_kg
    scaling = partial(scale, mass_kg=mass_kg, height_m=person.height_m, protocol=person.protocol, body=body)
    static, others, moving = _standing(person, read)
    if static is not None:
        try:
            found = scale_from_session(
                static, () if person.static_only else others, scaling, settings, progress
            )
        except MbkfError:
            if person.statics:
                raise
            found = scale_from_moving((static, *others), scaling, settings, progress)  # still, but bent
        subject, captures = found.subject, found.captures
    elif moving and all(is_nameless(one) for one in moving):
        captures = moving[:1]
        subject = body_of_points(captures[0], mass_kg, person.height_m, person.protocol)
    else:
        found = scale_from_moving(others, scaling, settings, progress)
        subject, captures = found.subject, found.captures
    if person.mass_kg is not None:
        return subject
    stated_kg = next((one.subject_mass_kg for one in captures if one.subject_mass_kg is not None), None)
    if stated_kg is not None:
        return replace(subject, mass_kg=stated_kg)
    if not any(capture.plates for capture in captures):
        captures = _readable(person.moving[:MOST_MOVING], read)
    try:
        return weighed(subject, [named(one, subject).capture for one in captures])
    except InvalidInput as error:
        raise InvalidInput(
            "the body mass follows from no capture; state mass_kg in session.toml or in the list "
            f"({str(error).removesuffix(GIVE_MASS)})"
        ) from error


def captures_used(
    person: Person, subject: Subject, read: Callable[..., Capture] = read_capture
) -> tuple[Capture, ...]:
    """The captures that a person was scaled from, with their ground reactions; all where these have none.

    Args:
        person: The person.
        subject: The scaled person.
        read: Reads a capture, as :func:`mbkf.read_capture` does.

    Raises:
        MbkfError: None can be read.
        OSError: A file cannot be read.
    """
    used = used_trials(subject.report)
    files = {path.stem: Files(path) for path in person.statics[:1]} | trial_names(person.moving)
    captures = _readable([files[name] for name in used if name in files], read)
    return captures if any(one.plates for one in captures) else _readable(tuple(files.values()), read)


def _standing(
    person: Person, read: Callable[..., Capture]
) -> tuple[SessionTrial | None, tuple[SessionTrial, ...], tuple[Capture, ...]]:
    """The standing trial, the session's others, and without a standing one the captures of the moving ones."""
    names = {files.path.as_posix(): name for name, files in trial_names(person.moving).items()}
    if person.statics:
        path = person.statics[0]
        static = read(path)
        if not is_nameless(static):
            others = [SessionTrial(name, partial(read, one)) for one, name in names.items()]
            return SessionTrial(path.stem, lambda: static), tuple(others), ()
    found = _readable(person.moving, read)
    trials = [
        SessionTrial(names.get(Path(one.path).as_posix(), one.path), partial(_given, one))
        for one in found
        if not is_nameless(one)
    ]
    still = next((n for n, one in enumerate(trials) if stands_still(one.read().markers)), None)
    if still is None:
        return None, tuple(trials), found
    return trials[still], (*trials[:still], *trials[still + 1 :]), ()


def _given(capture: Capture) -> Capture:
    return capture


def _readable(trials: Sequence[Files], read: Callable[..., Capture]) -> tuple[Capture, ...]:
    """Those captures that can be read and hold markers.

    Raises:
        MbkfError: Not one can be; the first one's reason.
    """
    found, why = [], None
    for path, forces in trials:
        try:
            capture = read(path, forces=forces)
        except MbkfError as error:
            why = why or error
            continue
        if np.isfinite(capture.markers.positions_m).any():
            found.append(capture)
    if not found and why is not None:
        raise why
    return tuple(found)


def _stated(person: Person) -> Mapping[str, object]:
    return {
        "mass_kg": person.mass_kg,
        "height_m": person.height_m,
        "protocol": person.protocol,
        "static_only": person.static_only,
    }
