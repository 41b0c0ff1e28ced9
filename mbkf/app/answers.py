"""Sessions and runs as plain data for the page."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from mbkf.app.live_run import LiveRun
from mbkf.app.recordings import recording_rows
from mbkf.app.run_states import INCOMPLETE, RunState
from mbkf.app.runs import Runs
from mbkf.app.verdicts import gravest_on, verdict_on
from mbkf.app.workspace import Workspace
from mbkf.io.session import TrialKind, plain_session
from mbkf.io.session_change import session_version
from mbkf.study.batch.person import record_of
from mbkf.study.scaling.report import scaled_from, used_trials
from mbkf.study.survey.problems import plain_problem
from mbkf.study.survey.session import SurveyedSession
from mbkf.study.survey.trial import SurveyedTrial

Plain = dict[str, object]

HAS_RESULT = ("done", "unchanged")
"""Statuses of trials with a result."""


def sessions(workspace: Workspace, runs: Runs, moved: list[Plain]) -> Plain:
    """All sessions, in short.

    Args:
        workspace: The sessions.
        runs: Their runs.
        moved: Deletions and moves that can be undone.
    """
    return {
        "folder": str(workspace.root),
        "moved": moved,
        "sessions": [_in_short(workspace, runs.state(name), name) for name in workspace.sessions()],
    }


def _in_short(workspace: Workspace, state: RunState | None, name: str) -> Plain:
    """A session with its run and the gravest word on its trials: "look" at least where one of them was not done."""
    place = workspace.place(name)
    trials = {} if state is None else state.trials
    done = [place / trial for trial, (status, _) in trials.items() if status in HAS_RESULT]
    failed = sum(status == "failed" for status, _ in trials.values())
    counts = {"failed": failed, "trials": len(trials)}
    incomplete = failed > 0 or (state is not None and state.state in INCOMPLETE)
    return {"id": name, "run": run_state(state), **counts, "verdict": gravest_on(done, incomplete)}


def session(workspace: Workspace, runs: Runs, name: str) -> Plain:
    """One session: person, trials, problems, and the state of its run.

    Args:
        workspace: The sessions.
        runs: Their runs.
        name: Of the session.

    Raises:
        InvalidInput: The session does not exist.
        FileFormatError: Its session file is damaged.
    """
    found = workspace.survey(name)
    state = runs.state(name)
    place = workspace.place(name)
    scaled = record_of(place)
    return {
        "id": name,
        "notes": plain_session(found.notes),
        "version": session_version(found.notes),
        "standing_kg": found.standing_kg,
        "problems": [plain_problem(one) for one in found.problems],
        "trials": [
            *(_trial(found, one, state, place) for one in found.trials),
            *recording_rows(workspace, name),
        ],
        "kinds": [kind.value for kind in TrialKind],
        "run": run_state(state),
        "scaled_from": used_trials(scaled),
        "scaled_why": scaled_from(scaled),
    }


def run_state(state: RunState | None) -> Plain | None:
    """The state of a run; None for a session that never ran."""
    if state is None:
        return None
    names = ("state", "stage", "done", "total", "share", "seconds", "remaining_s", "reason")
    return {**{name: getattr(state, name) for name in names}, "persons": list(state.persons)}


def live_state(live: LiveRun) -> Plain:
    """The state of the newest live run under "run"; None before the first one."""
    state = live.state()
    return {"run": None if state is None else {**asdict(state), "goes_on": state.goes_on}}


def _trial(found: SurveyedSession, trial: SurveyedTrial, state: RunState | None, place: Path) -> Plain:
    status, reason = ("", "") if state is None else state.trials.get(trial.name, ("", ""))
    progress = None if state is None else state.under_way.get(trial.name)
    copied = ("name", "seconds", "rate_hz", "markers", "unnamed", "protocol", "plates", "events", "usable")
    return {
        **{name: getattr(trial, name) for name in copied},
        "file": trial.path.name,
        "kind": found.kind(trial).value,
        "shown": trial.kind.value,
        "excluded": found.notes.trial(trial.name).excluded,
        "problems": [plain_problem(one) for one in trial.problems],
        "status": status,
        "reason": reason,
        "verdict": verdict_on(place / trial.name) if status in HAS_RESULT else None,
        "under_way": None if progress is None else asdict(progress) | {"share": progress.share},
    }
