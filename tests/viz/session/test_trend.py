"""The page on visits: a chart for each quantity, the numbers below, and changes that are sure bold."""

from dataclasses import replace

import pytest

from mbkf.study.session.norms import norms_of
from mbkf.study.session.trend import trend
from mbkf.viz.session.terms import Terms
from mbkf.viz.session.trend import MOST_COLUMNS, trend_part
from tests.study.session.sessions import person
from tests.study.session.test_trend import SPEEDS, visit


@pytest.mark.parametrize(
    ("language", "speed"), [("en", "Speed, right, m/s"), ("es", "Velocidad, derecha, m/s")]
)
def test_charts_and_numbers_of_every_visit(language, speed):
    sure = {**SPEEDS, "2025-03-01": [2.0, 2.01]}
    page = trend_part(trend([visit(day, speeds) for day, speeds in sure.items()]), Terms(language))
    assert page.count("<svg") == 1 and all(f"<th>{day}</th>" in page for day in sure)
    assert f"<td>{speed}</td><td>0.90 ± 0.25</td>" in page and "<td><b>1.1" in page
    calm = trend_part(trend([visit(day, [1.0, 1.1]) for day in SPEEDS]), Terms(language))
    assert "<b>" not in calm


def test_the_table_has_the_first_and_the_last_visits():
    days = [f"2025-{month:02d}-01" for month in range(1, 10)]
    page = trend_part(trend([visit(day, [1.0, 1.1]) for day in days]), Terms("en"))
    assert [day for day in days if f"<th>{day}</th>" in page] == [days[0], *days[1 - MOST_COLUMNS :]]


def test_scores_and_their_norm_have_charts():
    norms = norms_of([person(), person(1, 6)], "ours")
    visits = [visit(day, speeds) for day, speeds in SPEEDS.items()]
    page = trend_part(trend(visits, norms), Terms("en"))
    assert page.count("<svg") == 2 and "GPS, °" in page and 'class="norm"' in page
    assert "GPS" not in trend_part(trend([replace(one) for one in visits]), Terms("en"))
