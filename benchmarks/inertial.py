"""Inertial sensors: orientation against optical truth, the source's comparison, joint angles, markers, strides.

The rows stand in modules of their own, one per question.
"""

from __future__ import annotations

from benchmarks import inertial_body, inertial_orientation, inertial_stride
from benchmarks.checks import Check, Context
from mbkf.numerics.threads import single_threaded


def run(context: Context) -> list[Check]:
    """All rows of the inertial table."""
    with single_threaded():
        return [
            *inertial_orientation.broad_rows(context),
            *inertial_orientation.source_rows(context),
            *inertial_orientation.fault_rows(context),
            *inertial_body.angle_rows(context),
            *inertial_body.marker_rows(context),
            *inertial_stride.rows(context),
        ]
