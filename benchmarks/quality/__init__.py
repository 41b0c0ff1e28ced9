"""Checks apart from the filter: faults put into copies of captures, told by the check that they belong to."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.quality.faults import fault_rows
from benchmarks.quality.noise import law_rows, noise_rows
from benchmarks.quality.spoilt import known_persons, prepared, shown_persons


def run(context: Context) -> list[Check]:
    """Rows of captures on which thresholds were set, and of those that were only looked at; few with quick."""
    rows: list[Check] = []
    for bounded, persons in ((True, known_persons(context)), (False, shown_persons(context))):
        for person in persons:
            one = prepared(person)
            rows += fault_rows(one, bounded)
            rows += law_rows(one.name, one.judged, bounded)
    return rows + noise_rows(context)
