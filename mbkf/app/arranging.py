"""Sessions and trials deleted, renamed and moved on the page; each of these can be undone, and no file is lost.

A trial is its capture, other files of its name, and the ground reactions beside it. Its statements go with it. Its
results name it, so they go into the bin when it gets another name or session; those of a session go with the session.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from mbkf.app.bin import Bin, Move, Moved, Rewritten
from mbkf.app.failures import CONFLICT, NOT_FOUND, Refused
from mbkf.app.live_run import LiveRun
from mbkf.app.runs import Runs
from mbkf.app.uploads import target_of
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.files_read import place_of
from mbkf.io.laboratory import LABORATORY_FILE
from mbkf.io.plain_data import parse_toml
from mbkf.io.session import SESSION_FILE, SessionNotes, TrialNotes, session_of
from mbkf.io.session_change import change_session, current_session
from mbkf.study.batch.folder import SUBJECT_FILE, captures_in, forces_beside, person_and_session
from mbkf.study.batch.plan import Person, folder_name

Plain = dict[str, object]

OF_SESSION = {SESSION_FILE, SUBJECT_FILE, LABORATORY_FILE}
"""Files of a whole session, which a trial of their name does not take along."""


class Arranging:
    """Deletes, renames and moves what a page's folder holds.

    Args:
        workspace: The sessions.
        runs: Their runs.
        live: The live run.
    """

    def __init__(self, workspace: Workspace, runs: Runs, live: LiveRun) -> None:
        self._workspace, self._runs, self._live = workspace, runs, live
        self._bin = Bin(workspace.root, self._restore)

    def listed(self) -> list[Plain]:
        """Everything that can be undone, the newest first."""
        names = ("key", "act", "session", "trial", "to_session", "to_trial", "at_s")
        return [{name: getattr(one, name) for name in names} for one in self._bin.listed()]

    def delete(self, session: str, trial: str = "") -> Plain:
        """Puts a session, or one of its trials, into the bin.

        Raises:
            InvalidInput: It does not exist.
            Refused: A run works with it, or the session holds others.
            OSError: A file cannot be moved.
            FileFormatError: The session file is damaged.
        """
        with self._bin.held():
            self._idle(session)
            key = self._bin.key()
            if trial:
                return self._trial(Moved(key, "delete", session, trial))
            folder = self._whole(session)
            moves = [self._bin.into(key, one) for one in (folder, self._workspace.place(session))]
            return self._carry_out(Moved(key, "delete", session, moves=tuple(moves)))

    def move(self, session: str, trial: str, to_session: str, to_trial: str) -> Plain:
        """Gives a session or a trial another name or place.

        Args:
            session: The session.
            trial: Its trial; empty for the whole session.
            to_session: Session afterwards, which a trial may be the first one of.
            to_trial: Name of the trial afterwards; empty for a session.

        Raises:
            InvalidInput: It does not exist, or the new name is not possible.
            Refused: A run works with it, or the new name is taken.
            OSError: A file cannot be moved.
            FileFormatError: A session file is damaged.
        """
        with self._bin.held():
            self._idle(session)
            key, root, to_session = self._bin.key(), self._workspace.root, to_session.strip()
            if trial:
                return self._trial(Moved(key, "move", session, trial, to_session, to_trial.strip()))
            folder, target = self._whole(session), target_of(root, to_session)
            if target.is_relative_to(folder):
                raise InvalidInput("a session cannot lie in itself; choose another name")
            results = self._workspace.place(session), self._place(target)
            moves = [_move(root, folder, target), _move(root, *results)]
            name = target.relative_to(root).as_posix()
            return self._carry_out(Moved(key, "move", session, to_session=name, moves=tuple(moves)))

    def undo(self, key: str) -> Plain:
        """Takes back a deletion, a change of name or a move.

        Raises:
            Refused: It is undone already, a run works with the session, or a file is in the way.
            OSError: A file cannot be moved.
            FileFormatError: A session file cannot be changed.
        """
        with self._bin.held():
            aside: list[Path] = []
            for one in self._bin.listed():
                if one.key == key:
                    for session in {one.session, one.to_session} - {""}:
                        self._idle(session)
                    aside = self._results(one.to_session, one.to_trial) if one.to_trial else []
            undone = self._bin.undo(key, aside)
            state = undone.state
            if undone.to_session:
                if not undone.trial:  # its results come along, as they are by now
                    state = self._runs.plain_state(undone.to_session)
                self._runs.take(undone.to_session, undone.to_trial)
            if state is not None:
                self._runs.give(undone.session, undone.trial, state)
            return {"session": undone.session, "trial": undone.trial}

    def _carry_out(self, wanted: Moved, rewriting: Iterable[Rewritten] = ()) -> Plain:
        state = self._runs.plain_state(wanted.session, wanted.trial)
        made = self._bin.carry_out(replace(wanted, state=state), rewriting)
        self._runs.take(wanted.session, wanted.trial)
        if state is not None and made.to_session and not made.trial:
            self._runs.give(made.to_session, "", state)
        return {"key": made.key, "session": made.to_session or made.session}

    def _trial(self, wanted: Moved) -> Plain:
        """Deletes or moves a trial with its statements; its results go into the bin."""
        folder = self._workspace.folder(wanted.session)
        results = self._results(wanted.session, wanted.trial)
        into_bin = [self._bin.into(wanted.key, one) for one in results]
        recorded = wanted.trial in self._workspace.recordings(wanted.session)
        if recorded and wanted.act == "move":
            raise InvalidInput("a live recording keeps its name and session")
        files = [] if recorded else _files_of(folder, wanted.trial)
        places = [(folder, wanted.trial, False)]
        if wanted.act == "delete":
            moves = [self._bin.into(wanted.key, one) for one in files]
        else:
            target = self._target_of_trial(wanted, folder)
            name = target.relative_to(self._workspace.root).as_posix()
            wanted = replace(wanted, to_session=name)
            moves = [
                _move(self._workspace.root, one, target / _renamed(one, wanted.trial, wanted.to_trial))
                for one in files
            ]
            places.insert(
                0, (target, wanted.to_trial, True)
            )  # statements stand in one of the files at any moment
        stated = current_session(folder / SESSION_FILE).trial(wanted.trial)
        rewriting = (
            self._restated(place / SESSION_FILE, name, stated, added)
            for place, name, added in places
            if stated != TrialNotes()
        )
        return self._carry_out(replace(wanted, moves=(*moves, *into_bin)), rewriting)

    def _target_of_trial(self, wanted: Moved, folder: Path) -> Path:
        """The folder of a trial's new session.

        Raises:
            InvalidInput: The name is not possible.
            Refused: The session has a trial of this name.
        """
        root = self._workspace.root
        target = folder
        if wanted.to_session not in {wanted.session, "."}:
            target = target_of(root, wanted.to_session)
        elif wanted.to_session == ".":
            target = root
        same = target == folder
        if not wanted.to_trial or "/" in wanted.to_trial:
            raise InvalidInput(f"'{wanted.to_trial}' cannot be the name of a trial")
        target_of(root, wanted.to_trial)
        if not place_of(target).is_relative_to(place_of(root)):
            raise InvalidInput(f"'{wanted.to_session}' leads out of the folder; choose another session")
        if same and wanted.to_trial == wanted.trial:
            raise InvalidInput("the name and the session are as they were; nothing was changed")
        self._idle(target.relative_to(root).as_posix())
        taken = {one.stem.lower() for one in captures_in(target)} if target.is_dir() else set()
        if same:
            taken.discard(wanted.trial.lower())
        if wanted.to_trial.lower() in taken:
            raise Refused(
                CONFLICT,
                f"'{wanted.to_session}' has a trial '{wanted.to_trial}' already",
                "in_the_way",
                wanted.to_trial,
            )
        return target

    def _restated(self, file: Path, name: str, stated: TrialNotes, added: bool) -> Rewritten:
        """Adds statements on a trial to a session file, or takes them away."""
        inside = file.relative_to(self._workspace.root).as_posix()
        before = self._bin.text(inside)
        _change(file, name, stated, added)
        return Rewritten(inside, before, self._bin.text(inside))

    def _restore(self, one: Rewritten) -> None:
        """Takes back the statements on trials that a set of moves changed, in a file that others have changed since."""
        file = self._workspace.root / one.file
        before, after = _notes(one.before, file), _notes(one.after, file)
        if file.parent.is_dir():
            change_session(file, after, before)

    def _results(self, session: str, trial: str) -> list[Path]:
        """The folder of a trial's results; empty without."""
        place = self._place(self._workspace.root / session) / folder_name(trial)
        return [place] if os.path.lexists(place) else []

    def _place(self, folder: Path) -> Path:
        """The place of the results of a folder that is to be a session."""
        return self._workspace.out / Person(*person_and_session(self._workspace.root, folder)).place

    def _whole(self, session: str) -> Path:
        """The folder of a session that can go as a whole.

        Raises:
            InvalidInput: It does not exist.
            Refused: It is the page's folder itself, or holds other sessions.
        """
        folder = self._workspace.folder(session)
        if session == ".":
            raise Refused(
                CONFLICT,
                "these captures lie in the page's own folder; move or delete them one by one",
                "own_folder",
            )
        inside = [name for name in self._workspace.sessions() if name.startswith(f"{session}/")]
        if inside:
            listed = ", ".join(inside)
            raise Refused(
                CONFLICT,
                f"'{session}' holds other sessions ({listed}); move or delete these first",
                "holds",
                listed,
            )
        return folder

    def _idle(self, session: str) -> None:
        """Refuses to touch a session that a run works with.

        Raises:
            Refused: A run works with it.
        """
        live = self._live.state()
        if self._runs.is_busy(session) or (live is not None and live.goes_on and live.session == session):
            raise Refused(CONFLICT, f"'{session}' is being calculated; cancel that first", "busy", session)


