"""The session file of results: beside them, else beside the captures that they were made from."""

from __future__ import annotations

from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.session import SESSION_FILE, SessionNotes
from mbkf.study.batch.folder import stated_of
from mbkf.study.batch.inputs import RECORD, read_record

MOST_ABOVE = 4
"""Folders above a capture in which its session file is looked for."""


def session_files(place: Path, result: Path) -> list[Path]:
    """Session files of results, the nearest first.

    Args:
        place: Folder that holds the results of a person or a session.
        result: One of these results.
    """
    try:
        files = read_record(result / RECORD).get("files", {})
        captures = [Path(name).absolute() for name in files] if isinstance(files, dict) else []
    except FileFormatError:
        captures = []
    places = [place, *(above for file in captures[:1] for above in list(file.parents)[:MOST_ABOVE])]
    return [file for one in places if (file := one / SESSION_FILE).is_file()]


def stated_on_results(place: Path, result: Path) -> SessionNotes:
    """Statements about the session of results, with those of folders above it; empty ones without a session file.

    Args:
        place: Folder that holds the results of a session.
        result: One of these results.

    Raises:
        FileFormatError: A session file is damaged.
    """
    files = session_files(place, result)
    if not files:
        return SessionNotes()
    folder = files[0].absolute().parent
    return stated_of([folder, *folder.parents][:MOST_ABOVE][-1], folder)
