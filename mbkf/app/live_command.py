"""A live run as the page describes it, as options of ``mbkf live``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.session import TrialKind
from mbkf.stream.discovery import port_number
from mbkf.study.survey.session import SurveyedSession

LSL, NATNET, QUALISYS, UDP, VICON, XSENS, FILE = "lsl", "natnet", "qualisys", "udp", "vicon", "xsens", "file"
"""Sources of the frames."""

MOTIVE = ("server", "local", "port", "multicast")
"""Options of NatNet; the first two have to be given."""

SUBJECT, STANDING = "subject", "standing"
"""Bodies: the session's scaled one, or one that is scaled while the person stands still."""

MOST_LETTERS = 500
"""Longest text that the page may send."""

MISSING = {
    "stream": "choose a stream",
    "trial": "choose a capture",
    "host": "the address of the camera system's computer is missing",
}
"""Messages for texts that are missing; others are addresses."""


def live_offer(workspace: Workspace, session: str) -> dict[str, object]:
    """Choices for a live run of a session: its captures, and its body and mass where they are known.

    Captures that are left out are no choice; moving ones come first, so that no standing trial is replayed unasked.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: Its session file is damaged.
    """
    found = workspace.survey(session)
    usable = [one for one in found.trials if one.usable and not found.notes.trial(one.name).excluded]
    usable.sort(key=lambda one: found.kind(one) == TrialKind.STATIC)
    return {
        "captures": [
            {"name": one.name, "file": one.path.name, "kind": found.kind(one).value} for one in usable
        ],
        "subject": workspace.subject(session) is not None,
        "mass_kg": workspace.stated(session).mass_kg,
    }


def live_options(workspace: Workspace, session: str, wanted: object) -> list[str]:
    """The options of ``mbkf live`` for a run that the page asks for.

    Every value is one word with its option, so that none can be taken for another option.

    Args:
        workspace: The sessions.
        session: Name of the session.
        wanted: ``source`` with ``stream`` ("lsl"), :data:`MOTIVE` ("natnet"), ``host`` and ``port`` ("qualisys",
            "vicon"), ``port`` and ``local`` ("udp", "xsens"), or ``trial`` ("file"); ``body`` ("subject" or
            "standing").

    Raises:
        InvalidInput: The session does not exist, or an entry is missing or not possible.
        FileFormatError: The session file is damaged.
    """
    if not isinstance(wanted, Mapping):
        raise InvalidInput("a live run needs a source and a body")
    return [*_source(workspace.survey(session), wanted), *_body(workspace, session, wanted)]


def _source(session: SurveyedSession, wanted: Mapping[str, object]) -> list[str]:
    source = _text(wanted, "source")
    if source == LSL:
        return ["--from=lsl", f"--stream={_needed(wanted, 'stream')}"]
    if source == NATNET:
        needed = [f"--{key}={_needed(wanted, key)}" for key in MOTIVE[:2]]
        return ["--from=natnet", *needed, *_given(wanted, MOTIVE[2:])]
    if source in (QUALISYS, VICON):
        return [f"--from={source}:{_needed(wanted, 'host')}{_port(wanted)}"]
    if source in (UDP, XSENS):
        return [f"--from={source}{_port(wanted)}", *_given(wanted, ("local",))]
    if source != FILE:
        raise InvalidInput("choose a stream, a camera system or a capture")
    name = _needed(wanted, "trial")
    for trial in session.trials:
        if trial.name == name:
            forces = [] if trial.forces is None else [f"--forces={trial.forces}"]
            return [f"--from=file:{trial.path}", *forces]
    raise InvalidInput(f"there is no capture '{name}'")


def _body(workspace: Workspace, session: str, wanted: Mapping[str, object]) -> list[str]:
    body = _text(wanted, "body")
    if body == SUBJECT:
        subject = workspace.subject(session)
        if subject is None:
            raise InvalidInput("no body of this session is scaled yet; let the person stand still")
        return [f"--subject={subject}"]
    if _text(wanted, "source") == XSENS:
        raise InvalidInput(
            "sensors need the session's scaled body; scale it first with a standing trial, or live before the cameras"
        )
    if body != STANDING:
        raise InvalidInput("choose the scaled body, or standing still")
    notes = workspace.stated(session)
    mass = [] if notes.mass_kg is None else [f"--mass={notes.mass_kg!r}"]
    return mass + ([] if notes.protocol is None else [f"--protocol={notes.protocol}"])


def _given(wanted: Mapping[str, object], keys: Sequence[str]) -> list[str]:
    """Options whose texts are not empty."""
    return [f"--{key}={text}" for key in keys if (text := _text(wanted, key))]


def _port(wanted: Mapping[str, object]) -> str:
    """A colon and the port; empty for the usual one.

    Raises:
        InvalidInput: It is not one.
    """
    text = _text(wanted, "port")
    return f":{port_number(text)}" if text else ""


def _needed(wanted: Mapping[str, object], key: str) -> str:
    text = _text(wanted, key)
    if not text:
        raise InvalidInput(MISSING.get(key, f"the {key} address is missing"))
    return text


def _text(wanted: Mapping[str, object], key: str) -> str:
    """A short text; empty where it is missing.

    Raises:
        InvalidInput: The entry is too long, or no text.
    """
    text = wanted.get(key, "")
    if not isinstance(text, str) or len(text) > MOST_LETTERS or "\0" in text:
        raise InvalidInput(f"the {key} must be a short text")
    return text if key in {"stream", "trial"} else text.strip()


def recording_folder(workspace: Workspace, session: str, stamp: str) -> Path:
    """A folder for a recording whose name neither a capture of the session nor a result has.

    Args:
        workspace: The sessions.
        session: Name of the session.
        stamp: The time, in letters that a file's name may hold.

    Raises:
        InvalidInput: The session does not exist.
    """
    return workspace.place(session) / _free_name(workspace, session, f"live-{stamp}")


def recording_options(workspace: Workspace, session: str, wanted: object, stamp: str) -> list[str]:
    """Options that record the stream's markers and plates as a new capture of the session, if the page asks for it.

    Args:
        workspace: The sessions.
        session: Name of the session.
        wanted: As for :func:`live_options`; ``record`` is not empty where a capture is wanted.
        stamp: The time, in letters that a file's name may hold.

    Raises:
        InvalidInput: The session does not exist, or the source has no markers.
    """
    if not isinstance(wanted, Mapping) or not _text(wanted, "record"):
        return []
    if _text(wanted, "source") == XSENS:
        raise InvalidInput("sensors bring no markers and forces that a capture could hold")
    name = _free_name(workspace, session, f"recorded-{stamp}")
    return [f"--record={workspace.folder(session) / name}.c3d"]


def _free_name(workspace: Workspace, session: str, wanted: str) -> str:
    """The name, or it with a number, that neither a capture of the session nor a result has."""
    place, folder = workspace.place(session), workspace.folder(session)
    captures = {one.name for one in workspace.survey(session).trials}
    name, number = wanted, 1
    while name in captures or (place / name).exists() or (folder / f"{name}.c3d").exists():
        number += 1
        name = f"{wanted}-{number}"
    return name
