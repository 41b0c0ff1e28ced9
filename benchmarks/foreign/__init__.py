"""Persons made from bodies of OpenSim, whose truth is exact: errors, and intervals that hold it."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.foreign.followed import followed, jobs
from benchmarks.foreign.rows import CHOSEN_ON, bounded_rows, calibration_rows, shown_rows, static_rows
from benchmarks.foreign.score import score
from benchmarks.foreign.truth import FOLDER, foreigners


def run(context: Context) -> list[Check]:
    """Rows of the shared adult and child, scaled from standing, with a walk, and with a walk and a squat."""
    persons = foreigners(context.require_data() / FOLDER)
    names = " and ".join(person.name for person in persons)
    rows: list[Check] = []
    with in_parallel() as mapper:
        for scaling in ("session", "walk", "static"):
            found = score([one for held in mapper(followed, jobs(persons, scaling)) for one in held])
            label = f"{names}, {scaling}"
            if scaling == "session":
                rows += [*bounded_rows(label, found, CHOSEN_ON), *calibration_rows(label, found)]
            elif scaling == "static":
                rows += static_rows(label, found)
            else:
                rows += shown_rows(label, found)
    return rows
