"""Plan of a batch: the persons of each session, and their trials."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from mbkf.errors import InvalidInput
from mbkf.io.session import FootEvent
from mbkf.study.scaling.rounds import rounds

FORBIDDEN = re.compile(r'[/\\:*?"<>|\x00-\x1f]')
"""Characters that some system refuses in a folder's name."""


class Files(NamedTuple):
    """A capture, and the ground reactions beside it (None: those of the capture itself)."""

    path: Path
    forces: Path | None = None


def scaling_candidates(moving: Sequence[Files]) -> tuple[Files, ...]:
    """The trials that may be read to scale a person, in an order that follows from their names.

    Args:
        moving: All trials but those known as standing ones.
    """
    names = trial_names(moving)
    return tuple(names[name] for one in rounds(tuple(names)) for name in one)


def trial_names(trials: Sequence[Files]) -> dict[str, Files]:
    """Trials by name: that of the file, with its folder where two files are called alike."""
    counts = Counter(one.path.stem for one in trials)
    return {one.path.stem if counts[one.path.stem] == 1 else one.path.as_posix(): one for one in trials}


@dataclass(frozen=True)
class Person:
    """A person in one session, who is scaled once.

    Attributes:
        name: The person's name or code.
        session: Name of the session; empty for a person with one.
        statics: Standing trials; the first one is used.
        moving: Moving trials to scale from, of which some are chosen (:func:`scaling_candidates`); where no standing
            trial is known, some may be standing ones.
        mass_kg: Body mass; None: as stated in the captures, else by their plates.
        height_m: Body height; None: unknown.
        protocol: Marker protocol; None: recognised by the names.
        subject: A subject file to take instead of scaling.
        static_only: True: scaled from the standing trial alone, where there is one.
        remarks: Doubts about the person that follow from the folder or list.
        unsorted: Captures of several persons, perhaps, which only their markers separate
            (:mod:`mbkf.study.batch.sorting`); empty where names, a list or a single standing trial show the person.
        hosts: Other persons of the folder, to whom these captures may belong.
        listed: True where a list names the person, so that no trial is refused as another person's.
    """

    name: str
    session: str = ""
    statics: tuple[Path, ...] = ()
    moving: tuple[Files, ...] = ()
    mass_kg: float | None = None
    height_m: float | None = None
    protocol: str | None = None
    subject: Path | None = None
    static_only: bool = False
    remarks: tuple[str, ...] = ()
    unsorted: tuple[Files, ...] = ()
    hosts: tuple[Person, ...] = ()
    listed: bool = False

    @property
    def place(self) -> Path:
        """Where the person's results stand in the batch's folder."""
        return Path(self.name, self.session) if self.session else Path(self.name)


@dataclass(frozen=True)
class Trial:
    """One trial of a person.

    Attributes:
        person: Whose it is.
        path: The capture.
        forces: Ground reactions beside it; None: those of the capture itself.
        name: Its folder's name among the person's trials.
        events: Strikes and toe-offs set by a person; None: those that are found.
        fault: Reason for which it cannot be done, such as a damaged row; empty without.
        condition: Condition of walking, as stated; empty without.
    """

    person: Person
    path: Path
    forces: Path | None = None
    name: str = ""
    events: tuple[FootEvent, ...] | None = None
    fault: str = ""
    condition: str = ""

    @property
    def place(self) -> Path:
        """Where its results stand in the batch's folder."""
        return self.person.place / (self.name or self.path.stem)


@dataclass(frozen=True)
class Sorted:
    """Captures sorted by their movements.

    Attributes:
        persons: The owner of each capture that has one.
        faults: The reason of each other one.
    """

    persons: Mapping[Path, Person]
    faults: Mapping[Path, str]


