"""The marker set of a session, looked at and changed on its standing trial, and stated in the session file."""

from __future__ import annotations

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
"""File of a session's own marker set, beside its captures, where the session file names no other."""


class MarkerSets:
    """The marker sets that pages change at the moment, one for each session."""

    def __init__(self, workspace: Workspace) -> None:
        """Args: the sessions."""
        self._workspace = workspace
        self._edits: dict[str, MarkerSetEdit] = {}
        self._lock = Lock()

    def open(self, session: str) -> str:
        """The page on which a session's marker set is changed.

        Args:
            session: Which one.

        Raises:
            InvalidInput: The session does not exist, or no capture with named markers.
            FileFormatError: The capture or the stated set is damaged.
        """
        looked, folder = self._workspace.look(session), self._workspace.folder(session)
        stated = self._workspace.stated(session).protocol
        protocol, capture = starting_set(read_capture(capture_to_show(looked)), stated)
        edit = MarkerSetEdit(protocol, stand_beside(capture, protocol), folder / file_of_set(looked.notes))
        with self._lock:
            self._edits[session] = edit
        return edit.text("marker_set/say?" + urlencode({"session": session}))

    def say(self, session: str, word: str) -> str:
        """Does what a page asks for; a set that was saved is the session's from then on.

        Args:
            session: Whose page.
            word: What it says, in JSON (:meth:`MarkerSetEdit.hear`).

        Returns:
            The answer, in JSON.

        Raises:
            InvalidInput: No page of this session is open.
            OSError: The session file cannot be written.
        """
        with self._lock:
            edit = self._edits.get(session)
            if edit is None:
                raise InvalidInput(f"no marker set of '{session}' is being changed; open its page again")
            before = edit.saved
            answer = edit.hear(word)
            if edit.saved is not before:
                notes = self._workspace.look(session).notes
                self._workspace.note(session, replace(notes, protocol=file_of_set(notes)))
            return answer


def file_of_set(notes: SessionNotes) -> str:
    """The file in a session's folder that holds its marker set; a file elsewhere belongs to other sessions, too."""
    named = notes.protocol or ""
    own = named.lower().endswith(".toml") and Path(named).name == named
    return named if own else SET_FILE


def capture_to_show(looked: SurveyedSession) -> Path:
    """The capture on which a set is looked at: a standing trial, else that with most named markers.

    Raises:
        InvalidInput: None has named markers.
    """
    named = [one for one in looked.trials if one.markers and not looked.notes.trial(one.name).excluded]
    if not named:
        raise InvalidInput("no capture of this session has named markers")
    return max(named, key=lambda one: (looked.kind(one) == TrialKind.STATIC, one.markers)).path
