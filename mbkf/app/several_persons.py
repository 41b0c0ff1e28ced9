"""Captures of several persons in the folder of one session: refused for a run, and copied into a folder of each."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from mbkf.app.uploads import putting
from mbkf.errors import InvalidInput
from mbkf.io.files_read import opened
from mbkf.io.session import SESSION_FILE, SessionNotes
from mbkf.io.session_change import change_session, current_session
from mbkf.study.batch.plan import Plan, Trial


class SeveralPersons(InvalidInput):
    """Names, statements or movements show several persons, or markers that were put on anew.

    Attributes:
        files: Names of the captures and their forces, by the place of the person and session.
    """

    def __init__(self, trials: Mapping[Path, Sequence[Trial]]) -> None:
        files = {
            place: sorted({path.name for one in own for path in _files(one)}) for place, own in trials.items()
        }
        self.files = {place.as_posix(): names for place, names in files.items() if names}
        listed = "; ".join(
            f"{place.as_posix()}: {', '.join(one.path.stem for one in own)}" for place, own in trials.items()
        )
        super().__init__(
            f"the session's folder holds captures of several persons or sessions ({listed}): put each into a folder of "
            "its own, or leave the others' trials out"
        )


def _files(trial: Trial) -> list[Path]:
    """A trial's files and the standing trials of its person; empty where the trial's person is unknown."""
    if trial.fault:
        return []
    return [trial.path, *([trial.forces] if trial.forces else []), *trial.person.statics]


def of_one_person(plan: Plan) -> Plan:
    """The plan of a session, which is that of one person with markers put on once.

    Args:
        plan: The plan.

    Raises:
        SeveralPersons: It is not.
    """
    trials: dict[Path, list[Trial]] = {}
    for trial in plan.trials:
        trials.setdefault(trial.person.place, []).append(trial)
    if len(trials) > 1:
        raise SeveralPersons(trials)
    return plan


def separate(root: Path, folder: Path, files: Mapping[str, Sequence[str]]) -> None:
    """Copies the captures of each person into a folder of its own, with the statements about them.

    Masses, heights and names of the session are left out: they could be anybody's. Files that are there already are
    not replaced.

    Args:
        root: The page's folder.
        folder: The session's folder, whose files stay.
        files: Names of files in it, by the place of person and session in the page's folder.

    Raises:
        Refused: A file of the same name with another content is there.
        InvalidInput: A file is not in the session's folder, or cannot be placed there.
        OSError: A file cannot be read or written.
    """
    notes = current_session(folder / SESSION_FILE)
    present = {path.name for path in folder.iterdir() if path.is_file()}
    if missing := sorted({name for names in files.values() for name in names} - present):
        raise InvalidInput(f"the session's folder does not hold {', '.join(missing)}; run the session again")
    marker_set = present & {notes.protocol}
    for place, names in files.items():
        for name in (*names, *marker_set):
            with opened(folder / name) as content, putting(root, f"{place}/{name}") as copy:
                shutil.copyfileobj(content, copy)
        trials = {Path(name).stem for name in names}
        own = {trial: one for trial, one in notes.trials.items() if trial in trials}
        stated = SessionNotes(protocol=notes.protocol, scaling=notes.scaling, trials=own)
        change_session(root / place / SESSION_FILE, SessionNotes(), stated)
