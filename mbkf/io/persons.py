"""Several persons in one capture, by the name before each of their markers: ``Anna:LASI``, ``Ben:LASI``.

Persons carry markers of the same names; a tool or a second marker set of one person does not. Sides (``L:TOE``,
``R:TOE``) are parts of one person.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mbkf.errors import InvalidInput
from mbkf.io.labels import unique_labels
from mbkf.io.records import Capture

FEWEST_MARKERS, SAME_SHARE = 6, 0.5
"""Markers that a person has at least, and the share of their names that another person's markers have as well."""

SIDES = frozenset(
    ("l", "r", "left", "right", "lt", "rt", "links", "rechts", "izq", "der", "izquierda", "derecha")
)
"""Words before markers that name a side of the body."""

NEAR_M, NEAR_FRAMES = 0.1, 200
"""Distance of markers of two persons below which they may touch, and the frames in which it is looked at."""


def persons_by_prefix(names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """The markers of each person, by the person's name; empty for fewer than two persons.

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


def check_one_person(capture: Capture) -> None:
    """Refuses a capture of several persons without a choice.

    Raises:
        InvalidInput: It holds several persons.
    """
    if found := persons_by_prefix(capture.markers.names):
        raise InvalidInput(
            f"{capture.path}: the markers are those of {len(found)} persons: {_listed(found)}; choose one with "
            "--person NAME, in Python read_capture(person=)"
        )


def one_person(capture: Capture, person: str | None) -> Capture:
    """The capture with the markers of one of its persons, without the name before them.

    Markers without the name of any person stay, a stated mass does not: it could be anybody's. Without a choice the
    capture stays as it is, with a remark.

    Args:
        capture: The capture.
        person: Name of a person, or the number in the order of the file, from 1 on; None for no choice.

    Raises:
        InvalidInput: The capture has no such person.
    """
    found = persons_by_prefix(capture.markers.names)
    if person is None:
        if not found:
            return capture
        remark = (
            f"the markers are those of {len(found)} persons: {_listed(found)}; choose one (--person NAME)"
        )
        return replace(capture, notes=(*capture.notes, remark))
    by_number = {str(number): name for number, name in enumerate(found, start=1)}
    chosen = person if person in found else by_number.get(person)
    if chosen is None:
        seen = (
            f"its persons are {_listed(found)}"
            if found
            else "the names of its markers are those of one person"
        )
        raise InvalidInput(f"{capture.path}: person '{person}' is not in this capture; {seen}")
    others = {name for prefix, own in found.items() if prefix != chosen for name in own}
    markers = capture.markers
    kept = [k for k, name in enumerate(markers.names) if name not in others]
    notes = [f"person {chosen} of {len(found)}; {len(others)} markers of the others are left out"]
    names = tuple(unique_labels([markers.names[k].removeprefix(f"{chosen}:") for k in kept], notes))
    if capture.subject_mass_kg is not None:
        notes.append(
            f"the file states one mass for several persons, {capture.subject_mass_kg:.1f} kg: it is not used"
        )
    notes += _contact(capture, found, chosen)
    return replace(
        capture,
        subject_mass_kg=None,
        markers=replace(markers, names=names, positions_m=markers.positions_m[:, kept]),
        notes=(*capture.notes, *notes),
    )


def _listed(found: dict[str, tuple[str, ...]]) -> str:
    return ", ".join(f"{name} ({len(own)} markers)" for name, own in found.items())


def _contact(capture: Capture, found: dict[str, tuple[str, ...]], chosen: str) -> list[str]:
    """Remarks on persons who come so near that they may touch, where forces between them are not measured."""
    markers = capture.markers
    step = max(1, -(-markers.frames // NEAR_FRAMES))
    places = {
        name: markers.positions_m[::step, [markers.names.index(one) for one in own]]
        for name, own in found.items()
    }
    remarks = []
    for name, other in places.items():
        if name == chosen:
            continue
        apart = np.linalg.norm(places[chosen][:, :, None] - other[:, None], axis=-1)
        seen = np.isfinite(apart)
        nearest = float(apart[seen].min()) if seen.any() else np.inf
        if nearest < NEAR_M:
            remarks.append(
                f"{name} comes within {1e3 * nearest:.0f} mm of {chosen}: a possible contact, whose forces are not "
                "measured"
            )
    return remarks
