"""A folder of captures understood: a folder with captures is a session, the first folder on the way to it a person.

    study/P01/static.c3d, study/P01/walk1.c3d                      person P01
    study/P01/monday/static.c3d, study/P01/monday/walk1.trc        person P01, session monday
    mixed/S01_static.c3d, mixed/S01_walk.c3d, mixed/S02_walk.c3d  persons S01 and S02 (:mod:`mbkf.study.batch.persons`)
    mixed/static1.c3d, mixed/static2.c3d, mixed/trial1.c3d        known by movements (:mod:`mbkf.study.batch.sorting`)

Standing trials are recognised by their names, else by standing still. Ground reactions lie beside their trial,
under its name with ``grf`` or ``forces``. ``session.toml`` in a session's folder, or above it, states mass, height and
protocol; in the session's own folder also which trials stand still, which are left out, and strikes and toe-offs that a
person set (:mod:`mbkf.io.session`).
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from mbkf.errors import FileFormatError, InvalidInput, suggestion
from mbkf.io.c3d_person import person_of_c3d
from mbkf.io.capture import CAPTURES, FORCES, folder_suffixes
from mbkf.io.plain_data import plain_text
from mbkf.io.results_folder import MOTION_FILE
from mbkf.io.session import FROM_STATIC, SESSION_FILE, SessionNotes, TrialKind, read_session
from mbkf.io.stated_markers import stated_markers
from mbkf.io.toml_lines import line_of
from mbkf.study.batch.persons import FolderPersons, PersonFiles, persons_of_files
from mbkf.study.batch.plan import (
    Files,
    Person,
    Plan,
    Trial,
    folder_name,
    planned,
    scaling_candidates,
)

STATED_SHARE = 0.1
"""Share by which a mass or height in a session file and in captures may differ."""

APART = "put the captures of each person into a folder of their own, or name them in a list"
"""Mend for a folder of several persons."""

SHARED_NAMES = 0.5
"""Share of a trial's names of markers that its standing trial has as well, at least."""

SUBJECT_FILE = "subject.toml"
"""A person scaled before, in the session's folder."""

STATIC = re.compile(
    r"(^|[^a-z])(static|statique|statisch|estatica|estatico|standing|stand|calib(ration)?|cal|[tna]-?_?pose|neutral)"
    r"([^a-z]|$)"
)
"""Names of standing trials, in lower case."""


def plan_of_folder(folder: Path) -> Plan:
    """The persons and trials of a folder; those under a damaged session file have that as their fault.

    Raises:
        InvalidInput: It holds no trial.
    """
    root = folder.absolute()
    trials: list[Trial] = []
    notes: list[str] = []
    for place, captures in _sessions(root):
        try:
            stated = stated_of(root, place)
            notes += strange_trials(stated, captures, place / SESSION_FILE)
            trials += _trials(root, place, captures, stated, notes)
        except FileFormatError as error:
            person = Person(*person_and_session(root, place))
            trials += [
                Trial(person, path, None, folder_name(path.stem), fault=str(error))
                for path in [path for path in captures if not is_static(path)] or captures
            ]
    return planned(trials, str(folder), notes)


def strange_trials(
    notes: SessionNotes, captures: Sequence[Path], file: Path, known: Collection[str] = ()
) -> list[str]:
    """Remarks on statements about trials of which no capture lies in the folder: live runs, or files that are gone.

    Args:
        notes: Statements of the session file.
        captures: The captures of its folder.
        file: The session file.
        known: Names of live runs.

    Raises:
        FileFormatError: The name is that of a capture, but for its suffix, capitals or marks.
    """
    stems = [path.stem for path in captures]
    plain = {_letters(stem): stem for stem in stems}
    found = []
    for name in notes.trials:
        if name in stems or name in known:
            continue
        if (meant := plain.get(_letters(name)) or plain.get(_letters(Path(name).stem))) is not None:
            line = line_of(plain_text(file), ("trial", name)) if file.is_file() else None
            raise FileFormatError(file, f"unknown trial '{name}'; did you mean {meant}", line)
        found.append(f"{file}: this folder has no capture of its trial '{name}'; {suggestion(name, stems)}")
    return found


def _letters(name: str) -> str:
    """A name without capitals, spaces and marks."""
    return "".join(re.findall(r"[^\W_]+", name.casefold()))


def is_static(path: Path, notes: SessionNotes | None = None) -> bool:
    """True for a standing trial: as stated in the session file, else by its name.

    Args:
        path: The capture.
        notes: Statements of the session file.
    """
    stated = None if notes is None else notes.trial(path.stem).kind
    if stated is not None:
        return stated == TrialKind.STATIC
    return STATIC.search(path.stem.lower()) is not None


