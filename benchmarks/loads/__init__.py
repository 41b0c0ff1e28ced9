"""Unexplained loads: captures in which a force acts that nothing reads, and clean captures that none may be found in.

Bounds on the force were set before, in a study on the shared adult and child and on public captures with plates; none
was changed on the rows of this benchmark. Constants of causes and edges (:mod:`mbkf.trial.loads`) were written while
these trials were looked at: for them the rows are no independent proof.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.foreign.sets import made_or_left_out
from benchmarks.loads.judged import clean_rows, judged, violator_rows
from benchmarks.loads.live import live_rows, streamed
from benchmarks.loads.opened import opened_rows
from benchmarks.loads.trials import clean_trials, violators


def run(context: Context) -> list[Check]:
    """Rows of violators and clean captures; persons of our own are left out where OpenSim is missing, and if quick."""
    data = context.require_data()
    made, rows = made_or_left_out(context)
    with in_parallel() as mapper:
        bad, good = violators(data, context.quick), clean_trials(data, made, context.quick)
        found, clean = mapper(judged, bad), mapper(judged, good)
        live = live_rows(mapper(streamed, good), mapper(streamed, bad))
    return [*rows, *violator_rows(found), *clean_rows(clean), *live, *opened_rows(data, context.quick)]
