"""Real captures that carry an outside reference: offsets between motions of one person, curves, moments, Newton's law.

A reference is itself wrong by some degrees. Bounds stand where its constant error drops out (changes between trials of
one person), where markers alone show the answer (the tilt of the pelvis), and at agreement of curves.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import Mapper, in_parallel
from benchmarks.real_truth.before import before_rows
from benchmarks.real_truth.followed import SCALINGS, SESSION, Compared, Job, followed
from benchmarks.real_truth.persons import PERSONS
from benchmarks.real_truth.rows import (
    cover_rows,
    hip_rows,
    newton_rows,
    offset_rows,
    reference_rows,
    tilt_rows,
    trial_rows,
)


def run(context: Context) -> list[Check]:
    """Rows of all persons, scaled from a session and from standing; when quick, from a session alone."""
    data = context.require_data()
    with in_parallel() as mapper:
        found = by_scaling(data, (SESSION,) if context.quick else SCALINGS, mapper)
        rows = [row for scaling, held in found.items() for row in scaling_rows(scaling, held)]
        return rows if context.quick else [*rows, *before_rows(data, context.out, mapper)]


def by_scaling(data: Path, scalings: Sequence[str], mapper: Mapper) -> dict[str, list[Compared]]:
    """All trials beside their references, by way of scaling.

    Args:
        data: Folder of the reference captures.
        scalings: Ways of scaling.
        mapper: Follows persons side by side.
    """
    jobs = [Job(data, person, scaling) for scaling in scalings for person in PERSONS]
    found: dict[str, list[Compared]] = {scaling: [] for scaling in scalings}
    for job, trials in zip(jobs, mapper(followed, jobs), strict=True):
        found[job.scaling] += trials
    return found


def scaling_rows(scaling: str, found: list[Compared]) -> list[Check]:
    """The rows of one way of scaling.

    Args:
        scaling: Its name.
        found: All trials.
    """
    return [
        *offset_rows(scaling, found),
        *reference_rows(scaling, found),
        *(row for one in found for row in tilt_rows(scaling, one)),
        *(row for one in found for row in trial_rows(scaling, one)),
        *(row for one in found for row in newton_rows(scaling, one)),
        *(row for one in found for row in hip_rows(scaling, one)),
        *cover_rows(scaling, found),
    ]
