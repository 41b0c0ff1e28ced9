"""A list of persons and trials, as TOML or as CSV; paths are relative to the list.

TOML, a table per person and session::

    [[subject]]
    name = "P01"
    session = "monday"             # optional, as all that follows but trials
    mass_kg = 71.2
    height_m = 1.78
    protocol = "plug_in_gait"
    static = "P01/static.c3d"
    trials = ["P01/walk1.c3d", { path = "P01/walk2.trc", forces = "P01/walk2_grf.mot", name = "second" }]
    subject = "P01/subject.toml"   # scaled before, instead of static and mass

CSV, a row per trial: columns ``subject`` and ``trial``, and ``session``, ``static``, ``forces``, ``name``, ``mass_kg``,
``height_m``, ``protocol``, ``subject_file`` where they are known; a statement about a person holds for all of the
person's rows.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from mbkf.errors import FileFormatError
from mbkf.io.files_read import SETTINGS_BYTES, read_text
from mbkf.io.plain_data import read_toml
from mbkf.study.batch.folder import STATED, checked_entry
from mbkf.study.batch.plan import MOST_MOVING, Files, Person, Plan, Trial, planned

Entry: TypeAlias = Mapping[str, object]

COLUMNS = ("subject", "trial", "session", "static", "forces", "name", *STATED, "subject_file")


def plan_of_toml(file: Path) -> Plan:
    """The persons and trials of a TOML list.

    Raises:
        FileFormatError: It is damaged, or an entry is missing or not possible.
        InvalidInput: It names no trial, or one place twice.
    """
    try:
        listed = read_toml(file)
    except (OSError, ValueError) as error:
        raise FileFormatError(file, f"cannot be read as a list in TOML ({error})") from error
    entries = listed.get("subject")
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise FileFormatError(file, "has no [[subject]]")
    return planned([trial for entry in entries for trial in _trials(file, entry)], str(file))


def plan_of_csv(file: Path) -> Plan:
    """The persons and trials of a CSV list.

    Raises:
        FileFormatError: It is damaged, or a column is missing, unknown or holds something impossible.
        InvalidInput: It names no trial, or one place twice.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(read_text(file, SETTINGS_BYTES))))
    except (OSError, ValueError, csv.Error) as error:
        raise FileFormatError(file, f"cannot be read as a list in CSV ({error})") from error
    known = set(rows[0]) if rows else set()
    for name in ("subject", "trial"):
        if rows and name not in known:
            raise FileFormatError(file, f"has no column '{name}'", 1)
    if strange := sorted(str(name) for name in known - set(COLUMNS)):
        raise FileFormatError(file, f"has columns that are not known: {', '.join(strange)}", 1)
    persons: dict[tuple[str, str], Person] = {}
    trials: list[tuple[tuple[str, str], Trial]] = []
    for line, row in enumerate(rows, start=2):
        filled = {key: value.strip() for key, value in row.items() if key and value and value.strip()}
        key = filled.get("subject", ""), filled.get("session", "")
        person = _with(persons.get(key, Person(*key)), filled, file, line)
        if "trial" in filled:
            path = _file(file, filled["trial"], line)
            forces = _file(file, filled["forces"], line) if "forces" in filled else None
            trials.append((key, Trial(person, path, forces, filled.get("name", path.stem))))
            person = replace(person, moving=(*person.moving, Files(path, forces))[:MOST_MOVING])
        persons[key] = person
    return planned([replace(trial, person=persons[key]) for key, trial in trials], str(file))


def _with(person: Person, row: Mapping[str, str], file: Path, line: int) -> Person:
    """A person completed by the statements of a row."""
    if not person.name:
        raise FileFormatError(file, "names no subject", line)
    found: dict[str, object] = {}
    for key in STATED:
        if key in row:
            found[key] = checked_entry(
                key, row[key] if key == "protocol" else _number(row[key], file, line), file, line
            )
    if "static" in row:
        static = _file(file, row["static"], line)
        found["statics"] = (*person.statics, *(() if static in person.statics else (static,)))
    if "subject_file" in row:
        found["subject"] = _file(file, row["subject_file"], line)
    return replace(person, **found)  # type: ignore[arg-type]


def _number(text: str, file: Path, line: int) -> float:
    try:
        return float(text)
    except ValueError:
        raise FileFormatError(file, f"'{text}' should be a number", line) from None


def _file(file: Path, name: str, line: int | None = None) -> Path:
    """A file that a list names.

    Raises:
        FileFormatError: Its name could not be one.
    """
    if "\0" in name:
        raise FileFormatError(file, "a file's name cannot hold a zero byte", line)
    return (file.absolute().parent / name).absolute()


def _trials(file: Path, entry: Entry) -> list[Trial]:
    """The trials of a table."""
    name, session = entry.get("name"), entry.get("session", "")
    if not isinstance(name, str) or not name or not isinstance(session, str):
        raise FileFormatError(file, "a [[subject]] needs a name")
    statics, subject = entry.get("static", ()), entry.get("subject")
    listed, trials = [statics] if isinstance(statics, str) else statics, entry.get("trials")
    if (
        not isinstance(listed, list | tuple)
        or not isinstance(trials, list)
        or not isinstance(subject, str | None)
    ):
        raise FileFormatError(file, f"{name}: trials must be a list of files, static one or a list of them")
    found = [_trial(file, name, one) for one in trials]
    stated = {key: checked_entry(key, entry[key], file) for key in STATED if key in entry}
    person = Person(
        name,
        session,
        tuple(_file(file, str(one)) for one in listed),
        tuple(Files(path, forces) for path, forces, _ in found)[:MOST_MOVING],
        subject=None if subject is None else _file(file, subject),
    )
    person = replace(person, **stated)  # type: ignore[arg-type]
    return [Trial(person, path, forces, trial_name) for path, forces, trial_name in found]


def _trial(file: Path, person: str, one: object) -> tuple[Path, Path | None, str]:
    """Capture, ground reactions and name of an entry of ``trials``."""
    own = {"path": one} if isinstance(one, str) else one
    if (
        not isinstance(own, dict)
        or not all(isinstance(value, str) for value in own.values())
        or "path" not in own
    ):
        raise FileFormatError(file, f"{person}: a trial is a file, or a table with path, forces and name")
    path = _file(file, own["path"])
    forces = _file(file, own["forces"]) if "forces" in own else None
    return path, forces, own.get("name", path.stem)
