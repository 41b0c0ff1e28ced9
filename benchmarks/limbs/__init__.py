"""Limbs turned over, mirrored or exchanged, at the start or at any frame: mended and reported, causally and smoothed.

Faults are put into clean trials (:mod:`benchmarks.limbs.faults`); the same trial without a fault is the reference.
Constants of :mod:`mbkf.filters.limb_watch` were chosen on the trials of :data:`benchmarks.limbs.trials.CHOSEN_ON`; the
other trials are no independent proof, since four rules came from their first failures.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.limbs.judged import judged, rows
from benchmarks.limbs.trials import cases, clean


def run(context: Context) -> list[Check]:
    """Rows of the faults by kind and by set of trials, and of the clean trials."""
    data = context.require_data()
    with in_parallel() as mapper:
        found = mapper(judged, cases(data, context.quick, context.seed))
        right = mapper(judged, clean(data, context.quick))
    return rows(found, right)
