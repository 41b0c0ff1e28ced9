"""The marker set of a session: changed on its standing trial and named in the session file."""

from __future__ import annotations

import secrets
from dataclasses import replace
from pathlib import Path
from threading import Lock
from urllib.parse import urlencode

from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.session import SessionNotes, TrialKind
from mbkf.study.survey.session import SurveyedSession
from mbkf.trial.protocol.editing import starting_set
from mbkf.trial.protocol.standing import stand_beside
from mbkf.viz.protocol.edit import MarkerSetEdit

SET_FILE = "marker_set.toml"
"""File of a session's own marker set, beside its captures, unless the session file names another."""

MOST_OPEN = 32
"""Most editors at once; the oldest one has to be opened again."""


class MarkerSets:
    """The marker sets that are open in editors; each page has an editor of its own, so that two merge on saving.

    Args:
        workspace: The sessions.
    """

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._edits: dict[tuple[str, str], MarkerSetEdit] = {}
        self._lock = Lock()

    def open(self, session: str) -> str:
        """The editor's page for a session's marker set.

        Raises:
            InvalidInput: The session does not exist, or has no capture with named markers.
            FileFormatError: The capture or the stated set is damaged.
        """
        found, folder = self._workspace.survey(session), self._workspace.folder(session)
        stated = self._workspace.stated(session).protocol
        protocol, capture = starting_set(read_capture(capture_to_show(found)), stated)
        place = folder / file_of_set(found.notes)
        edit = MarkerSetEdit(protocol, stand_beside(capture, protocol), place, edits=True)
        page = secrets.token_hex(8)
        with self._lock:
            self._edits[session, page] = edit
            while len(self._edits) > MOST_OPEN:
                del self._edits[next(iter(self._edits))]
        return edit.text("marker_set/say?" + urlencode({"session": session, "page": page}))

    def say(self, session: str, page: str, word: str) -> str:
        """Carries out a request of an editor's page; a saved set becomes the session's.

        Args:
            session: Name of the session.
            page: Name of the editor's page.
            word: The request, in JSON (:meth:`MarkerSetEdit.hear`).

        Returns:
            The reply, in JSON.

        Raises:
            InvalidInput: This editor of the session is not open.
            OSError: The session file cannot be written.
        """
        with self._lock:
            edit = self._edits.get((session, page))
            if edit is None:
                raise InvalidInput(f"the marker editor of '{session}' is not open; open it again")
            before = edit.saved
            answer = edit.hear(word)
            if edit.saved is not before:
                notes = self._workspace.notes(session)
                self._workspace.change(session, notes, replace(notes, protocol=edit.file))
            return answer


def file_of_set(notes: SessionNotes) -> str:
    """The file in a session's folder for its marker set; a file elsewhere may belong to other sessions, too."""
    named = notes.protocol or ""
    own = named.lower().endswith(".toml") and Path(named).name == named
    return named if own else SET_FILE


def capture_to_show(session: SurveyedSession) -> Path:
    """The capture on which a set is edited: a standing trial, else the one with most named markers.

    Raises:
        InvalidInput: No capture has named markers.
    """
    named = [one for one in session.trials if one.markers and not session.notes.trial(one.name).excluded]
    if not named:
        raise InvalidInput("no capture of this session has named markers")
    return max(named, key=lambda one: (session.kind(one) == TrialKind.STATIC, one.markers)).path
