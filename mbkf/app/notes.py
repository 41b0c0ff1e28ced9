"""Changes of notes that pages ask for: each begins from a version, and what somebody else changed meanwhile stays.

A request states the notes that it began from (``base``) and the changed ones. Without the base it replaces the notes,
which only the version of the present ones allows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict

from mbkf.app.failures import OVERTAKEN, Refused
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.merging import Difference
from mbkf.io.session import session_of
from mbkf.io.session_change import session_version

Plain = dict[str, object]

CHANGED_MEANWHILE = "somebody else has changed this meanwhile: {fields}; choose what is right"


def change_notes(workspace: Workspace, name: str, sent: object, version: str) -> Plain:
    """Writes a change of the statements about a session.

    Args:
        workspace: The sessions.
        name: Of the session.
        sent: ``notes``: entries of a session file; ``base``: those that the change began from.
        version: Of the notes that the change began from.

    Returns:
        :func:`disagreement` of the fields that somebody else changed.

    Raises:
        InvalidInput: The session does not exist, or the request holds no notes.
        FileFormatError: An entry is not possible.
        Refused: The version is not that of the base, or of the present notes where the base is missing.
        OSError: The session file cannot be written.
    """
    if not isinstance(sent, Mapping) or not isinstance(sent.get("notes"), Mapping):
        raise InvalidInput("the page sent no notes")
    after = session_of(sent["notes"])
    base = sent.get("base")
    before = session_of(base) if isinstance(base, Mapping) else workspace.notes(name)
    check_version(session_version(before), version)
    return disagreement(workspace.change(name, before, after).differences)


def check_version(found: str, named: str) -> None:
    """Refuses a change that names another version than that of the notes it began from.

    Raises:
        Refused: It does.
    """
    if found != named:
        raise Refused(OVERTAKEN, "the notes have changed since this page loaded them; load the page again")


def disagreement(differences: tuple[Difference, ...]) -> Plain:
    """Fields that somebody else changed to another value, with a sentence; empty without such fields."""
    if not differences:
        return {}
    fields = ", ".join(" ".join(one.field) for one in differences)
    return {
        "trouble": CHANGED_MEANWHILE.format(fields=fields),
        "differences": [{**asdict(one), "field": list(one.field)} for one in differences],
    }
