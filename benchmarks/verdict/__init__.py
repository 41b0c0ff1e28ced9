"""Words of verdicts: on right trials, and on trials with a fault whose results are wrong.

Twenty-six kinds of faults are put into twenty trials of 1.8 s. Bounds of the words (:mod:`mbkf.trial.verdict`) were set
on right trials of ``python -m benchmarks loads`` and on the first ten of the twenty with their faults ("chosen on");
the other trials are shown, but are no independent proof: order and place of all plates, markers turned against the
laboratory, and the bound of missing forces came from faults of both groups. Findings are kept in the output folder, so
that a run that stopped goes on.
"""

from __future__ import annotations

from functools import partial

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.foreign.sets import made_or_left_out
from benchmarks.loads.trials import clean_trials
from benchmarks.verdict.in_view import second_person_rows
from benchmarks.verdict.invented import invented, invented_rows, moved_trials
from benchmarks.verdict.persons import accused, pairs, person_rows
from benchmarks.verdict.rows import faulty_rows, reason_rows, right_rows
from benchmarks.verdict.spoilt import sources_folder, spoilt_trials, stored
from benchmarks.verdict.trials import judged, shown_right


def run(context: Context) -> list[Check]:
    """Rows of right and of faulty trials, those that bounds were chosen on apart from the others."""
    data = context.require_data()
    made, rows = made_or_left_out(context)
    keep = partial(stored, folder=sources_folder(context.out))
    with in_parallel() as mapper:
        found = mapper(keep, spoilt_trials(data, context.quick))
        right = mapper(judged, clean_trials(data, None, context.quick))
        others = mapper(judged, shown_right(data, made, context.quick))
        persons = mapper(accused, pairs(data, context.quick))
        moved = mapper(invented, moved_trials(data, context.quick))
    return [
        *rows,
        *right_rows("chosen on", right),
        *right_rows("shown on", others),
        *faulty_rows("chosen on", [one for one in found if one.trial.base.chosen]),
        *faulty_rows("shown on", [one for one in found if not one.trial.base.chosen]),
        *reason_rows(found),
        *invented_rows(moved),
        *person_rows(persons),
        *second_person_rows(data, context.quick),
    ]
