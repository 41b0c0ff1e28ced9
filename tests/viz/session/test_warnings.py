"""Warnings of a session: the gravest first, each reason once, and those that do not fit are counted."""

from dataclasses import replace

import pytest

from mbkf.study.session.agreement import Disagreement
from mbkf.viz.session.terms import Terms
from mbkf.viz.session.warnings import LETTERS_PER_LINE, fitting, session_word, warnings_box
from tests.study.session.sessions import session


def with_trials(*pairs):
    first = session().trials[0]
    trials = [
        replace(first, name=f"t{k}", verdict=word, remarks=remarks) for k, (word, remarks) in enumerate(pairs)
    ]
    return replace(session(), trials=tuple(trials))


def test_the_gravest_reason_is_first_and_a_shared_one_stands_once():
    one = with_trials(("use", ("a",)), ("do not use", ("b", "a")), ("look", ("c",)))
    page = warnings_box(one, Terms("en"), 9)
    assert page.index("t1: b") < page.index("t1, t0: a") < page.index("t2: c")
    assert page.count("<li") == 3 and "1 use, 1 look, 1 do not use" in page and 'class="verdict bad"' in page
    assert "must not be used" in page and session_word(one) == "do not use"


def test_a_remark_on_every_trial_names_all():
    page = warnings_box(with_trials(("use", ("a",)), ("use", ("a",))), Terms("es"), 9)
    assert "Todos los ensayos: a" in page and 'class="verdict good"' in page


@pytest.mark.parametrize(("lines", "shown", "left"), [(0, 0, 3), (1, 1, 2), (2, 1, 2), (3, 2, 1), (4, 3, 0)])
def test_lines_that_do_not_fit_are_counted(lines, shown, left):
    one = with_trials(("look", ("a", "b" * LETTERS_PER_LINE, "c")))
    page = warnings_box(one, Terms("en"), lines)
    assert page.count("<li") == shown and (f"section on trials: {left}." in page) == bool(left)
    assert fitting(["a", "b" * (LETTERS_PER_LINE + 1), "c"], lines) == shown


def test_trials_that_disagree_count():
    one = replace(session(), disagreements=(Disagreement(("walk 1",), "do not use", "another person"),))
    assert session_word(one) == "do not use" and "another person" in warnings_box(one, Terms("en"), 3)
