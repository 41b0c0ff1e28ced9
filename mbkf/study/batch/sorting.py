"""Captures whose person nothing states, sorted by their movements into persons and sessions.

Each capture is compared with reference captures (:mod:`mbkf.study.scaling.owner`): standing trials, or without any the
first moving one of each person. A trial that belongs to no standing trial fails with the numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from mbkf.conventions import StageCallback
from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.scaling.records import ScalingSettings
from mbkf.study.batch.naming import is_nameless
from mbkf.study.batch.other_person import ANEW, REMEDY
from mbkf.study.batch.plan import Files, Person, Sorted, folder_name, scaling_candidates
from mbkf.study.batch.progress import ignored
from mbkf.study.scaling.owner import Bones, Owner, Reference, bones, few_frames, owner_of
from mbkf.study.scaling.session import MOVING_FRAMES, STANDING_FRAMES
from mbkf.trial.protocol.standing import stands_still
from mbkf.trial.scale import scale
from mbkf.trial.weighing import PROVISIONAL_KG

STAGE = "Comparing captures"

MOST_LISTED = 3
"""Trials of a group that a message names."""


@dataclass
class _Group:
    """Captures with the markers of one reference.

    Attributes:
        reference: The capture that the others are compared with, and its body.
        look: A few frames of it.
        stands: True for a standing trial.
        host: The person that names or statements of files show; None where only movements do.
        statics: Standing trials.
        trials: Moving trials.
        remarks: Trials whose markers were put on anew.
    """

    reference: Reference
    look: Capture
    stands: bool
    host: Person | None = None
    statics: list[Path] = field(default_factory=list)
    trials: list[Files] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)

    @property
    def label(self) -> str:
        """The name of the reference capture, for folders and messages."""
        return Path(self.reference.name).stem


def sorted_captures(
    person: Person, read: Callable[..., Capture] | None = None, progress: StageCallback = ignored
) -> Sorted:
    """Sorts captures whose person nothing states: their persons, and the reasons for captures without an owner.

    Args:
        person: The person as the folder shows it, with the captures in ``unsorted``.
        read: Reads a capture, as :func:`mbkf.read_capture` does.
        progress: Called with the stage, captures done and captures in all.
    """
    sorting = _Sorting(person, read or read_capture)
    for host in person.hosts:
        first = (*host.statics[:1], *(one.path for one in host.moving[:1]))[0]
        sorting.reference(first, sorting.look(first), bool(host.statics), host)
    for path in person.statics:
        sorting.standing(path, sorting.look(path))
    looks = {}
    for number, files in enumerate(person.unsorted):
        progress(STAGE, number, len(person.unsorted))
        looks[files.path] = sorting.look(files.path)
    for path, look in looks.items():
        if isinstance(look, Capture) and stands_still(look.markers):
            sorting.standing(path, look, moves=True)
    for files in person.unsorted:
        sorting.trial(files, looks[files.path])
    return sorting.result()


def one_person(person: Person, read: Callable[..., Capture] | None = None) -> Person:
    """The person of a folder whose captures are all one person's.

    Args:
        person: The person as the folder shows it, with the captures in ``unsorted``.
        read: Reads a capture, as :func:`mbkf.read_capture` does.

    Raises:
        InvalidInput: The markers show several persons, or were put on anew.
    """
    found = sorted_captures(person, read).persons.values()
    owners = {one.place: one for one in found}
    if len(owners) > 1:
        groups = next(iter(found)).remarks[len(person.remarks)]
        raise InvalidInput(f"{groups}; {REMEDY}")
    return next(iter(found), replace(person, unsorted=()))


class _Sorting:
    """Groups that grow capture by capture.

    Args:
        person: Whose captures are sorted.
        read: Reads a capture.
    """

    def __init__(self, person: Person, read: Callable[..., Capture]) -> None:
        self._person, self._read = person, read
        self._open: dict[Path, str] = {}
        self._faults: dict[Path, str] = {}
        self.groups: list[_Group] = []

    def look(self, path: Path) -> Capture | str:
        """A few frames of a capture, without plates; a reason where it cannot be compared."""
        try:
            capture = self._read(path)
        except (MbkfError, OSError) as error:
            return str(error)
        if is_nameless(capture) or not capture.markers.present.any():
            return f"{path.name}: without names of markers it cannot be compared with the standing trials; {REMEDY}"
        return few_frames(capture)

    def reference(
        self, path: Path, look: Capture | str, standing: bool, host: Person | None = None
    ) -> _Group | None:
        """A new group with a capture as its reference; None where it gives no body."""
        if isinstance(look, str):
            return None
        static, trials, frames = (look, [], STANDING_FRAMES) if standing else (None, [look], MOVING_FRAMES)
        try:
            subject = scale(
                static,
                trials,
                mass_kg=PROVISIONAL_KG,
                protocol=self._person.protocol,
                settings=ScalingSettings(frames_per_trial=frames),
            )
            group = _Group(Reference(path.name, subject, look), look, standing, host)
        except MbkfError:
            return None
        self.groups.append(group)
        return group

    def standing(self, path: Path, look: Capture | str, moves: bool = False) -> None:
        """Adds a standing trial: to the group whose markers are where it has them, else as a new one.

        Args:
            path: The capture.
            look: A few frames of it.
            moves: True where it is one of the trials, too.
        """
        group = None
        if isinstance(look, Capture):
            owner = owner_of(look, self._references, places_alone=True)
            group = self._group(owner) or self.reference(path, look, standing=True)
        if group is not None and group.host is None and not moves:
            group.statics.append(path)

    def trial(self, files: Files, look: Capture | str) -> None:
        """Adds a trial to the group that it belongs to.

        A trial without a group is refused where a standing trial has markers to compare it with; else it is the first
        one of a new group.

        Args:
            files: The trial.
            look: A few frames of it.
        """
        if isinstance(look, str):
            self._open[files.path] = look
            return
        owner = owner_of(look, self._references)
        group = self._group(owner)
        standing = [one.reference for one in self.groups if one.stands]
        stood = group is None and owner_of(look, standing) is not None
        if group is None and not stood:
            group = self.reference(files.path, look, standing=False)
        if group is not None:
            group.trials.append(files)
            if owner is not None and owner.number is not None and owner.found:
                group.remarks.append(f"{files.path.name}: {ANEW}: {owner.found}")
        elif owner is not None and stood:
            self._faults[files.path] = f"{files.path.name}: {owner.found}; {REMEDY}"
        else:
            self._open[files.path] = f"{files.path.name}: its markers fit no body; {REMEDY}"

    def result(self) -> Sorted:
        """The persons of the captures, and the reasons for captures without an owner."""
        plain = replace(self._person, unsorted=(), hosts=())
        found = [group for group in self.groups if group.trials]
        own = [group for group in found if group.host is None]
        if not found:
            kept = dict.fromkeys(self._open, plain)
            return Sorted(kept, self._faults)
        persons = dict(zip(map(id, own), _persons(plain, own), strict=True))
        owners = {files.path: group.host or persons[id(group)] for group in found for files in group.trials}
        if len(found) == 1 and found[0].host is None:
            owners |= dict.fromkeys(self._open, persons[id(own[0])])
            return Sorted(owners, self._faults)
        return Sorted(owners, {**self._faults, **self._open})

    @property
    def _references(self) -> list[Reference]:
        return [group.reference for group in self.groups]

    def _group(self, owner: Owner | None) -> _Group | None:
        return None if owner is None or owner.number is None else self.groups[owner.number]


def _persons(person: Person, groups: list[_Group]) -> list[Person]:
    """A person for each group; groups of one person, by lengths of bones, are sessions of one name."""
    if len(groups) == 1:
        (one,) = groups
        statics = dict.fromkeys((*one.statics, *person.statics))
        moving = scaling_candidates(one.trials)
        remarks = (*person.remarks, *one.remarks)
        return [replace(person, statics=tuple(statics), moving=moving, remarks=remarks)]
    same: list[list[_Group]] = []
    are_open = False
    for group in groups:
        found_bones = [bones(group.look, one[0].reference) for one in same]
        if Bones.AGREE in found_bones:
            same[found_bones.index(Bones.AGREE)].append(group)
        else:
            same.append([group])
            are_open |= Bones.OPEN in found_bones
    found = {}
    for groups_of_one in same:
        several = len(groups_of_one) > 1
        name = person.name if len(same) == 1 else folder_name(f"{person.name}-{groups_of_one[0].label}")
        for group in groups_of_one:
            session = "-".join(part for part in (person.session, group.label if several else "") if part)
            found[id(group)] = replace(
                person,
                name=name,
                session=folder_name(session) if session else "",
                statics=tuple(group.statics),
                moving=scaling_candidates(group.trials),
                mass_kg=person.mass_kg if len(same) == 1 else None,
                height_m=person.height_m if len(same) == 1 else None,
                remarks=(*person.remarks, _words(person, same, group, are_open), *group.remarks),
            )
    return [found[id(group)] for group in groups]


def _words(person: Person, same: list[list[_Group]], group: _Group, are_open: bool) -> str:
    """The remark on captures of several persons or sessions."""
    listed = "; ".join(" and ".join(map(_listed, groups)) for groups in same)
    if len(same) == 1:
        return (
            f"the markers were put on anew between {listed}, and lengths of bones agree: each session is scaled from "
            "its own captures"
        )
    mass = "" if person.mass_kg is None else "; the mass in session.toml is not used"
    by = "" if group.stands else ", moving ones: no standing trial has its markers"
    or_one = ", or one with markers put on anew (lengths of bones leave it open)" if are_open else ""
    return (
        f"the markers show {len(same)} persons{or_one}: {listed}{mass}. This one is scaled from the captures of "
        f"{group.label}{by}; if they are one person's, name them in a list"
    )


def _listed(group: _Group) -> str:
    """A group by its reference and the first of its trials."""
    names = [files.path.stem for files in group.trials]
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return f"{group.label} ({', '.join(names[:MOST_LISTED])}{more})"
