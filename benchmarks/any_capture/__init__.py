"""Any laboratory's capture: one truth written as different laboratories store it, and read back."""

from __future__ import annotations

from benchmarks.any_capture.forces import forces_rows
from benchmarks.checks import Check, Context


def run(context: Context) -> list[Check]:
    """Rows of all parts."""
    return [
        *forces_rows(context),
    ]
