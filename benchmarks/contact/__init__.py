"""Contacts: impossible readings, feet that share a plate or have none, and other parts than feet."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.contact.others import other_rows
from benchmarks.contact.readings import readings_rows
from benchmarks.contact.shared import shared_rows
from benchmarks.contact.strangers import stranger_rows
from benchmarks.contact.withheld import withheld_rows


def run(context: Context) -> list[Check]:
    """Rows of all parts."""
    return [
        *readings_rows(context),
        *shared_rows(context),
        *withheld_rows(context),
        *other_rows(context),
        *stranger_rows(context),
    ]