def forces_beside(path: Path, files: Sequence[Path]) -> Path | None:
    """The file of ground reactions that belongs to a capture: its own name with ``grf`` or ``forces``, or its suffix.

    Args:
        path: The capture.
        files: The files of its folder.
    """
    own = _essence(path.stem)
    for file in files:
        name = file.stem.lower()
        if file == path or file.suffix.lower() not in FORCES.suffixes:
            continue
        named = file.suffix.lower() not in CAPTURES.suffixes or "grf" in name or "force" in name
        if named and (name == path.stem.lower() or _essence(name) == own) and not _is_other(file):
            return file
    return None


def _essence(stem: str) -> str:
    """A name without the suffix that distinguishes markers from ground reactions."""
    words = re.split(r"[_\-. ]+", stem.lower())
    return "_".join(
        w
        for w in words
        if w not in {"grf", "grfs", "force", "forces", "markers", "marker", "motion", "capture"}
    )


def _is_other(file: Path) -> bool:
    """True for a motion file of coordinates or moments, as OpenSim's tools write them, without forces."""
    return file.suffix.lower() in {".mot", ".sto"} and not re.search(r"grf|force", file.stem.lower())


def captures_in(folder: Path) -> list[Path]:
    """The captures that lie in a folder itself, one for each name, the more telling format first."""
    by_stem: dict[str, Path] = {}
    for suffix in reversed(folder_suffixes()):
        for path in sorted(folder.iterdir()):
            if path.suffix.lower() == suffix and path.is_file() and not path.name.startswith("."):
                by_stem[path.stem.lower()] = path
    return [by_stem[stem] for stem in sorted(by_stem)]


def session_folders(root: Path) -> list[Path]:
    """The folders with captures in a folder, itself included; hidden ones and folders of results are left out.

    Folders that vanish meanwhile, as unfinished results do, count as empty.
    """
    found = []
    for place, folders, files in os.walk(root):
        folders[:] = [name for name in folders if not name.startswith(".")]
        seen = [
            name for name in files if not name.startswith(".") and name.lower().endswith(folder_suffixes())
        ]
        if seen and MOTION_FILE not in files and any((Path(place) / name).is_file() for name in seen):
            found.append(Path(place))
    return sorted(found)


def _sessions(root: Path) -> Iterator[tuple[Path, list[Path]]]:
    """Folders with captures, and these."""
    for place in session_folders(root):
        yield place, captures_in(place)


def _trials(
    root: Path, place: Path, captures: Sequence[Path], stated: SessionNotes, notes: list[str]
) -> list[Trial]:
    """The trials of one session's folder, of each person in it; remarks on several persons are added to the notes."""
    found = _persons_in(captures, stated)
    if len(found.persons) > 1:
        notes.append(
            f"{_several(place, found)}. Each is scaled from their own captures; if these are one person's, name them "
            "in a list"
        )
    trials = []
    for one in found.persons:
        person, moving = _person(root, place, one, stated, found)
        trials += [_trial(person, one, stated) for one in moving]
    if found.unknown:
        files, persons = PersonFiles("", found.unknown), dict.fromkeys(trial.person for trial in trials)
        lost, moving = _person(root, place, files, stated, FolderPersons((files,)))
        hosts = tuple(replace(one, unsorted=()) for one in persons)
        trials = [replace(one, person=replace(one.person, unsorted=())) for one in trials]
        lost = replace(lost, mass_kg=None, height_m=None, subject=None, unsorted=tuple(moving), hosts=hosts)
        trials += [_trial(lost, one, stated) for one in moving]
    return trials


def _trial(person: Person, files: Files, stated: SessionNotes) -> Trial:
    """A trial with what the session file states about it."""
    own, name = stated.trial(files.path.stem), folder_name(files.path.stem)
    condition = own.condition or stated.visit.condition
    return Trial(person, files.path, files.forces, name, own.events, condition=condition)


def _persons_in(captures: Sequence[Path], stated: SessionNotes) -> FolderPersons:
    """The persons of a folder by its captures that are not left out."""
    kept = [path for path in captures if not stated.trial(path.stem).excluded]
    return persons_of_files(kept, {path for path in kept if is_static(path, stated)}, person_of_c3d)


def _several(place: Path, found: FolderPersons) -> str:
    """The statement that a folder holds several persons."""
    persons = [
        f"{one.label} ({'' if one.mass_kg is None else f'{one.mass_kg:.1f} kg, '}{_counted(one.captures)})"
        for one in found.persons
    ]
    return f"{place} holds captures of {len(persons)} persons: {', '.join(persons)}"


def _counted(captures: Sequence[Path]) -> str:
    return "1 capture" if len(captures) == 1 else f"{len(captures)} captures"


def person_of_folder(folder: Path) -> Person:
    """The person of one session, to be scaled from its captures; an earlier ``subject.toml`` does not count.

    Args:
        folder: The session's folder.

    Raises:
        InvalidInput: No captures lie in the folder itself.
        FileFormatError: Its session file is damaged.
    """
    place = folder.absolute()
    captures = captures_in(place)
    if not captures:
        below = [path.relative_to(place).as_posix() for path in session_folders(place)]
        hint = (
            f"its sessions are {', '.join(below)}; name one of them" if below else "name a session's folder"
        )
        raise InvalidInput(f"{folder}: no captures lie in this folder; {hint}")
    notes = stated_of(place, place)
    strange_trials(notes, captures, place / SESSION_FILE)
    found = _persons_in(captures, notes)
    if len(found.persons) > 1:
        raise InvalidInput(f"{_several(place, found)}; {APART}")
    return replace(_person(place, place, found.persons[0], notes, found)[0], subject=None)


