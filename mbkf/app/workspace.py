"""The folder of a page: its sessions, their captures, and their results.

A folder with captures is a session, named by its path in the page's folder, "." for the folder itself. Results lie in
``results`` beside the sessions, as ``mbkf batch`` writes them. Methods raise InvalidInput for a session that does not
exist, and FileFormatError for a damaged session file.
"""

from __future__ import annotations

import threading
from contextlib import AbstractContextManager
from pathlib import Path
from typing import BinaryIO

from mbkf.app.charts import Charts
from mbkf.app.several_persons import of_one_person
from mbkf.app.uploads import RESULTS, putting
from mbkf.errors import InvalidInput
from mbkf.io.results_folder import SUMMARY_FILE
from mbkf.io.session import SESSION_FILE, FootEvent, SessionNotes, TrialNotes
from mbkf.io.session_change import ChangedSession, change_session, current_session
from mbkf.stream.run.report import LIVE_FILE
from mbkf.study.batch.folder import (
    SUBJECT_FILE,
    person_and_session,
    plan_of_folder,
    session_folders,
    stated_of,
)
from mbkf.study.batch.plan import Person, Plan, Trial
from mbkf.study.survey.session import SurveyedSession, survey_session
from mbkf.study.survey.trial import SurveyedTrial, survey_trial

Stamp = tuple[tuple[int, int], ...]
"""Sizes and times of a capture's files."""