def _move(root: Path, source: Path, to: Path) -> Move:
    return source.relative_to(root).as_posix(), to.relative_to(root).as_posix()


def _files_of(folder: Path, trial: str) -> list[Path]:
    """The files of a trial.

    Raises:
        Refused: The session lacks the trial.
    """
    capture = next((one for one in captures_in(folder) if one.stem == trial), None)
    if capture is None:
        raise Refused(NOT_FOUND, f"the session has no trial '{trial}'; load the page again", "gone", trial)
    files = sorted(one for one in folder.iterdir() if one.is_file() and not one.name.startswith("."))
    own = [one for one in files if one.stem.lower() == trial.lower() and one.name not in OF_SESSION]
    forces = forces_beside(capture, files)
    return own if forces is None or forces in own else [*own, forces]


def _renamed(file: Path, old: str, new: str) -> str:
    """The name of a trial's file after its trial has got another name."""
    if file.stem.lower() == old.lower():
        return new + file.suffix
    at = file.stem.lower().find(old.lower())
    stem = f"{new}_forces" if at < 0 else file.stem[:at] + new + file.stem[at + len(old) :]
    return stem + file.suffix


def _change(file: Path, name: str, stated: TrialNotes, added: bool) -> None:
    without, with_ = SessionNotes(), SessionNotes(trials={name: stated})
    change_session(file, *((without, with_) if added else (with_, without)))


def _notes(text: str | None, file: Path) -> SessionNotes:
    """The notes of a session file's text; empty ones without a text."""
    return SessionNotes() if text is None else session_of(parse_toml(text.removeprefix("\ufeff")), file)