def _person(
    root: Path, place: Path, files: PersonFiles, notes: SessionNotes, found: FolderPersons
) -> tuple[Person, list[Files]]:
    """A person of one session, and the moving trials that are not left out.

    In a folder of several persons its ``subject.toml`` is nobody's, and mass and height in its session file are those
    of the persons whose captures state nearly the same.
    """
    beside = sorted(place.iterdir())
    statics = tuple(path for path in files.captures if is_static(path, notes))
    moving = [Files(path, forces_beside(path, beside)) for path in files.captures if path not in statics]
    subject = place / SUBJECT_FILE
    several = len(found.persons) > 1
    name, session = person_and_session(root, place)
    label = folder_name(files.label)
    same_mass = not several or _near(notes.mass_kg, files.mass_kg)
    same_height = not several or _near(notes.height_m, files.height_m)
    person = Person(
        name if not several else label if place == root else f"{name}-{label}",
        session,
        statics,
        scaling_candidates(moving),
        notes.mass_kg if same_mass else None,
        notes.height_m if same_height else None,
        notes.protocol,
        subject if subject.is_file() and not several else None,
        notes.scaling == FROM_STATIC,
        _remarks(files, statics, notes, found),
    )
    if person.subject is None and moving and _open(statics, moving):
        person = replace(person, unsorted=tuple(moving))
    return person, moving


def _open(statics: Sequence[Path], moving: Sequence[Files]) -> bool:
    """True where captures may be of several persons: not one standing trial, or other markers than it has."""
    if len(statics) != 1:
        return len(statics) + len(moving) > 1
    known = stated_markers(statics[0])
    return any(
        names and len(names & known) < SHARED_NAMES * min(len(names), len(known))
        for names in (stated_markers(one.path) for one in moving)
    )


def _near(stated: float | None, in_files: float | None) -> bool:
    """True for a stated mass or height that the captures state, too."""
    return stated is not None and in_files is not None and abs(stated / in_files - 1.0) <= STATED_SHARE


def _remarks(
    files: PersonFiles, statics: Sequence[Path], notes: SessionNotes, found: FolderPersons
) -> tuple[str, ...]:
    """Doubts about a person that follow from the statements of the captures."""
    remarks = []
    if len(found.persons) > 1 and not statics:
        remarks.append("has no standing trial in a folder of several persons; scaled from moving trials")
    if found.subjects:
        names = ", ".join(found.subjects)
        remarks.append(
            f"the captures name different subjects ({names}) and are taken for one person's; {APART}"
        )
    stated, in_files = notes.mass_kg, files.mass_kg
    if stated is not None and in_files is not None and not _near(stated, in_files):
        used = "stated" if len(found.persons) == 1 else "captures'"
        remarks.append(
            f"{SESSION_FILE} states {stated:.1f} kg, the captures {in_files:.1f} kg; "
            f"the {used} mass is used: correct the other"
        )
    return tuple(remarks)


def person_and_session(root: Path, place: Path) -> tuple[str, str]:
    """The names of the person and of the session that a folder with captures is.

    Args:
        root: The study's folder.
        place: The session's folder, in it.
    """
    parts = place.relative_to(root).parts
    session = folder_name("-".join(parts[1:])) if parts[1:] else ""
    return folder_name(parts[0] if parts else root.name), session


def stated_of(root: Path, place: Path) -> SessionNotes:
    """Statements of session files, the nearest first; of trials only the session's own.

    Args:
        root: The study's folder.
        place: The session's folder, in it.

    Raises:
        FileFormatError: One is damaged, or says something impossible.
    """
    found = SessionNotes()
    for folder in reversed([place, *(p for p in place.parents if p == root or root in p.parents)]):
        file = folder / SESSION_FILE
        if file.is_file():
            nearer = _found_set(read_session(file), folder)
            found = replace(
                nearer,
                mass_kg=found.mass_kg if nearer.mass_kg is None else nearer.mass_kg,
                height_m=found.height_m if nearer.height_m is None else nearer.height_m,
                protocol=nearer.protocol or found.protocol,
                scaling=nearer.scaling or found.scaling,
                visit=nearer.visit.within(found.visit),
                trials=nearer.trials if folder == place else {},
            )
        elif folder == place:
            found = replace(found, trials={})
        if found.visit.fault:
            raise FileFormatError(file, found.visit.fault)
    return found


def _found_set(notes: SessionNotes, folder: Path) -> SessionNotes:
    """The notes with a marker set's file where it lies: beside the session file."""
    if notes.protocol and notes.protocol.lower().endswith(".toml"):
        return replace(notes, protocol=str(folder / notes.protocol))
    return notes
