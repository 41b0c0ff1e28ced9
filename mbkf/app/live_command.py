"""What the page asks of a live run, as options of ``mbkf live``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.study.survey.session import SurveyedSession

LSL, NATNET, FILE = "lsl", "natnet", "file"
"""Where frames come from."""

SUBJECT, STANDING = "subject", "standing"
"""Whose body is followed: the session's scaled one, or one to be scaled as the person stands still."""

MOST_LETTERS = 500
"""Longer names are none."""


def live_offer(workspace: Workspace, session: str) -> dict[str, object]:
    """What a live run of a session can be made of: its captures, its body, and where Motive is looked for.

    Args:
        workspace: The sessions.
        session: Which one.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: Its session file is damaged.
    """
    return {
        "captures": [one.name for one in workspace.look(session).trials if one.usable],
        "subject": workspace.subject(session) is not None,
        "mass_kg": workspace.stated(session).mass_kg,
    }


def live_options(workspace: Workspace, session: str, said: object) -> list[str]:
    """The options of ``mbkf live`` that stand for what the page says.

    Every value is one word with its option, so that none can be taken for another option.

    Args:
        workspace: The sessions.
        session: Which one.
        said: ``source`` ("lsl", "natnet" or "file") with ``stream``, ``server`` and ``local``, or ``trial``; ``body``
            ("subject" or "standing").

    Raises:
        InvalidInput: The session does not exist, or what is said is not possible.
        FileFormatError: The session file is damaged.
    """
    if not isinstance(said, Mapping):
        raise InvalidInput("a live run is asked for with its source and body")
    return [*_source(workspace.look(session), said), *_body(workspace, session, said)]


def _source(session: SurveyedSession, said: Mapping[str, object]) -> list[str]:
    source = _text(said, "source")
    if source == LSL:
        return ["--from=lsl", f"--stream={_needed(said, 'stream')}"]
    if source == NATNET:
        return ["--from=natnet", f"--server={_needed(said, 'server')}", f"--local={_needed(said, 'local')}"]
    if source != FILE:
        raise InvalidInput("choose a stream, Motive or a capture")
    name = _needed(said, "trial")
    for trial in session.trials:
        if trial.name == name:
            forces = [] if trial.forces is None else [f"--forces={trial.forces}"]
            return [f"--from=file:{trial.path}", *forces]
    raise InvalidInput(f"there is no capture '{name}'")


def _body(workspace: Workspace, session: str, said: Mapping[str, object]) -> list[str]:
    body = _text(said, "body")
    if body == SUBJECT:
        subject = workspace.subject(session)
        if subject is None:
            raise InvalidInput("no body of this session is scaled yet; let the person stand still")
        return [f"--subject={subject}"]
    if body != STANDING:
        raise InvalidInput("choose the scaled body, or standing still")
    notes = workspace.stated(session)
    mass = [] if notes.mass_kg is None else [f"--mass={notes.mass_kg!r}"]
    return mass + ([] if notes.protocol is None else [f"--protocol={notes.protocol}"])


def _needed(said: Mapping[str, object], key: str) -> str:
    text = _text(said, key)
    if not text:
        raise InvalidInput(
            {"stream": "choose a stream", "trial": "choose a capture"}.get(
                key, f"the {key} address is missing"
            )
        )
    return text


def _text(said: Mapping[str, object], key: str) -> str:
    """A text of one line; empty where it is missing.

    Raises:
        InvalidInput: It is no such text.
    """
    text = said.get(key, "")
    if not isinstance(text, str) or len(text) > MOST_LETTERS or "\0" in text:
        raise InvalidInput(f"the {key} must be a short text")
    return text.strip() if key in {"server", "local"} else text


def recording_folder(workspace: Workspace, session: str, stamp: str) -> Path:
    """A folder for a recording that neither a capture of the session nor a result has.

    Args:
        workspace: The sessions.
        session: Which one.
        stamp: The time, as a file's name may hold it.

    Raises:
        InvalidInput: The session does not exist.
    """
    place, captures = workspace.place(session), {one.name for one in workspace.look(session).trials}
    name, number = f"live-{stamp}", 1
    while name in captures or (place / name).exists():
        number += 1
        name = f"live-{stamp}-{number}"
    return place / name
