"""The folder that a page works in: its sessions, what they hold, and where their results lie.

A folder with captures is a session. A session goes by its path in the folder, "." for the folder itself. Results lie in
``results`` beside the sessions, as ``mbkf batch`` puts them there.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from mbkf.errors import InvalidInput
from mbkf.io.atomic import replacing
from mbkf.io.results_folder import SUMMARY_FILE
from mbkf.io.session import SESSION_FILE, FootEvent, SessionNotes, read_session, write_session
from mbkf.stream.run.report import LIVE_FILE
from mbkf.study.batch.folder import (
    SUBJECT_FILE,
    person_and_session,
    plan_of_folder,
    session_folders,
    stated_of,
)
from mbkf.study.batch.plan import FORBIDDEN, Person, Plan, Trial
from mbkf.study.survey.session import SurveyedSession, survey_session
from mbkf.study.survey.trial import SurveyedTrial, survey_trial

RESULTS = "results"
"""Folder of the results in the page's folder."""

MOST_DEEP = 4
"""Folders in folders that may be made for what is dropped on the page."""


@dataclass(frozen=True)
class _Seen:
    """A capture as it was when it was looked at: sizes and times of its files."""

    stamp: tuple[tuple[int, int], ...]
    trial: SurveyedTrial


class Workspace:
    """Sessions of a folder; what was looked at once is remembered until the files change.

    Attributes:
        root: The folder.
        out: Where results are put.
    """

    def __init__(self, root: Path) -> None:
        """Args: the folder; made where missing."""
        self.root = root.absolute()
        self.root.mkdir(parents=True, exist_ok=True)
        self.out = self.root / RESULTS
        self._seen: dict[Path, _Seen] = {}
        self._looking, self._noting = threading.Lock(), threading.Lock()

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

    def look(self, session: str) -> SurveyedSession:
        """A session, looked at.

        Raises:
            InvalidInput: The session does not exist.
            FileFormatError: Its session file is damaged.
        """
        folder = self.folder(session)
        with self._looking:
            return survey_session(folder, self._surveyed, self.root)

    def plan(self, session: str) -> Plan:
        """What is to be done for a session, as ``mbkf batch`` would do it.

        Raises:
            InvalidInput: The session does not exist, or no trial to be done.
        """
        trials = self._trials(self.folder(session))
        if not trials:
            raise InvalidInput("there is no moving trial to be done")
        return Plan(trials)

    def place(self, session: str) -> Path:
        """The folder of a session's results, as ``mbkf batch`` has it.

        Raises:
            InvalidInput: The session does not exist.
        """
        return self.out / Person(*person_and_session(self.root, self.folder(session))).place

    def stated(self, session: str) -> SessionNotes:
        """What session files state of a session, those above it included.

        Raises:
            InvalidInput: The session does not exist.
            FileFormatError: One is damaged.
        """
        return stated_of(self.root, self.folder(session))

    def subject(self, session: str) -> Path | None:
        """The file of the session's scaled person: the session's own, that of a run, or of the newest live run.

        None before there is one.

        Raises:
            InvalidInput: The session does not exist.
        """
        place = self.place(session)
        folders = (
            self.folder(session),
            place,
            *(place / name for name in reversed(self.recordings(session))),
        )
        return next((file for folder in folders if (file := folder / SUBJECT_FILE).is_file()), None)

    def recordings(self, session: str) -> tuple[str, ...]:
        """The names of a session's recorded live runs, in their order.

        Raises:
            InvalidInput: The session does not exist.
        """
        reports = self.place(session).glob(f"*/{LIVE_FILE}")
        return tuple(sorted(one.parent.name for one in reports if (one.parent / SUMMARY_FILE).is_file()))

    def note(self, session: str, notes: SessionNotes) -> None:
        """Writes what is stated of a session; events of trials stay as they are (:meth:`note_events`).

        Raises:
            InvalidInput: The session does not exist.
            FileFormatError: Its session file is damaged.
            OSError: It cannot be written.
        """
        with self._noting:
            kept = {name: one.events for name, one in self._notes(session).trials.items()}
            names = dict.fromkeys([*notes.trials, *kept])
            trials = {name: replace(notes.trial(name), events=kept.get(name)) for name in names}
            stated = {
                name: one for name, one in trials.items() if name in notes.trials or one.events is not None
            }
            write_session(replace(notes, trials=stated), self.folder(session) / SESSION_FILE)

    def note_events(self, session: str, trial: str, events: tuple[FootEvent, ...] | None) -> None:
        """Writes the events by hand of a trial; all else that is stated stays.

        Args:
            session: Which session.
            trial: Which of its trials.
            events: They; None for those that are found.

        Raises:
            InvalidInput: The session does not exist.
            FileFormatError: Its session file is damaged.
            OSError: It cannot be written.
        """
        with self._noting:
            notes = self._notes(session)
            trials = {**notes.trials, trial: replace(notes.trial(trial), events=events)}
            write_session(replace(notes, trials=trials), self.folder(session) / SESSION_FILE)

    @contextmanager
    def putting(self, name: str) -> Iterator[BinaryIO]:
        """Takes a file that is dropped on the page; it is there when the block ends without an error.

        Args:
            name: Its path in the folder, with slashes; missing folders are made.

        Yields:
            Where to write what it holds.

        Raises:
            InvalidInput: The path leads out of the folder, or cannot be one.
            OSError: It cannot be written.
        """
        parts = PurePosixPath(name).parts
        if not 1 <= len(parts) <= MOST_DEEP + 1 or any(_is_bad(part) for part in parts):
            raise InvalidInput(f"'{name[:80]}' cannot be a file here")
        target = self.root.joinpath(*parts)
        if not target.parent.resolve().is_relative_to(self.root.resolve()):
            raise InvalidInput(f"'{name[:80]}' leads out of the folder")
        with replacing(target) as partial, partial.open("wb") as file:
            yield file

    def result(self, session: str, trial: str) -> Path:
        """The folder of a trial's results.

        Raises:
            InvalidInput: There are none.
        """
        if trial in self.recordings(session):
            return self.place(session) / trial
        return self.out / self.trial(session, trial).place

    def trial(self, session: str, trial: str) -> Trial:
        """A trial that has results, as ``mbkf batch`` would do it now.

        Raises:
            InvalidInput: It has none.
        """
        for one in self._with_results(session):
            if one.path.stem == trial:
                return one
        raise InvalidInput(f"there is no result of '{trial}' yet")

    def with_results(self, session: str) -> tuple[str, ...]:
        """Names of the trials of a session that have results.

        Raises:
            InvalidInput: The session does not exist.
        """
        return tuple(one.path.stem for one in self._with_results(session))

    def _with_results(self, session: str) -> list[Trial]:
        trials = self._trials(self.folder(session))
        return [one for one in trials if (self.out / one.place / SUMMARY_FILE).is_file()]

    def events(self, session: str, trial: str) -> tuple[FootEvent, ...] | None:
        """The events by hand of a trial or recording; None for those that are found.

        Raises:
            InvalidInput: The session does not exist.
            FileFormatError: Its session file is damaged.
        """
        return self._notes(session).trial(trial).events

    def _notes(self, session: str) -> SessionNotes:
        """What the session's own file states."""
        file = self.folder(session) / SESSION_FILE
        return read_session(file) if file.is_file() else SessionNotes()

    def results(self, session: str) -> list[Path]:
        """The folders of a session's results: of each trial that is done and not left out, and of live runs.

        Raises:
            InvalidInput: The session does not exist, or no result.
        """
        place = self.place(session)
        done = [self.out / one.place for one in self._with_results(session)]
        done += [place / name for name in self.recordings(session)]
        if not done:
            raise InvalidInput(f"nothing of '{session}' is done yet; run it first")
        return done

    def _trials(self, folder: Path) -> tuple[Trial, ...]:
        """The moving trials of a session's folder that are not left out."""
        try:
            return tuple(one for one in plan_of_folder(self.root).trials if one.path.parent == folder)
        except InvalidInput:  # there are standing ones only
            return ()

    def _surveyed(self, path: Path, forces: Path | None) -> SurveyedTrial:
        stamp = tuple((s.st_size, s.st_mtime_ns) for s in (file.stat() for file in (path, forces) if file))
        seen = self._seen.get(path)
        if seen is None or seen.stamp != stamp:
            seen = self._seen[path] = _Seen(stamp, survey_trial(path, forces))
        return seen.trial


def _is_bad(part: str) -> bool:
    return (
        part in {".", "..", ""}
        or part.startswith(".")
        or FORBIDDEN.search(part) is not None
        or len(part) > 200
    )
