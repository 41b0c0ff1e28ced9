"""Survey of a session's folder: its captures, and their joint evidence on the person."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.session import SESSION_FILE, SessionNotes, TrialKind, read_session
from mbkf.study.batch.folder import captures_in, forces_beside, is_static, stated_of, strange_trials
from mbkf.study.survey.problems import Problem
from mbkf.study.survey.trial import SurveyedTrial, survey_trial

MASS_SHARE = 0.05
"""A stated mass that differs by more from the mass on the plates is reported."""

Survey = Callable[[Path, Path | None], SurveyedTrial]
"""Looks at a capture and the ground reactions beside it."""


@dataclass(frozen=True)
class SurveyedSession:
    """A session, looked at.

    Attributes:
        folder: Its folder.
        notes: Statements of the session file.
        trials: Its captures, in the order of their names.
        standing_kg: Mass by the plates under the person standing; None: unknown.
        problems: Problems of the session as a whole.
        damage: Why its session file, or one above it, cannot be read; empty where it can.
    """

    folder: Path
    notes: SessionNotes
    trials: tuple[SurveyedTrial, ...]
    standing_kg: float | None
    problems: tuple[Problem, ...]
    damage: str = ""

    def kind(self, trial: SurveyedTrial) -> TrialKind:
        """Kind of a trial: as stated, else a standing one by its name, else as its markers show."""
        stated = self.notes.trial(trial.name).kind
        if stated is not None:
            return stated
        return TrialKind.STATIC if is_static(trial.path) else trial.kind


def survey_session(
    folder: Path,
    survey: Survey = survey_trial,
    root: Path | None = None,
    live_runs: Collection[str] = (),
) -> SurveyedSession:
    """Looks at the captures of a folder, those of folders in it left out.

    Args:
        folder: The session's folder.
        survey: Looks at a capture; a page that shows a session again and again keeps its results.
        root: The study's folder, where it is one of more; session files above the session count down from there.
        live_runs: Names of recorded live runs, of which the session file may state events.

    A damaged session file is a problem of the session, which is shown without its statements.

    Raises:
        OSError: The folder cannot be read.
    """
    file, damage, remarks = folder / SESSION_FILE, "", []
    captures, files = captures_in(folder), sorted(folder.iterdir())
    notes = stated = SessionNotes()
    try:
        stated = stated_of(root or folder, folder)
        notes = read_session(file) if file.is_file() else notes
        remarks = strange_trials(notes, captures, file, live_runs)
    except FileFormatError as error:
        damage, notes, stated = str(error), SessionNotes(), SessionNotes()
    trials = tuple(_with_set(survey(path, forces_beside(path, files)), stated) for path in captures)
    masses = [trial.standing_kg for trial in trials if trial.standing_kg is not None]
    standing = sorted(masses)[len(masses) // 2] if masses else None
    session = SurveyedSession(folder, notes, trials, standing, (), damage)
    found: list[Problem] = [Problem("session_file", (damage,))] if damage else []
    found += [Problem("strange_trial", (remark,)) for remark in remarks]
    return replace(session, problems=(*found, *_problems(session, stated.mass_kg)))


def _with_set(trial: SurveyedTrial, stated: SessionNotes) -> SurveyedTrial:
    """The trial without doubts about its marker set where session files state one."""
    if not stated.protocol:
        return trial
    return replace(trial, problems=tuple(one for one in trial.problems if not one.marker_set))


def _problems(session: SurveyedSession, stated: float | None) -> tuple[Problem, ...]:
    """Problems of the session as a whole, its person's mass stated in kg or not."""
    found, standing = [], session.standing_kg
    if stated is None:
        stated = next((one.stated_kg for one in session.trials if one.stated_kg is not None), None)
    if stated is not None and standing is not None and abs(stated / standing - 1.0) > MASS_SHARE:
        found.append(Problem("mass", (f"{stated:.1f}", f"{standing:.1f}")))
    kept = [one for one in session.trials if one.usable and not session.notes.trial(one.name).excluded]
    if not kept:
        found.append(Problem("no_trial"))
    elif not any(session.kind(one) == TrialKind.STATIC for one in kept):
        found.append(Problem("no_static"))
    return tuple(found)
