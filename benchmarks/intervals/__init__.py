"""Stated intervals against truth, with bodies scaled from captures: NEES and coverage, causal and smoothed."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.intervals.cells import cell_rows
from benchmarks.intervals.cost import cost_rows
from benchmarks.intervals.exact import exact_rows
from benchmarks.intervals.trials import BODIES, MOTIONS, SKIN_M, Key, judged

PERSONS, QUICK_PERSONS = (0, 1, 2, 4, 5, 6, 7, 8, 9, 10), 1
"""Seeds of the persons. That of seed 3, as drawn with the present spreads of skin, cannot walk."""


def run(context: Context) -> list[Check]:
    """Rows of every cell: motion, skin, body, causal or smoothed; one person and the middle skin with quick."""
    persons = PERSONS[:QUICK_PERSONS] if context.quick else PERSONS
    skins = SKIN_M[1:2] if context.quick else SKIN_M
    keys = [
        Key(motion, person, skin, body)
        for motion in MOTIONS
        for skin in skins
        for body in BODIES
        for person in persons
    ]
    with in_parallel() as mapper:
        found = [one for both in mapper(judged, keys) for one in both]
    exact = [] if context.data is None else exact_rows(context.data)
    return [*cell_rows(found), *exact, *cost_rows()]
