"""Reference bands from sessions of a laboratory's own: each person counts once, however many cycles there are."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfWarning
from mbkf.io.norms import Band, Norms
from mbkf.io.session import TrialKind
from mbkf.study.session.chosen import chosen_curves
from mbkf.study.session.cycles import Key
from mbkf.study.session.gather import results_in, session_from
from mbkf.study.session.records import MovementGroup, Session

_Name = TypeVar("_Name", bound=tuple[str, ...])

LEAST_PERSONS = 2
"""Fewer persons have no spread."""


def build_norms(folders: Sequence[Path], name: str) -> Norms:
    """Norms of all results in folders; the first folder below one of them is a person, as ``mbkf batch`` has them.

    Args:
        folders: Folders with the results of persons.
        name: How reports call the norms.

    Raises:
        FileFormatError: A result is damaged.
        InvalidInput: No result was found, or fewer than two persons with gait.
    """
    persons: dict[Path, list[Path]] = {}
    for folder in folders:
        for result in results_in(folder):
            parts = result.relative_to(folder).parts
            persons.setdefault(folder / parts[0] if len(parts) > 1 else folder, []).append(result)
    return norms_of([session_from(results, person.name) for person, results in persons.items()], name)


def norms_of(sessions: Iterable[Session], name: str) -> Norms:
    """Norms of sessions, one for each person.

    Args:
        sessions: They.
        name: How reports call the norms.

    Raises:
        InvalidInput: There are fewer than two with gait.
    """
    curves: dict[tuple[str, str, str], list[tuple[str, Array]]] = {}
    measures: dict[tuple[str, str], list[tuple[str, Array]]] = {}
    for session in sessions:
        for trial in session.trials:
            if trial.left_out:
                out = f"{trial.name} is left out of the norms where it may not be used: {trial.left_out}"
                warnings.warn(f"{session.name}: {out}", MbkfWarning, stacklevel=2)
        for gait in session.gaits:
            if gait.kind == TrialKind.UNKNOWN:
                continue
            for key, (unit, mean) in _person_curves(gait).items():
                curves.setdefault((gait.kind.value, *key), []).append((unit, mean))
            for measure in gait.measures:
                values = np.concatenate(list(measure.values.values()))
                if np.isfinite(values).any():
                    value = (measure.unit, np.array([np.nanmean(values)]))
                    measures.setdefault((gait.kind.value, measure.name), []).append(value)
    found = _bands(curves)
    if not found:
        raise InvalidInput(f"norms need gait of {LEAST_PERSONS} persons or more")
    return Norms(name, found, _bands(measures))


def _person_curves(gait: MovementGroup) -> Mapping[Key, tuple[str, Array]]:
    """The mean curve of each quantity over both sides of a person."""
    found: dict[Key, list[tuple[str, Array]]] = {}
    for side in gait.sides:
        for key in side.curves:
            chosen = chosen_curves(side, key)
            if chosen.mean is not None and not chosen.estimated:
                found.setdefault(key, []).append((side.curves[key].unit, chosen.mean.mean))
    return {key: (each[0][0], np.mean([mean for _, mean in each], axis=0)) for key, each in found.items()}


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
