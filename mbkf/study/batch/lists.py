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

from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io import fields
from mbkf.io.edited_csv import read_edited_csv
from mbkf.io.session import HEIGHT, MASS, PROTOCOL
from mbkf.io.toml import Entries
from mbkf.study.batch.listing import Key, Listing
from mbkf.study.batch.plan import Files, Plan

_SUBJECT = fields.text("subject", "the person's name or code", required=True)
_TRIAL = fields.text("trial", "capture of a moving trial", required=True)
_SESSION = fields.text("session", "name of the session, for a person with several", empty=True)
_STATIC = fields.text("static", "capture of a standing trial")
_FORCES = fields.text("forces", "ground reactions of the trial, where its capture has none")
_NAME = fields.text("name", "name of the trial's folder; by default that of its file")
_SUBJECT_FILE = fields.text("subject_file", "a person scaled before, instead of static and mass")
CSV_LIST = fields.record(
    "list", _SUBJECT, _TRIAL, _SESSION, _STATIC, _FORCES, _NAME, MASS, HEIGHT, PROTOCOL, _SUBJECT_FILE
)
"""Columns of a list in CSV."""

_PERSON = fields.text("name", "the person's name or code", required=True)
_STATICS = fields.Field(
    "static",
    "captures of standing trials",
    "a file or a list of files",
    lambda v: (
        [v]
        if isinstance(v, str)
        else v
        if isinstance(v, list) and all(isinstance(x, str) for x in v)
        else None
    ),
)
_TRIALS = fields.Field(
    "trials",
    "captures of moving trials",
    "a list of files, or of tables with path, forces and name",
    lambda v: v if isinstance(v, list) else None,
    required=True,
)
_SCALED = fields.text("subject", "a person scaled before, instead of static and mass")
LISTED_PERSON = fields.record(
    "subject", _PERSON, _SESSION, MASS, HEIGHT, PROTOCOL, _STATICS, _TRIALS, _SCALED
)
"""Entries of a person in a list in TOML."""

_PATH = fields.text("path", "the capture", required=True)
LISTED_TRIAL = fields.record("trial", _PATH, _FORCES, _NAME)
"""Entries of a trial in a list in TOML."""

_PERSONS = fields.part("subject", "a person and session", "[[subject]]", required=True)
TOML_LIST = fields.record("list", _PERSONS)
"""Entries of a list in TOML."""


def plan_of_toml(file: Path) -> Plan:
    """The persons and trials of a TOML list; a person or trial that cannot be right has its fault in the plan.

    Raises:
        UnknownEntry: The list has an entry besides its persons.
        FileFormatError: It is damaged.
        InvalidInput: It names no trial.
    """
    read = Entries.of_file(TOML_LIST, file, "a list in TOML", "mbkf batch --help shows one")
    if not isinstance(read.need(_PERSONS), list):
        raise read.fault("has no [[subject]]", "subject")
    listing = Listing(file)
    for number, one in enumerate(read.each_table(_PERSONS, LISTED_PERSON), start=1):
        row = f"subject {number}"
        if isinstance(one, FileFormatError):
            listing.lose((row, ""), row, file, one)
        else:
            _listed_person(listing, one, row)
    return listing.plan()


def plan_of_csv(file: Path) -> Plan:
    """The persons and trials of a CSV list; a row that cannot be right has its fault in the plan.

    Raises:
        UnknownEntry: A column is not known.
        FileFormatError: The list is damaged, or a required column is missing.
        InvalidInput: It names no trial.
    """
    listing = Listing(file)
    for row in read_edited_csv(file, CSV_LIST):
        listing.notes += row.notes
        key = row.cells.get("subject", f"line {row.line}"), row.cells.get("session", "")
        path, place = file, f"line {row.line}"
        if "trial" in row.cells:
            path = file.absolute().parent / row.cells["trial"].replace("\0", "")
            place = row.cells.get("name", path.stem)
        try:
            if isinstance(row.entries, FileFormatError):
                raise row.entries
            _csv_row(listing, row.entries)
        except FileFormatError as error:
            listing.lose(key, place, path, error)
    return listing.plan()


def _csv_row(listing: Listing, read: Entries) -> None:
    key: Key = read.need(_SUBJECT), read.get(_SESSION) or ""
    stated = _stated(read)
    named = [field for field in (_TRIAL, _FORCES, _STATIC, _SUBJECT_FILE) if field.key in read.table]
    files = {field.key: _file(read, read.need(field)) for field in named}
    trial, forces, static, scaled = (files.get(key) for key in ("trial", "forces", "static", "subject_file"))
    if trial is None and (forces is not None or _NAME.key in read.table or not (stated or files)):
        raise read.fault("trial is missing; name its capture")
    if scaled is not None:
        stated["subject"] = scaled
    listing.person(key, stated, read.origin.line)
    if static is not None:
        listing.static(key, static)
    if trial is not None:
        listing.trial(key, Files(trial, forces), read.get(_NAME) or trial.stem)


def _listed_person(listing: Listing, read: Entries, row: str) -> None:
    """Adds a person and the trials; without a name or trials, one lost trial that is called as its row."""
    name = row
    try:
        name = read.need(_PERSON)
        read.where = f"{name}: "
        key: Key = name, read.get(_SESSION) or ""
        trials = read.need(_TRIALS)
    except FileFormatError as error:
        listing.lose((name, ""), row, listing.file, error)
        return
    try:
        stated, scaled = _stated(read), read.get(_SCALED)
        if scaled is not None:
            stated["subject"] = _file(read, scaled)
        listing.person(key, stated, read.origin.line_of())
        for static in read.get(_STATICS) or ():
            listing.static(key, _file(read, static))
    except FileFormatError as error:
        listing.person(key, {}, None)
        listing.lose_person(key, error)
    for number, one in enumerate(trials, start=1):
        try:
            own = {"path": one} if isinstance(one, str) else one
            if not isinstance(own, dict):
                raise read.fault("a trial is a file, or a table with path, forces and name", _TRIALS.key)
            entries = Entries(LISTED_TRIAL, own, read.origin, f"{name}, trial {number}: ")
            path, forces = _file(entries, entries.need(_PATH)), entries.get(_FORCES)
            files = Files(path, None if forces is None else _file(entries, forces))
            listing.trial(key, files, entries.get(_NAME) or path.stem)
        except FileFormatError as error:
            listing.lose(key, f"trial {number}", listing.file, error)


def _stated(read: Entries) -> dict[str, object]:
    """Mass, height and protocol, as far as they are stated."""
    found = {field.key: read.get(field) for field in (MASS, HEIGHT)}
    stated: dict[str, object] = {key: value for key, value in found.items() if value is not None}
    if protocol := read.get(PROTOCOL):
        stated[PROTOCOL.key] = protocol
    return stated


def _file(read: Entries, name: str) -> Path:
    """A file that a list names.

    Raises:
        FileFormatError: Its name could not be one.
    """
    if "\0" in name:
        raise read.fault("a file's name cannot hold a zero byte")
    return (read.file.absolute().parent / name).absolute()
