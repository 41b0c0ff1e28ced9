"""Persons made from bodies of OpenSim, whose truth is exact: errors, and intervals that hold it.

The shared adult and child, and eight persons of our own under two models of skin, which OpenSim makes (extra `peers`).
Settings of scaling and filters may be chosen on the shared persons and on half of our own; the others show what is
reached.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import Mapper, in_parallel
from benchmarks.foreign.errors import Judged
from benchmarks.foreign.followed import CAUSAL
from benchmarks.foreign.medians import median_rows, read_baseline
from benchmarks.foreign.plate_free import plate_free_rows, without_plates
from benchmarks.foreign.rows import (
    CHOSEN_ON,
    SHOWN_ON,
    bounded_rows,
    calibration_rows,
    shown_rows,
    smoothing_rows,
    static_rows,
)
from benchmarks.foreign.score import score
from benchmarks.foreign.sets import PersonSet, made_or_left_out, own_sets, shared_set

SESSION, WALK, STATIC = "session", "walk", "static"


def run(context: Context) -> list[Check]:
    """Rows of the shared persons and, unless quick, of persons of our own, scaled from a session and from standing."""
    data = context.require_data()
    made, rows = made_or_left_out(context)
    sets = [shared_set(data), *([] if made is None else own_sets(made))]
    everyone: list[Judged] = []
    with in_parallel() as mapper:
        for one in sets:
            found = one.found(SESSION, mapper)
            everyone += found
            rows += _session_rows(one, found)
            rows += _other_rows(one, mapper)
            rows += smoothing_rows(one.name, found, one.found(SESSION, mapper, CAUSAL))
            if not one.own or one.shown:
                followed = mapper(without_plates, one.persons)
                rows += plate_free_rows(one.name, [each for held in followed for each in held])
    return [*rows, *calibration_rows("all persons, session", score(everyone))]


def _session_rows(one: PersonSet, found: list[Judged]) -> list[Check]:
    label, scores = f"{one.name}, {SESSION}", score(found)
    medians = median_rows(label, found, read_baseline())
    if one.own and not one.shown:
        return [*shown_rows(label, scores), *medians]
    return [*bounded_rows(label, scores, SHOWN_ON if one.shown else CHOSEN_ON), *medians]


def _other_rows(one: PersonSet, mapper: Mapper) -> list[Check]:
    static = score(one.found(STATIC, mapper))
    if one.own:
        return shown_rows(f"{one.name}, {STATIC}", static)
    walk = score(one.found(WALK, mapper))
    return [*static_rows(f"{one.name}, {STATIC}", static), *shown_rows(f"{one.name}, {WALK}", walk)]
