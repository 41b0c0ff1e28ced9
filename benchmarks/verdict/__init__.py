"""Words of verdicts: on right trials, and on trials with a fault whose results are wrong.

Bounds of the words (:mod:`mbkf.trial.verdict`) were set on the clean and faulty trials of ``python -m benchmarks
loads`` ("chosen on") and changed on no trial of the other rows ("shown on"): synthetic persons not looked at before.
"""

from __future__ import annotations

from benchmarks.checks import Check, Context
from benchmarks.dynamic.methods import in_parallel
from benchmarks.loads.trials import clean_trials, violators
from benchmarks.verdict.persons import accused, pairs, person_rows
from benchmarks.verdict.rows import faulty_rows, right_rows
from benchmarks.verdict.trials import judged, shown_faulty, shown_right


def run(context: Context) -> list[Check]:
    """Rows of right and of faulty trials, those that bounds were chosen on apart from the others."""
    data = context.require_data()
    with in_parallel() as mapper:
        right = mapper(judged, clean_trials(data, None, context.quick))
        faulty = mapper(judged, violators(data, context.quick))
        others = mapper(judged, shown_right(data, context.quick))
        wrong = mapper(judged, shown_faulty(data, context.quick))
        persons = mapper(accused, pairs(data, context.quick))
    return [
        *right_rows("chosen on", right),
        *faulty_rows("chosen on", faulty),
        *right_rows("shown on", others),
        *faulty_rows("shown on", wrong),
        *person_rows(persons),
    ]
