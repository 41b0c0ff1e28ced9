"""Changes of a session file by several people and programs at once: each has a version, and none is lost.

A change states the notes that it began from. It is laid over the file as it is now, field by field: a person's mass
from one page, an exclusion from another, a line typed into the file by hand.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.atomic import flush, replacing
from mbkf.io.edited_toml import edited_toml
from mbkf.io.files_read import read_state_bytes
from mbkf.io.leftovers import locked
from mbkf.io.merging import Difference, merged
from mbkf.io.session import SessionNotes, plain_session, read_session, session_of, session_text
from mbkf.io.utf8 import encoded

MOST_TRIES = 20
"""Tries against a program that writes the file again and again."""


@dataclass(frozen=True)
class ChangedSession:
    """A session file after a change.

    Attributes:
        notes: The statements in the file now.
        differences: Fields that the file holds with another value than the change and the notes it began from.
    """

    notes: SessionNotes
    differences: tuple[Difference, ...]


def version_of(plain: object) -> str:
    """A short text that is the same for the same plain data, and different for others."""
    text = json.dumps(plain, sort_keys=True, ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()[:32]


def session_version(notes: SessionNotes) -> str:
    """The version of a session's notes."""
    return version_of(plain_session(notes))


def current_session(path: Path) -> SessionNotes:
    """The notes of a session file; empty ones without the file.

    Raises:
        FileFormatError: The file is damaged.
    """
    return read_session(path) if path.is_file() else SessionNotes()


def change_session(path: Path, before: SessionNotes, after: SessionNotes) -> ChangedSession:
    """Lays a change over a session file; fields that others changed meanwhile stay.

    Processes of this program write one after the other. If another program writes the file meanwhile, the change is
    laid over that one's content.

    Args:
        path: The session file; made where missing.
        before: The notes that the change began from.
        after: The notes with the change.

    Raises:
        FileFormatError: The file is damaged, or both changes together are not possible.
        OSError: The file cannot be written.
    """
    with locked(path.parent, wait=True):
        for _ in range(MOST_TRIES):
            seen = _content(path)
            now = current_session(path)
            found = merged(plain_session(before), plain_session(after), plain_session(now))
            notes = session_of(found.table, path)
            if notes == now or _written(path, _text(notes, seen), seen):
                return ChangedSession(notes, found.differences)
    raise FileFormatError(path, "another program writes this file again and again; close it and save again")


def _text(notes: SessionNotes, seen: bytes | None) -> str:
    """The file's text with other notes; comments of people stay."""
    text = session_text(notes)
    return text if seen is None else edited_toml(seen.decode("utf-8-sig", "replace"), text)


def _written(path: Path, text: str, seen: bytes | None) -> bool:
    """Writes the text, unless the file holds another content than the one seen; False then."""
    try:
        with replacing(path, edits=True) as partial:
            partial.write_bytes(encoded(text))
            flush(partial)  # before the last look, so that little time lies between that and the exchange
            if _content(path) != seen:
                raise _Overtaken
    except _Overtaken:
        return False
    return True


class _Overtaken(Exception):
    """Another program has written the file meanwhile."""


def _content(path: Path) -> bytes | None:
    try:
        return read_state_bytes(path)
    except FileNotFoundError:
        return None
