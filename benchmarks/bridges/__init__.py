"""Bridges to other programs: bodies and results that they take over, and bodies that come from there.

``python -m benchmarks bridges --only PART`` runs one part; ``--only`` may be repeated.
"""

from __future__ import annotations

from collections.abc import Mapping

from benchmarks.bridges.opensim_out import opensim_out_rows
from benchmarks.checks import Check, Context
from benchmarks.parts import Part, part_rows

PARTS: Mapping[str, Part] = {
    "opensim_out": lambda context: opensim_out_rows(context.require_data(), context.out),
}
"""Rows by the part's name."""


def run(context: Context) -> list[Check]:
    """Rows of all parts, or of those of ``--only``.

    Raises:
        UnknownName: A part of ``--only`` does not exist.
    """
    return part_rows(context, PARTS)
