"""Angles: what is read as Plug-in Gait against the angles that its own files hold, and with fewer markers."""

from __future__ import annotations

from benchmarks.angles.archives import archive_rows
from benchmarks.angles.fewer import fewer_rows
from benchmarks.checks import Check, Context


def run(context: Context) -> list[Check]:
    """Rows of all parts."""
    data = context.require_data()
    return [*archive_rows(data), *fewer_rows(data)]
