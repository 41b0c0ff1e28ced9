"""A better body: what a moving trial adds to the static one in angles, joint centres and axes, on synthetic persons."""

from __future__ import annotations

from benchmarks.better_body.angles import angle_rows
from benchmarks.better_body.centres import centre_rows
from benchmarks.better_body.persons import CARELESS
from benchmarks.checks import Check, Context


def run(context: Context) -> list[Check]:
    """Rows of all parts; settings of scaling were chosen on seeds 1 to 3, walk and squat."""
    seeds = (11, 12) if context.quick else (11, 12, 13, 14, 15)
    motions = ("walk",) if context.quick else ("walk", "squat", "jump")
    rows = [row for motion in motions for row in angle_rows(motion, seeds)]
    rows += angle_rows("walk", seeds, CARELESS)
    rows += centre_rows("walk", seeds, centre_mm=12.0, axis_deg=3.5)
    rows += centre_rows("star_arc", seeds, centre_mm=8.0, axis_deg=2.5)
    return rows
