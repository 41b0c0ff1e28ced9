"""Feet and plates: readings that cannot be and what the torques make of them, and two feet that share one plate."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.contact.readings import readings_rows
from benchmarks.contact.shared import shared_rows


def run(context: Context) -> list[Check]:
    """Rows of all parts."""
    return [
        *readings_rows(context),
        *shared_rows(context),
    ]
