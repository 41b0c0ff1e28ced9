"""Reports of sessions in the page's folder: compared with one another, against norms built from all of them."""

from __future__ import annotations

from pathlib import Path

from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.norms import read_norms, write_norms
from mbkf.study.session.gather import session_from
from mbkf.study.session.norms import norms_of
from mbkf.study.session.records import Session
from mbkf.viz.session.document import session_page

NORMS_FILE = "norms.toml"
"""File of the norms that the page builds from all sessions."""

Plain = dict[str, object]


def choices(workspace: Workspace, session: str) -> Plain:
    """Other sessions with results, and files of norms, for comparison with a session."""
    others = [name for name in workspace.sessions() if name != session and _is_done(workspace, name)]
    return {"sessions": others, "norms": [path.name for path in norms_files(workspace)]}


def report_of(workspace: Workspace, session: str, before: str, norms: str, language: str) -> str:
    """The report of a session.

    Args:
        workspace: The sessions.
        session: Its name.
        before: Name of an earlier session to compare with; empty without.
        norms: Name of a file of norms in the page's folder; empty without.
        language: Code of the report's language.

    Raises:
        InvalidInput: Session, result, file of norms or language does not exist.
        FileFormatError: A file is damaged.
    """
    bands = None
    if norms:
        file = next((path for path in norms_files(workspace) if path.name == norms), None)
        if file is None:
            raise InvalidInput(f"there is no file of norms '{norms}'")
        bands = read_norms(file)
    earlier = read_whole(workspace, before) if before else None
    return session_page(read_whole(workspace, session), earlier, bands, language)


def read_whole(workspace: Workspace, session: str) -> Session:
    """A session with all results of trials that are not left out.

    Raises:
        InvalidInput: The session does not exist, or has no result.
        FileFormatError: A file is damaged.
    """
    notes = workspace.stated(session)
    folder = workspace.root.name if session == "." else session
    heading = f"{notes.name}, {folder}" if notes.name not in ("", folder) else folder
    return session_from(workspace.results(session), heading, notes)


def build(workspace: Workspace) -> Plain:
    """Builds norms from all sessions with results, each first folder a person; writes them to the page's folder.

    Raises:
        InvalidInput: Fewer than two persons have gait.
        FileFormatError: A file is damaged.
        OSError: The norms cannot be written.
    """
    persons: dict[str, list[str]] = {}
    for name in workspace.sessions():
        if _is_done(workspace, name):
            persons.setdefault(name.split("/")[0], []).append(name)
    sessions = (
        session_from([result for one in names for result in workspace.results(one)], person)
        for person, names in persons.items()
    )
    norms = norms_of(sessions, workspace.root.name)
    write_norms(norms, workspace.root / NORMS_FILE)
    return {"norms": NORMS_FILE, "persons": max(band.persons for band in norms.curves.values())}


def norms_files(workspace: Workspace) -> list[Path]:
    """The files of norms in the page's folder."""
    found = []
    for path in sorted(workspace.root.glob("*.toml")):
        try:
            read_norms(path)
        except FileFormatError:
            continue
        found.append(path)
    return found


def _is_done(workspace: Workspace, session: str) -> bool:
    try:
        return bool(workspace.results(session))
    except InvalidInput:
        return False
