"""Inertial sensors: orientation, beside VQF, too, the source's comparison, angles, motion, strides.

The rows stand in modules of their own, one per question.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.inertial import against_vqf, body, files, live, motion, orientation, stride, stride_unrest
from mbkf.numerics.threads import single_threaded


def run(context: Context) -> list[Check]:
    """All rows of the inertial table."""
    with single_threaded():
        return [
            *orientation.broad_rows(context),
            *orientation.source_rows(context),
            *orientation.fault_rows(context),
            *against_vqf.rows(context),
            *motion.rows(context),
            *live.rows(context),
            *body.angle_rows(context),
            *body.marker_rows(context),
            *stride.rows(context),
            *stride_unrest.rows(context),
            *files.rows(context),
        ]
