"""What the feet stand on: two feet that share one plate."""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.contact.shared import shared_rows


def run(context: Context) -> list[Check]:
    """Rows of all parts."""
    return [
        *shared_rows(context),
    ]