@dataclass(frozen=True)
class Plan:
    """All trials of a batch, and with them the persons.

    Attributes:
        trials: The trials.
        notes: Remarks on the list or folder, such as a decimal comma that was read.
    """

    trials: tuple[Trial, ...]
    notes: tuple[str, ...] = ()

    @property
    def persons(self) -> tuple[Person, ...]:
        """Those whose trials can be done, in their order."""
        return tuple(dict.fromkeys(trial.person for trial in self.trials if not trial.fault))

    def from_standing(self) -> Plan:
        """The same with all persons scaled from their standing trials alone."""
        return Plan(
            tuple(replace(one, person=replace(one.person, static_only=True)) for one in self.trials),
            self.notes,
        )

    def with_persons(self, sorted_: Mapping[Person, Sorted | str]) -> Plan:
        """Replaces the persons of sorted captures; a capture without an owner gets the reason as its fault.

        Args:
            sorted_: By person, the owners of the captures, or a reason why they could not be compared.
        """
        trials = [_with_owner(one, sorted_.get(one.person)) for one in self.trials]
        return planned(trials, "the captures", self.notes)

    def shard(self, number: int, count: int) -> Plan:
        """Every ``count``-th trial, from the ``number``-th (from 1) on.

        Raises:
            InvalidInput: The shard does not exist.
        """
        if not 1 <= number <= count:
            raise InvalidInput(f"shard {number}/{count} does not exist; give 1/{count} to {count}/{count}")
        return Plan(self.trials[number - 1 :: count], self.notes)


def folder_name(name: str) -> str:
    """A name as a folder may have it: characters that cannot stand in one become a low line."""
    found = FORBIDDEN.sub("_", name)
    return f"_{found}" if found in {"", ".", ".."} else found


def planned(trials: Sequence[Trial], where: str, notes: Sequence[str] = ()) -> Plan:
    """The plan of trials, each in a place of its own; one whose place is taken has that as its fault.

    Args:
        trials: They.
        where: File or folder that they were read from, for messages.
        notes: Remarks on the reading.

    Raises:
        InvalidInput: The plan is empty.
    """
    if not trials:
        raise InvalidInput(
            f"{where}: no trial was found; mbkf batch --help describes the contents of a folder or list"
        )
    places: dict[Path, Trial] = {}
    found, remarks = [], list(notes)
    for trial in map(partial(_placeable, where), trials):
        other = None if trial.fault else places.get(trial.place)
        if other is None:
            found.append(trial)
            if not trial.fault:
                places[trial.place] = trial
        elif _same(trial, other):
            remarks.append(f"{where}: {trial.path.name} of {trial.person.name} stands twice and is done once")
        else:
            files = (trial.path, other.path) if trial.path != other.path else (trial.place, "itself")
            reason = f"{where}: {files[0]} and {files[1]} would both be written to {trial.place}; give one another name"
            found.append(replace(trial, fault=reason))
    return Plan(tuple(found), tuple(remarks))


def _with_owner(trial: Trial, captures: Sorted | str | None) -> Trial:
    """A trial with its person among sorted captures; as it is where these are None."""
    if captures is None or trial.fault:
        return trial
    if isinstance(captures, str):
        return replace(trial, fault=captures)
    person = captures.persons.get(trial.path, replace(trial.person, unsorted=(), hosts=()))
    return replace(trial, person=person, fault=captures.faults.get(trial.path, ""))


def _same(one: Trial, other: Trial) -> bool:
    """True for two rows that state the same trial."""
    return (one.path, one.forces, one.person) == (other.path, other.forces, other.person)


def _placeable(where: str, trial: Trial) -> Trial:
    """A trial whose names can be folders'; one with other names gets possible ones and has that as its fault."""
    names = (trial.person.name, trial.person.session, trial.name)
    wrong = next((name for name in names if name in {".", ".."} or FORBIDDEN.search(name)), None)
    if wrong is None:
        return trial
    person = replace(
        trial.person, name=folder_name(names[0]), session=folder_name(names[1]) if names[1] else ""
    )
    fault = trial.fault or f"{where}: '{wrong}' cannot be a folder's name"
    return replace(trial, person=person, name=folder_name(names[2]) if names[2] else "", fault=fault)