class Workspace:
    """Sessions of a folder; a survey of a capture is cached until its files change.

    Args:
        root: The folder; made if it is missing.
        charts: Choices of charts where a page states no other.

    Attributes:
        root: The folder.
        charts: The choices.
        out: Folder of the results.
    """

    def __init__(self, root: Path, charts: Charts | None = None) -> None:
        self.root, self.charts = root.absolute(), charts or Charts()
        self.root.mkdir(parents=True, exist_ok=True)
        self.out = self.root / RESULTS
        self._cached: dict[Path, tuple[Stamp, SurveyedTrial]] = {}
        self._surveying = threading.Lock()

    def sessions(self) -> tuple[str, ...]:
        """The names of its sessions."""
        return tuple(folder.relative_to(self.root).as_posix() for folder in session_folders(self.root))

    def folder(self, session: str) -> Path:
        """The folder of a session.

        Raises:
            InvalidInput: The session does not exist.
        """
        if session not in self.sessions():
            raise InvalidInput(f"there is no session '{session}'")
        return self.root / session

    def survey(self, session: str) -> SurveyedSession:
        """A session with its trials and their problems."""
        folder = self.folder(session)
        with self._surveying:
            return survey_session(folder, self._surveyed, self.root, self.recordings(session))

    def plan(self, session: str) -> Plan:
        """The work for a session, as ``mbkf batch`` plans it.

        Raises:
            InvalidInput: The session has no moving trial.
            SeveralPersons: Its folder holds captures of several persons.
        """
        return _plan(self._trials(self.folder(session)))

    def plans(self) -> dict[str, Plan | InvalidInput]:
        """The work for each session, or the reason for which it is not ready for a run."""
        trials = self._all_trials()
        found: dict[str, Plan | InvalidInput] = {}
        for name in self.sessions():
            try:
                found[name] = plan = _plan(
                    tuple(one for one in trials if one.path.parent == self.root / name)
                )
            except InvalidInput as error:
                found[name] = error
                continue
            if all(one.fault for one in plan.trials):
                found[name] = InvalidInput(plan.trials[0].fault)
        return found

    def place(self, session: str) -> Path:
        """The folder of a session's results, as for ``mbkf batch``."""
        return self.out / Person(*person_and_session(self.root, self.folder(session))).place

    def stated(self, session: str) -> SessionNotes:
        """The statements of session files about a session, those in folders above included."""
        return stated_of(self.root, self.folder(session))

    def subject(self, session: str) -> Path | None:
        """The subject file of the session, of its run, or of its newest live run; None before there is one."""
        place = self.place(session)
        live = (place / name for name in reversed(self.recordings(session)))
        folders = (self.folder(session), place, *live)
        return next((file for folder in folders if (file := folder / SUBJECT_FILE).is_file()), None)

    def recordings(self, session: str) -> tuple[str, ...]:
        """The names of a session's recorded live runs, in their order."""
        reports = self.place(session).glob(f"*/{LIVE_FILE}")
        return tuple(sorted(one.parent.name for one in reports if (one.parent / SUMMARY_FILE).is_file()))

    def notes(self, session: str) -> SessionNotes:
        """The statements of the session's own file."""
        return current_session(self.folder(session) / SESSION_FILE)

    def change(self, session: str, before: SessionNotes, after: SessionNotes) -> ChangedSession:
        """Lays a change of the statements about a session over its file, field by field.

        Args:
            session: Name of the session.
            before: The statements that the change began from.
            after: The statements with the change.

        Returns:
            The statements now, and the fields that somebody else changed to another value meanwhile.
        """
        return change_session(self.folder(session) / SESSION_FILE, before, after)

    def change_events(
        self,
        session: str,
        trial: str,
        before: tuple[FootEvent, ...] | None,
        after: tuple[FootEvent, ...] | None,
    ) -> ChangedSession:
        """Lays a change of a trial's events by hand over the session's file; None stands for the detected ones.

        Args:
            session: Name of the session.
            trial: Name of the trial.
            before: The events that the change began from.
            after: The events with the change.
        """
        return self.change_trial(session, trial, TrialNotes(events=before), TrialNotes(events=after))

    def change_trial(self, session: str, trial: str, before: TrialNotes, after: TrialNotes) -> ChangedSession:
        """Lays a change of the statements about a trial over the session's file.

        Args:
            session: Name of the session.
            trial: Name of the trial.
            before: The statements that the change began from.
            after: The statements with the change.
        """
        old, new = (SessionNotes(trials={trial: notes}) for notes in (before, after))
        return self.change(session, old, new)

    def putting(self, name: str, size: int | None = None) -> AbstractContextManager[BinaryIO]:
        """Opens a file for the content of one that is dropped on the page (:func:`mbkf.app.uploads.putting`)."""
        return putting(self.root, name, size)

    def result(self, session: str, trial: str) -> Path:
        """The folder of a trial's results.

        Raises:
            InvalidInput: The trial has no results.
        """
        if trial in self.recordings(session):
            return self.place(session) / trial
        return self.out / self.trial(session, trial).place

    def trial(self, session: str, trial: str) -> Trial:
        """A trial that has results, as ``mbkf batch`` would plan it now.

        Raises:
            InvalidInput: The trial has no results.
        """
        for one in self._with_results(session):
            if one.path.stem == trial:
                return one
        raise InvalidInput(f"there is no result of '{trial}' yet")

    def with_results(self, session: str) -> tuple[str, ...]:
        """Names of the trials of a session that have results."""
        return tuple(one.path.stem for one in self._with_results(session))

    def _with_results(self, session: str) -> list[Trial]:
        trials = self._trials(self.folder(session))
        return [one for one in trials if (self.out / one.place / SUMMARY_FILE).is_file()]

    def events(self, session: str, trial: str) -> tuple[FootEvent, ...] | None:
        """The events by hand of a trial or recording; None without."""
        return self.notes(session).trial(trial).events

    def results(self, session: str) -> list[Path]:
        """The folders of a session's results: of each trial that is done and not left out, and of live runs.

        Raises:
            InvalidInput: The session has no result.
        """
        place = self.place(session)
        done = [self.out / one.place for one in self._with_results(session)]
        done += [place / name for name in self.recordings(session)]
        if not done:
            raise InvalidInput(f"session '{session}' has no result yet; run it first")
        return done

    def _trials(self, folder: Path) -> tuple[Trial, ...]:
        """The moving trials of a session's folder that are not left out."""
        return tuple(one for one in self._all_trials() if one.path.parent == folder)

    def _all_trials(self) -> tuple[Trial, ...]:
        try:
            return plan_of_folder(self.root).trials
        except InvalidInput:  # there are standing trials only
            return ()

    def _surveyed(self, path: Path, forces: Path | None) -> SurveyedTrial:
        stamp = tuple((s.st_size, s.st_mtime_ns) for s in (file.stat() for file in (path, forces) if file))
        cached = self._cached.get(path)
        if cached is None or cached[0] != stamp:
            cached = self._cached[path] = stamp, survey_trial(path, forces)
        return cached[1]


def _plan(trials: tuple[Trial, ...]) -> Plan:
    """The plan of the moving trials of a session.

    Raises:
        InvalidInput: There are none.
        SeveralPersons: They are of several persons.
    """
    if not trials:
        raise InvalidInput("the session has no moving trial to reconstruct")
    return of_one_person(Plan(trials))
