"""Several persons in one capture: by the names of their markers, else by the distances between these.

The word before a colon is a person's (``Anna:LASI``, ``Ben:LASI``) where others carry markers of the same names; a
tool or a second marker set of one person does not. Sides (``L:TOE``, ``R:TOE``) are parts of one person. Else points
that keep near each other make a body (:mod:`mbkf.io.bodies`), and bodies with markers of the same names are persons;
where bodies stand too near to be told apart, affixes of their names do it (:mod:`mbkf.io.name_pairs`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.bodies import Indices, bodies_of, nearest_body
from mbkf.io.labels import unique_labels
from mbkf.io.name_pairs import SIDES, Affix, own_affix, twins, without_number
from mbkf.io.near_others import near_markers, near_remarks
from mbkf.io.records import Capture, MarkerTrajectories

FEWEST_MARKERS, SAME_SHARE = 6, 0.5
"""Markers that a person has at least, and the share of their names that another person's markers have as well."""


@dataclass(frozen=True)
class PersonMarkers:
    """The markers of one of several persons.

    Attributes:
        name: The person's name in the names of the markers; the number in the order of the file where these have none.
        own: Names of the markers without the person's, by their names in the capture, in the order of the file.
    """

    name: str
    own: Mapping[str, str]


def persons_by_prefix(names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """The markers of each person, by the person's name before a colon; empty for fewer than two persons.

    Args:
        names: Names of the capture's markers.
    """
    by_prefix: dict[str, list[str]] = {}
    for name in names:
        prefix, colon, own = name.partition(":")
        if colon and prefix and own and prefix.lower() not in SIDES:
            by_prefix.setdefault(prefix, []).append(name)
    short = {prefix: {name.partition(":")[2] for name in names} for prefix, names in by_prefix.items()}
    found = {}
    for prefix, own_names in by_prefix.items():
        others = (names for other, names in short.items() if other != prefix)
        common = max((len(short[prefix] & names) for names in others), default=0)
        if len(own_names) >= FEWEST_MARKERS and common >= SAME_SHARE * len(own_names):
            found[prefix] = tuple(own_names)
    return found if len(found) > 1 else {}


def named_persons(markers: MarkerTrajectories) -> tuple[PersonMarkers, ...]:
    """The persons that the names of markers tell apart, in the order of the file; empty for fewer than two.

    Args:
        markers: All markers of the capture.
    """
    by_prefix = persons_by_prefix(markers.names)
    if by_prefix:
        return tuple(
            PersonMarkers(person, {name: name.removeprefix(f"{person}:") for name in names})
            for person, names in by_prefix.items()
        )
    found = persons_by_shape(markers)
    if found:
        named = tuple(one for one in found if _has_twin(one, found))
        return named if len(named) > 1 else ()
    parts = twins(markers.names, markers.positions_m)
    if parts is None:
        return ()
    owner = np.array([nearest_body(markers.positions_m, m, parts) for m in range(len(markers.names))])
    for number, part in enumerate(parts):
        owner[part] = number
    return _persons(markers.names, [np.flatnonzero(owner == number) for number in range(len(parts))])


def persons_by_shape(markers: MarkerTrajectories) -> tuple[PersonMarkers, ...]:
    """The bodies that distances between markers show, in the order of the file; empty for fewer than two.

    Args:
        markers: All markers of the capture.
    """
    bodies = bodies_of(markers.positions_m)
    return _persons(markers.names, bodies) if len(bodies) > 1 else ()


def _persons(names: Sequence[str], bodies: Sequence[Indices]) -> tuple[PersonMarkers, ...]:
    """Persons of some columns each, in the order of their first ones, with names without affixes."""
    sets = [[names[m] for m in body] for body in sorted(bodies, key=lambda body: int(body[0]))]
    rest = [[name for other in sets if other is not own for name in other] for own in sets]
    affixes = [own_affix(own, [other for other in sets if other is not own]) for own in sets]
    called = len({affix.word for affix in affixes} - {""}) == len(sets)
    if called:
        sets = [[name for name in names if _owner(name, affixes, sets) == k] for k in range(len(sets))]
    return tuple(
        PersonMarkers(
            affixes[k].word if called else str(k + 1),
            {name: without_number(affixes[k].base(name), own, rest[k]) for name in own},
        )
        for k, own in enumerate(sets)
    )


def _owner(name: str, affixes: Sequence[Affix], sets: Sequence[Sequence[str]]) -> int:
    """Number of the person whose affix a name has, else of the one to whose body it belongs."""
    by_name = [k for k, affix in enumerate(affixes) if affix.on(name)]
    return by_name[0] if len(by_name) == 1 else next(k for k, own in enumerate(sets) if name in own)


def _has_twin(one: PersonMarkers, found: Sequence[PersonMarkers]) -> bool:
    """True where a person's markers have many names of another one's."""
    own = set(one.own.values())
    common = max(len(own & set(other.own.values())) for other in found if other is not one)
    return common >= max(FEWEST_MARKERS, SAME_SHARE * len(own))


def one_person(capture: Capture, person: str | None) -> Capture:
    """The capture with the markers of one of its persons, without the name before or behind them.

    Markers without a person before a colon stay, other markers belong to the nearest person. A stated mass does not
    stay: it could be anybody's. Without a choice the capture stays as it is, with a remark where names show persons.

    Args:
        capture: The capture.
        person: Name of a person, or the number in the order of the file, from 1 on; None for no choice.

    Raises:
        InvalidInput: The capture has no such person.
    """
    found = named_persons(capture.markers)
    if person is None:
        return replace(capture, notes=(*capture.notes, several_persons(found))) if found else capture
    found = found or persons_by_shape(capture.markers)
    by_choice = {str(number): one for number, one in enumerate(found, start=1)}
    by_choice |= {one.name: one for one in found}
    chosen = by_choice.get(person)
    if chosen is None:
        seen = (
            f"its persons are {listed_persons(found)}"
            if found
            else "names and distances of its markers are those of one person"
        )
        raise InvalidInput(f"{capture.path}: person '{person}' is not in this capture; {seen}")
    others = {name for one in found if one is not chosen for name in one.own}
    markers = capture.markers
    kept = [k for k, name in enumerate(markers.names) if name not in others]
    away = [k for k, name in enumerate(markers.names) if name in others]
    notes = [f"person {chosen.name} of {len(found)}; {len(others)} markers of the others are left out"]
    own = [chosen.own.get(markers.names[k], markers.names[k]) for k in kept]
    names = tuple(unique_labels(own, notes))
    if capture.subject_mass_kg is not None:
        notes.append(
            f"the file states one mass for several persons, {capture.subject_mass_kg:.1f} kg: it is not used"
        )
    mine = replace(markers, names=names, positions_m=markers.positions_m[:, kept])
    theirs = markers.select(tuple(markers.names[k] for k in away))
    notes += near_remarks(near_markers(mine, theirs), most=1)
    return replace(capture, subject_mass_kg=None, markers=mine, others=theirs, notes=(*capture.notes, *notes))


def several_persons(found: Sequence[PersonMarkers]) -> str:
    """A sentence that names the persons of a capture and says how to choose one."""
    return (
        f"the markers are those of {len(found)} persons: {listed_persons(found)}; choose one with --person NAME, in "
        "Python read_capture(person=)"
    )


def listed_persons(found: Sequence[PersonMarkers]) -> str:
    """The persons with the numbers of their markers, in words."""
    return ", ".join(f"{one.name} ({len(one.own)} markers)" for one in found)
