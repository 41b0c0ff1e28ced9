"""Reference bands from sessions of a laboratory's own: each person counts once, however many cycles there are."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.norms import Band, CurveName, GdiBasis, Norms, Span, Speeds
from mbkf.io.session import SessionNotes, read_session
from mbkf.study.session.chosen import chosen_curves
from mbkf.study.session.cycles import ANGLE, Key
from mbkf.study.session.gather import results_in, session_from
from mbkf.study.session.norm_selection import (
    ChosenPerson,
    NormSelection,
    norm_selection,
    of_trials,
    speed_of,
)
from mbkf.study.session.records import MovementGroup, Session
from mbkf.study.session.scores import GPS, VARIABLES, gait_scores, gdi_basis
from mbkf.study.session.statements import session_files
from mbkf.trial.gait.convention import Convention

_Name = TypeVar("_Name", bound=tuple[str, ...])

LEAST_PERSONS = 2
"""Fewer persons have no spread."""

SPEED_STEP_M_S, LEAST_AT_SPEED = 0.2, 5
"""Width of a band of speeds, and the persons that it needs."""

FEATURES, LEAST_FOR_GDI = 15, 20
"""Features of the gait deviation index, as in its paper, and the persons that their distances need."""


def person_sessions(folders: Sequence[Path], convention: Convention | None = None) -> list[Session]:
    """A session for each person; the first folder below one of the folders is a person, as ``mbkf batch`` has them.

    Age and sex are those of the session file beside the results, else of that beside the captures that the results were
    made from.

    Args:
        folders: Folders with the results of persons.
        convention: Of the curves; None: that of the results.

    Raises:
        FileFormatError: A result is damaged.
        InvalidInput: A folder has no result.
    """
    persons: dict[Path, list[Path]] = {}
    for folder in folders:
        for result in results_in(folder):
            parts = result.relative_to(folder).parts
            persons.setdefault(folder / parts[0] if len(parts) > 1 else folder, []).append(result)
    return [
        session_from(results, person.name, _notes(person, results[0]), convention)
        for person, results in persons.items()
    ]


def _notes(person: Path, result: Path) -> SessionNotes:
    """Statements about a person; empty ones where no session file is found or it cannot be read."""
    for file in session_files(person, result):
        with suppress(FileFormatError):
            return read_session(file)
    return SessionNotes()


def norms_of(sessions: Sequence[Session], name: str, in_view: Collection[str] = ()) -> Norms:
    """Norms of the sessions that belong into them (:mod:`mbkf.study.session.norm_selection`), one for each person.

    Args:
        sessions: They.
        name: How reports call the norms.
        in_view: Names of persons that are left out, since the norms are for them.

    Raises:
        InvalidInput: Fewer than two persons belong into them.
    """
    return norms_from(norm_selection(sessions, in_view), name)


def norms_from(selection: NormSelection, name: str) -> Norms:
    """Norms of chosen persons.

    Args:
        selection: The persons.
        name: How reports call the norms.

    Raises:
        InvalidInput: There are fewer than two.
    """
    chosen = selection.persons
    if len(chosen) < LEAST_PERSONS:
        reasons = "; ".join(one.sentence for one in selection.left_out)
        raise InvalidInput(
            f"norms need walks that may be used of {LEAST_PERSONS} persons or more, here {len(chosen)}"
            + (f". Left out: {reasons}" if reasons else "")
        )
    read = {one.read for one in chosen}
    if len(read) > 1 or any(len(one) > 2 for one in read):
        apart = "; ".join(f"{one.facts.name}: {', '.join(one.read)}" for one in chosen)
        raise InvalidInput(f"persons are in different conventions or axes ({apart}); reconstruct them alike")
    ((convention, axes),) = read
    gaits = [one.gait for one in chosen]
    norms = Norms(
        name,
        _curve_bands(gaits),
        _bands(_measure_means(gaits)),
        _by_speed(chosen),
        tuple(one.facts for one in chosen),
        gdi=_gdi(gaits),
        convention=convention,
        axes=axes,
        ages=_span([one.facts.age for one in chosen]),
        speeds=_span([one.facts.speed_m_s for one in chosen]),
    )
    scores = _bands(_score_means(gaits, norms))
    return replace(norms, measures={**norms.measures, **scores})


def _span(values: Sequence[float]) -> Span:
    return min(values), max(values)


def _curve_bands(gaits: Sequence[MovementGroup]) -> dict[CurveName, Band]:
    curves: dict[CurveName, list[tuple[str, Array]]] = {}
    for gait in gaits:
        for key, (unit, mean) in _person_curves(gait).items():
            curves.setdefault((gait.kind.value, *key), []).append((unit, mean))
    return _bands(curves)


def _person_curves(gait: MovementGroup) -> Mapping[Key, tuple[str, Array]]:
    """The mean curve of each quantity over both sides of a person; amplitudes of muscles do not compare."""
    found: dict[Key, list[tuple[str, Array]]] = {}
    for side in gait.sides:
        for key in side.curves:
            chosen = chosen_curves(side, key)
            if chosen.mean is not None and not chosen.estimated and not key.is_emg:
                found.setdefault(key, []).append((side.curves[key].unit, chosen.mean.mean))
    return {key: (each[0][0], np.mean([mean for _, mean in each], axis=0)) for key, each in found.items()}


def _measure_means(gaits: Sequence[MovementGroup]) -> dict[tuple[str, str], list[tuple[str, Array]]]:
    found: dict[tuple[str, str], list[tuple[str, Array]]] = {}
    for gait in gaits:
        for measure in gait.measures:
            values = np.concatenate(list(measure.values.values()))
            if np.isfinite(values).any():
                value = (measure.unit, np.array([np.nanmean(values)]))
                found.setdefault((gait.kind.value, measure.name), []).append(value)
    return found


def _score_means(
    gaits: Sequence[MovementGroup], norms: Norms
) -> dict[tuple[str, str], list[tuple[str, Array]]]:
    """Scores of the persons themselves against the norms' mean: both sides' mean of each variable, and the overall."""
    found: dict[tuple[str, str], list[tuple[str, Array]]] = {}
    for gait in gaits:
        scores = gait_scores(gait, norms)
        if scores is None or scores.gps is None:
            continue
        sides = [side for side in scores.sides if side is not None]
        values = {name: np.mean([side.gvs[name].mean for side in sides], axis=0) for name in sides[0].gvs}
        for name, value in {**values, GPS: scores.gps.mean}.items():
            found.setdefault((gait.kind.value, name), []).append(("deg", value))
    return found


def _by_speed(chosen: Sequence[ChosenPerson]) -> dict[Speeds, dict[CurveName, Band]]:
    """Bands of the persons who walked at each speed, by their trials, where there are enough."""
    groups: dict[Speeds, list[MovementGroup]] = {}
    for one in chosen:
        trials: dict[Speeds, list[str]] = {}
        for name in one.gait.trials:
            speed = speed_of(of_trials(one.gait, {name}))
            if np.isfinite(speed):
                low = round(SPEED_STEP_M_S * np.floor(speed / SPEED_STEP_M_S + 1e-9), 6)
                trials.setdefault((float(low), round(float(low) + SPEED_STEP_M_S, 6)), []).append(name)
        for speeds, names in trials.items():
            groups.setdefault(speeds, []).append(of_trials(one.gait, names))
    return {
        speeds: _curve_bands(groups[speeds])
        for speeds in sorted(groups)
        if len(groups[speeds]) >= LEAST_AT_SPEED
    }


def _gdi(gaits: Sequence[MovementGroup]) -> GdiBasis | None:
    """The basis of the persons' sides; None of too few persons."""
    if len(gaits) < LEAST_FOR_GDI:
        return None
    names = tuple(
        name for name in VARIABLES if all(Key(ANGLE, name) in s.curves for g in gaits for s in g.sides)
    )
    vectors = []
    for gait in gaits:
        for side in gait.sides:
            means = [chosen_curves(side, Key(ANGLE, name)).mean for name in names]
            known = [one.mean[::2] for one in means if one is not None]
            if len(known) == len(names):
                vectors.append(np.concatenate(known))
    return gdi_basis(np.array(vectors), names, FEATURES) if len(vectors) > FEATURES and names else None


def _bands(by_name: Mapping[_Name, Sequence[tuple[str, Array]]]) -> dict[_Name, Band]:
    """Mean and spread between persons where there are enough."""
    return {
        name: Band(
            each[0][0],
            len(each),
            np.mean([mean for _, mean in each], axis=0),
            np.std([mean for _, mean in each], axis=0, ddof=1),
        )
        for name, each in by_name.items()
        if len(each) >= LEAST_PERSONS
    }
