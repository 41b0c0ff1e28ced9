"""Reports of sessions in the page's folder: compared with one another, against norms built from them."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from mbkf.app.charts import Charts
from mbkf.app.laboratory import laboratory_of
from mbkf.app.workspace import Workspace
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.norms import read_norms, write_norms
from mbkf.io.session import SessionNotes
from mbkf.study.session.gather import session_from
from mbkf.study.session.norm_selection import NormSelection, norm_selection
from mbkf.study.session.norms import norms_from
from mbkf.study.session.records import Session
from mbkf.trial.gait.convention import BY_CLINIC, CONVENTIONS, MOMENTS, Convention
from mbkf.viz.language import filled, words
from mbkf.viz.page import COLOURS
from mbkf.viz.session.document import session_page

NORMS_FILE = "norms.toml"
"""File of the norms that the page builds from all sessions."""

Plain = dict[str, object]


def choices(workspace: Workspace, session: str) -> Plain:
    """Other sessions with results, the nearest before and behind, dated visits of the person, and files of norms."""
    names = workspace.sessions()
    others = [name for name in names if name != session and _is_done(workspace, name)]
    at = names.index(session) if session in names else 0
    return {
        "sessions": others,
        "previous": next((name for name in names[:at][::-1] if name in others), None),
        "next": next((name for name in names[at + 1 :] if name in others), None),
        "visits": len(_other_visits(workspace, session)),
        "norms": [path.name for path in norms_files(workspace)],
        "charts": asdict(workspace.charts),
        "chart_choices": {"convention": CONVENTIONS, "moments": MOMENTS, "colours": tuple(COLOURS)},
    }


def report_of(
    workspace: Workspace,
    session: str,
    before: str,
    norms: str,
    language: str,
    charts: Charts | None = None,
    *,
    trend: bool = False,
    straight: bool = False,
) -> str:
    """The report of a session.

    Args:
        workspace: The sessions.
        session: Its name.
        before: Name of an earlier session to compare with; empty without.
        norms: Name of a file of norms in the page's folder; empty without.
        language: Code of the report's language.
        charts: Convention and colours; None: those of the workspace.
        trend: Adds the trend over all dated visits of the person.
        straight: Leaves out the gait cycles in which the pelvis turns.

    Raises:
        InvalidInput: Session, result, file of norms or language does not exist, or the norms hold this person.
        UnknownName: Convention, kind of moments or colours do not exist.
        FileFormatError: A file is damaged.
    """
    bands, chosen = None, charts or workspace.charts
    if norms:
        file = next((path for path in norms_files(workspace) if path.name == norms), None)
        if file is None:
            raise InvalidInput(f"there is no file of norms '{norms}'")
        bands = read_norms(file)
        if _person(session) in {one.name for one in bands.persons}:
            raise InvalidInput(
                f"{norms} holds walks of {_person(session)}, who would be compared with themselves; build the norms "
                "again in this report, which leaves this person out"
            )
    earlier = read_whole(workspace, before, chosen.read, straight) if before else None
    whole = read_whole(workspace, session, chosen.read, straight)
    names = _other_visits(workspace, session) if trend else []
    visits = [read_whole(workspace, name, chosen.read, straight) for name in names]
    laboratory = laboratory_of(workspace)
    return session_page(
        whole, earlier, bands, language, colours=chosen.colours, laboratory=laboratory, visits=visits
    )


def _other_visits(workspace: Workspace, session: str) -> list[str]:
    """Other sessions of the person with results and a date."""
    person = _person(session)
    return [
        name
        for name in workspace.sessions()
        if name != session
        and _person(name) == person
        and workspace.stated(name).visit.date
        and _is_done(workspace, name)
    ]


def read_whole(workspace: Workspace, session: str, convention: Convention, straight: bool = False) -> Session:
    """A session with all results of trials that are not left out.

    Args:
        workspace: The sessions.
        session: Its name.
        convention: Axes and signs of curves.
        straight: Leaves out the gait cycles in which the pelvis turns.

    Raises:
        InvalidInput: The session does not exist, or has no result.
        FileFormatError: A file is damaged.
    """
    notes = workspace.stated(session)
    folder = workspace.root.name if session == "." else session
    heading = f"{notes.name}, {folder}" if notes.name not in ("", folder) else folder
    return session_from(workspace.results(session), heading, notes, convention, straight)


def norms_selection(workspace: Workspace, session: str, language: str) -> Plain:
    """Persons that norms for a session would be built of, and who is left out and why, in words.

    Args:
        workspace: The sessions.
        session: Name of the session that the norms are for; empty for norms of all.
        language: Code of the page's language; verdicts and remarks are in English.

    Raises:
        FileFormatError: A file is damaged.
        InvalidInput: The language does not exist.
    """
    found, reasons = _selection(workspace, session), words(language, "left_out_of_norms")
    persons = [
        f"{one.facts.name}: {one.facts.sex}, {one.facts.age:g}, {one.facts.speed_m_s:.2f} m/s, {one.facts.cycles}"
        for one in found.persons
    ]
    left_out = [f"{one.who}: {filled(reasons[one.why], *one.details)}" for one in found.left_out]
    return {"persons": persons, "left_out": left_out, "cycles": found.cycles}


def build(workspace: Workspace, session: str, convention: Convention) -> Plain:
    """Builds norms from the sessions that belong into them, each first folder a person; writes them to the folder.

    Args:
        workspace: The sessions.
        session: Name of the session that the norms are for, whose person is left out; empty for norms of all.
        convention: Axes and signs of curves.

    Raises:
        InvalidInput: Fewer than two persons belong into them.
        FileFormatError: A file is damaged.
        OSError: The norms cannot be written.
    """
    norms = norms_from(_selection(workspace, session, convention), workspace.root.name)
    write_norms(norms, workspace.root / NORMS_FILE)
    return {"norms": NORMS_FILE, "persons": len(norms.persons)}


def _selection(workspace: Workspace, session: str, convention: Convention = BY_CLINIC) -> NormSelection:
    persons: dict[str, list[str]] = {}
    for name in workspace.sessions():
        if _is_done(workspace, name):
            persons.setdefault(_person(name), []).append(name)
    sessions = [
        session_from(
            [result for one in names for result in workspace.results(one)],
            person,
            _facts(workspace, names),
            convention,
        )
        for person, names in persons.items()
    ]
    return norm_selection(sessions, {_person(session)} & set(persons) if session else ())


def _facts(workspace: Workspace, names: list[str]) -> SessionNotes:
    """Sex, age and kinds of trials of a person, from the sessions that state them."""
    stated = [workspace.stated(name) for name in names]
    trials = {name: notes for one in stated for name, notes in one.trials.items()}
    sex = next((one.sex for one in stated if one.sex), "")
    return SessionNotes(
        sex=sex, age=next((one.age for one in stated if one.age is not None), None), trials=trials
    )


def _person(session: str) -> str:
    return session.split("/", maxsplit=1)[0]


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
