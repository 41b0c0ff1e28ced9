"""Segment masses and centres of mass from plates: persons off the table, persons of the table, public captures."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.inertia.real import real_rows
from benchmarks.inertia.synthetic import synthetic_rows


def run(context: Context) -> list[Check]:
    """Rows of synthetic persons, few with quick, and of public captures where their folder is given."""
    rows = synthetic_rows(context.quick)
    if context.data is not None:
        rows += real_rows(context.data, context.quick)
    return rows
