"""Tables of a session: what stands in the cells, with nothing active in it."""

from dataclasses import replace

import numpy as np

from mbkf.io.session import TrialKind
from mbkf.study.session.comparison import measure_pairs
from mbkf.study.session.norms import norms_of
from mbkf.study.session.records import Measure
from mbkf.viz.session.tables import changes_table, measures_table, trials_table
from mbkf.viz.session.terms import Terms
from tests.study.session.sessions import person, session

ENGLISH, SPANISH = Terms("en"), Terms("es")


def measure(right, left, name="Speed", unit="m/s"):
    values = {"r": np.array(right), "l": np.array(left)}
    return Measure(name, unit, values, {side: ("a",) * len(v) for side, v in values.items()})


def test_trials():
    text = trials_table(session(), SPANISH)
    for trial in session().trials:
        assert trial.name in text
    assert "Marcha" in text and "usar" in text
    evil = replace(session().trials[0], name="<img src=x>", remarks=("<script>",))
    shown = trials_table(replace(session(), trials=(evil,)), ENGLISH)
    assert "<img" not in shown and "<script" not in shown and "&lt;script&gt;" in shown


def test_right_left_and_difference():
    text = measures_table([measure([1.0, 1.2], [0.9, 0.9])], ENGLISH)
    for cell in ("Speed, m/s", "1.10 ± 0.14", "0.90 ± 0.00", "20.0 %"):
        assert f">{cell}<" in text
    assert ">–<" in measures_table([measure([1.0], [np.nan])], ENGLISH)


def test_measures_of_the_body_stand_in_a_table_of_their_own():
    whole = Measure("Depth", "cm", {"": np.array([20.0, 22.0])}, {"": ("a", "a")})
    assert measures_table([whole, measure([1.0], [1.0])], ENGLISH).count("<table") == 2
    assert "21.0 ± 1.4" in measures_table([whole], ENGLISH)


def test_the_norm_is_shown_where_there_is_one():
    norms = norms_of([person(), person(1, 6)], "ours")
    measures = session().gaits[0].measures
    assert "norm" in measures_table(measures, ENGLISH, norms, TrialKind.WALK)
    assert "norm" not in measures_table(measures, ENGLISH, norms, TrialKind.RUN)


def test_single_values_have_no_interval():
    text = changes_table(measure_pairs((measure([1.0], [1.0]),), (measure([2.0], [1.0]),)), ENGLISH)
    assert "<b>" not in text and ">1.00<" in text and "±" not in text


def test_changes_that_are_sure_are_bold():
    sure = measure_pairs((measure([1.0, 1.01], [1.0, 1.01]),), (measure([2.0, 2.01], [1.0, 1.01]),))
    text = changes_table(sure, ENGLISH)
    assert text.count("<b>") == 1 and "<b>1.00 ± 0.03</b>" in text and "Speed, right, m/s" in text
