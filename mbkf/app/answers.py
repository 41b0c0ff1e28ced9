"""What the page is told of sessions, as plain data, and what it may state of them."""

from __future__ import annotations

from mbkf.app.recordings import recording_rows
from mbkf.app.runs import Runs, RunState
from mbkf.app.workspace import Workspace
from mbkf.io.session import SessionNotes, TrialKind, plain_session, session_of
from mbkf.study.survey.problems import plain_problem
from mbkf.study.survey.session import SurveyedSession
from mbkf.study.survey.trial import SurveyedTrial

Plain = dict[str, object]


def sessions(workspace: Workspace, runs: Runs) -> Plain:
    """All sessions, in short."""
    return {
        "folder": str(workspace.root),
        "sessions": [{"id": name, "run": run_state(runs.state(name))} for name in workspace.sessions()],
    }


def session(workspace: Workspace, runs: Runs, name: str) -> Plain:
    """One session: its person, its trials, what is the matter, and how far it is.

    Args:
        workspace: The sessions.
        runs: Their runs.
        name: Which session.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: Its session file is damaged.
    """
    looked = workspace.look(name)
    state = runs.state(name)
    return {
        "id": name,
        "notes": plain_session(looked.notes),
        "standing_kg": looked.standing_kg,
        "problems": [plain_problem(one) for one in looked.problems],
        "trials": [*(_trial(looked, one, state) for one in looked.trials), *recording_rows(workspace, name)],
        "kinds": [kind.value for kind in TrialKind],
        "run": run_state(state),
    }


def stated(workspace: Workspace, name: str, said: object) -> SessionNotes:
    """Takes what the page states of a session, and writes it.

    Args:
        workspace: The sessions.
        name: Which one.
        said: Entries of a session file.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: An entry is not possible.
        OSError: The session file cannot be written.
    """
    notes = session_of(said if isinstance(said, dict) else {"name": said})
    workspace.note(name, notes)
    return notes


def run_state(state: RunState | None) -> Plain | None:
    """How far a run is; None for a session that never ran."""
    if state is None:
        return None
    return {
        "state": state.state,
        "stage": state.stage,
        "done": state.done,
        "total": state.total,
        "seconds": state.seconds,
        "remaining_s": state.remaining_s,
        "reason": state.reason,
    }


def _trial(looked: SurveyedSession, trial: SurveyedTrial, state: RunState | None) -> Plain:
    status, reason = ("", "") if state is None else state.trials.get(trial.name, ("", ""))
    return {
        "name": trial.name,
        "file": trial.path.name,
        "kind": looked.kind(trial).value,
        "shown": trial.kind.value,
        "excluded": looked.notes.trial(trial.name).excluded,
        "seconds": trial.seconds,
        "rate_hz": trial.rate_hz,
        "markers": trial.markers,
        "unnamed": trial.unnamed,
        "protocol": trial.protocol,
        "plates": trial.plates,
        "events": trial.events,
        "usable": trial.usable,
        "problems": [plain_problem(one) for one in trial.problems],
        "status": status,
        "reason": reason,
    }
