"""Persons and trials gathered from the rows of a list; a wrong row or person costs only its own trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.study.batch.plan import Files, Person, Plan, Trial, planned, scaling_candidates

Key = tuple[str, str]
"""Name of a person, and of a session."""


class Listing:
    """What a list states, in its order.

    Args:
        file: The list.
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        self._persons: dict[Key, Person] = {}
        self._stated: dict[tuple[Key, str], int | None] = {}
        self._faults: dict[Key, str] = {}
        self._trials: list[tuple[Key, Trial]] = []
        self.notes: list[str] = []

    def person(self, key: Key, stated: Mapping[str, object], line: int | None) -> None:
        """Completes a person by statements; one that contradicts an earlier statement costs the person's trials.

        Args:
            key: Name and session.
            stated: Fields of a :class:`~mbkf.study.batch.plan.Person`.
            line: Line of the statements.
        """
        person = self._persons.get(key, Person(*key, listed=True))
        for name, value in stated.items():
            before, where = getattr(person, name), self._stated.get((key, name))
            if (key, name) in self._stated and before != value:
                earlier = "before" if where is None else f"in line {where}"
                reason = f"{name} of {key[0]} is {value} here and {before} {earlier}; keep one of both"
                self._faults.setdefault(key, str(FileFormatError(self.file, reason, line)))
                continue
            person = replace(person, **{name: value})  # type: ignore[arg-type]
            self._stated.setdefault((key, name), line)
        self._persons[key] = person

    def static(self, key: Key, path: Path) -> None:
        """Adds a standing trial of a person."""
        person = self._persons[key]
        if path not in person.statics:
            self._persons[key] = replace(person, statics=(*person.statics, path))

    def trial(self, key: Key, files: Files, name: str) -> None:
        """Adds a trial of a person.

        Args:
            key: Name and session of the person.
            files: Its capture, and the ground reactions beside it.
            name: Its name.
        """
        person = self._persons[key]
        self._trials.append((key, Trial(Person(*key), files.path, files.forces, name)))
        self._persons[key] = replace(person, moving=(*person.moving, files))

    def lose(self, key: Key, name: str, path: Path, error: FileFormatError) -> None:
        """Adds a trial that cannot be done.

        Args:
            key: Name and session of its person, as far as they are known.
            name: Its name, or that of its row.
            path: Its capture, or the list where that is not known.
            error: The reason.
        """
        self._trials.append((key, Trial(Person(*key), path, None, name, fault=str(error))))

    def lose_person(self, key: Key, error: FileFormatError) -> None:
        """Fails all trials of a person."""
        self._faults.setdefault(key, str(error))

    def plan(self) -> Plan:
        """The plan of all trials.

        Raises:
            InvalidInput: The list names no trial.
        """
        trials = []
        persons = {
            key: replace(one, moving=scaling_candidates(tuple(dict.fromkeys(one.moving))))
            for key, one in self._persons.items()
        }
        for key, trial in self._trials:
            fault = trial.fault or self._faults.get(key, "")
            person = trial.person if trial.fault else persons[key]
            trials.append(replace(trial, person=person, fault=fault))
        return planned(trials, str(self.file), self.notes)
