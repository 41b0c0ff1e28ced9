"""Bridges to other programs: bodies and results that they take over, and bodies that come from there.

``python -m benchmarks bridges --only PART`` runs one part; ``--only`` may be repeated.
"""

from __future__ import annotations

from collections.abc import Mapping

from benchmarks.bridges.body_weight import body_weight_rows
from benchmarks.bridges.c3d_out import c3d_out_rows
from benchmarks.bridges.formats import formats_rows
from benchmarks.bridges.opensim_in import opensim_in_rows
from benchmarks.bridges.opensim_onto import opensim_onto_rows
from benchmarks.bridges.opensim_out import opensim_out_rows
from benchmarks.bridges.questions import questions_rows
from benchmarks.checks import Check, Context
from benchmarks.parts import Part, part_rows

PARTS: Mapping[str, Part] = {
    "body_weight": lambda context: body_weight_rows(context.out),
    "c3d_out": lambda context: c3d_out_rows(context.require_data(), context.out, context.quick),
    "opensim_in": lambda context: opensim_in_rows(context.require_data(), context.out),
    "opensim_onto": lambda context: opensim_onto_rows(context.require_data(), context.out, context.quick),
    "opensim_out": lambda context: opensim_out_rows(context.require_data(), context.out),
    "formats": lambda context: formats_rows(context.out),
    "questions": lambda context: questions_rows(context.out),
}
"""Rows by the part's name."""


def run(context: Context) -> list[Check]:
    """Rows of all parts, or of those of ``--only``.

    Raises:
        UnknownName: A part of ``--only`` does not exist.
    """
    return part_rows(context, PARTS)
